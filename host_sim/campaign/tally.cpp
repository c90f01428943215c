#include "host_sim/campaign/tally.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/statistics/percentile.hpp"

namespace lf::campaign {
namespace {

void count(const Cell& cell, Tally& tally) {
  tally.runs += cell.runs.size();
  tally.not_flown += cell.not_flown.size();
  for (const RunSummary& run : cell.runs) {
    tally.successes += run.success ? 1 : 0;
    tally.false_successes += run.false_success ? 1 : 0;
    tally.calibrations_doubted += run.calibration_doubted ? 1 : 0;
  }
  tally.success = wilson_95(tally.successes, tally.runs);
  tally.false_success = wilson_95(tally.false_successes, tally.runs);
}

Spread spread_of(const Cell& cell, std::size_t index) {
  constexpr std::size_t most_worst = 3;
  const Figure& figure = figures()[index];
  Spread spread;
  spread.figure = index;
  const double sign = figure.good == Figure::Good::more ? -1 : 1;  // the larger, the worse
  std::vector<double> values;
  for (std::size_t i = 0; i < cell.runs.size(); ++i) {
    if (!std::isfinite(cell.runs[i].figures[index])) continue;
    values.push_back(sign * cell.runs[i].figures[index]);
    spread.worst_runs.push_back(i);
  }
  spread.runs = values.size();
  if (values.empty()) return spread;
  spread.median = sign * nearest_rank(values, 0.5);
  spread.p95 = sign * nearest_rank(values, 0.95);
  spread.worst = sign * nearest_rank(values, 1);
  std::stable_sort(spread.worst_runs.begin(), spread.worst_runs.end(), [&](std::size_t a, std::size_t b) {
    return compare_worse(figure, cell.runs[a].figures[index], cell.runs[b].figures[index]) > 0;
  });
  spread.worst_runs.resize(std::min(spread.worst_runs.size(), most_worst));
  return spread;
}

}  // namespace

Tally tally_of(const Cell& cell) {
  Tally tally;
  count(cell, tally);
  for (std::size_t i = 0; i < figures().size(); ++i) {
    Spread spread = spread_of(cell, i);
    if (spread.runs > 0) tally.spreads.push_back(std::move(spread));
  }
  return tally;
}

Tally total_of(const Campaign& campaign) {
  Tally tally;
  for (const Cell& cell : campaign.cells) count(cell, tally);
  return tally;
}

bool all_succeeded(const Campaign& campaign) {
  const Tally total = total_of(campaign);
  return total.successes == total.runs && total.not_flown == 0;
}

}  // namespace lf::campaign
