#include "host_sim/campaign/campaign_csv.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/tally.hpp"

namespace lf::campaign {
namespace {

std::string quoted(const std::string& text) {
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

// The shortest text that reads back to the same number; nothing for one that is unknown.
std::string number(double value) {
  if (!std::isfinite(value)) return "";
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string keys(const Campaign& campaign) {
  std::string row;
  for (const std::string& key : campaign.keys) row += quoted(key) + ",";
  return row;
}

std::string choice(const Cell& cell) {
  std::string row;
  for (const auto& [key, value] : cell.choice) row += quoted(value) + ",";
  return row;
}

}  // namespace

std::string cells_csv(const Campaign& campaign) {
  std::string csv =
      keys(campaign) + "runs,not_flown,successes,success_low_95,success_high_95,false_successes,false_success_low_95,false_success_high_95";
  for (const Figure& figure : figures()) {
    for (const char* of : {"median", "p95", "worst"}) csv += std::string(",") + figure.name + "_" + of;
  }
  csv += ",folder,hash\n";
  for (const Cell& cell : campaign.cells) {
    const Tally tally = tally_of(cell);
    csv += choice(cell) + std::to_string(tally.runs) + "," + std::to_string(tally.not_flown) + "," + std::to_string(tally.successes) + "," +
           number(tally.success.low) + "," + number(tally.success.high) + "," + std::to_string(tally.false_successes) + "," +
           number(tally.false_success.low) + "," + number(tally.false_success.high);
    std::vector<Spread> spreads(figures().size());
    for (const Spread& spread : tally.spreads) spreads[spread.figure] = spread;
    for (const Spread& spread : spreads) csv += "," + number(spread.median) + "," + number(spread.p95) + "," + number(spread.worst);
    csv += "," + quoted(cell.folder) + "," + record::hash_of(cell.experiment) + "\n";
  }
  return csv;
}

std::string runs_csv(const Campaign& campaign) {
  std::string csv = keys(campaign) + "seed,success,false_success,phase,reason,as_expected,calibration_doubted";
  for (const Figure& figure : figures()) csv += std::string(",") + figure.name;
  csv += ",wall_s,digest,folder\n";
  for (const Cell& cell : campaign.cells) {
    for (const RunSummary& run : cell.runs) {
      const record::FailureRecord failure = run.failure.value_or(record::FailureRecord{});
      csv += choice(cell) + std::to_string(run.seed) + (run.success ? ",1," : ",0,") + (run.false_success ? "1," : "0,") +
             quoted(failure.phase) + "," + quoted(failure.reason) + "," + quoted(run.as_expected) + (run.calibration_doubted ? ",1" : ",0");
      for (const double value : run.figures) csv += "," + number(value);
      csv += "," + number(run.wall_s) + "," + run.digest + "," + quoted(run.folder) + "\n";
    }
  }
  return csv;
}

}  // namespace lf::campaign
