#include "host_sim/campaign/table_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/campaign/causes.hpp"
#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/tally.hpp"

namespace lf::campaign {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 400> text;
  const int size = std::snprintf(text.data(), text.size(), format, values...);
  return {text.data(), std::min(text.size() - 1, static_cast<std::size_t>(std::max(0, size)))};
}

std::string percent(const Interval& interval) { return formatted("%.1f to %.1f %%", 100 * interval.low, 100 * interval.high); }

std::string counts(const Tally& tally) {
  std::string text = formatted("%zu of %zu succeeded (95 %%: %s), %zu false successes (%s)", tally.successes, tally.runs,
                               percent(tally.success).c_str(), tally.false_successes, percent(tally.false_success).c_str());
  if (tally.calibrations_doubted > 0) text += formatted(", %zu with a doubtful calibration", tally.calibrations_doubted);
  if (tally.not_flown > 0) text += formatted(", %zu not flown", tally.not_flown);
  return text + "\n";
}

std::string figures_text(const Tally& tally) {
  if (tally.spreads.empty()) return "";
  std::string text = formatted("%-20s %10s %10s %10s\n", "", "median", "p95", "worst");
  for (const Spread& spread : tally.spreads) {
    const Figure& figure = figures()[spread.figure];
    text += formatted("%-20s %10.3f %10.3f %10.3f %s\n", figure.name, spread.median, spread.p95, spread.worst, figure.unit);
  }
  return text;
}

std::string causes_text(const Campaign& campaign) {
  constexpr std::size_t most = 12;
  std::string text;
  for (const Cause& cause : causes_of(campaign)) {
    text += std::string(cause.false_success ? "false success" : "failed") + ", " + std::to_string(cause.runs.size()) + " in " +
            cause.phase + ": " + (cause.runs.size() == 1 ? cause.example : cause.cause) + "\n    ";
    for (std::size_t i = 0; i < std::min(most, cause.runs.size()); ++i) {
      const auto [c, r] = cause.runs[i];
      const std::string label = label_of(campaign.cells[c].choice);
      text += (i == 0 ? "" : ", ") + (label.empty() ? "" : label + ", ") + "seed " + std::to_string(campaign.cells[c].runs[r].seed);
    }
    text += cause.runs.size() > most ? ", and " + std::to_string(cause.runs.size() - most) + " more\n" : "\n";
  }
  return text;
}

}  // namespace

std::string table_text(const Campaign& campaign) {
  std::string text = "\n";
  if (campaign.keys.empty()) {
    const Tally tally = tally_of(campaign.cells[0]);
    text += counts(tally) + figures_text(tally);
  } else {
    for (const Cell& cell : campaign.cells) {
      const Tally tally = tally_of(cell);
      text += label_of(cell.choice) + ": " + counts(tally) + figures_text(tally) + "\n";
    }
    text += "all: " + counts(total_of(campaign));
  }
  return text + causes_text(campaign);
}

}  // namespace lf::campaign
