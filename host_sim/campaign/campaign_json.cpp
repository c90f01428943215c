#include <cmath>

#include "host_sim/campaign/campaign_file.hpp"
#include "host_sim/campaign/causes.hpp"
#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/tally.hpp"

namespace lf::campaign {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no NaN and no infinity.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json pair(const Interval& interval) { return Json::array({interval.low, interval.high}); }
Json failure(const std::optional<record::FailureRecord>& record) {
  return record ? Json{{"phase", record->phase}, {"reason", record->reason}} : Json(nullptr);
}

Json counts(const Tally& tally) {
  return {{"runs", tally.runs},
          {"not_flown", tally.not_flown},
          {"successes", tally.successes},
          {"success_95", pair(tally.success)},
          {"false_successes", tally.false_successes},
          {"false_success_95", pair(tally.false_success)}};
}

Json errors(const Cell& cell, const Tally& tally) {
  Json json = Json::object();
  for (const Spread& spread : tally.spreads) {
    Json worst = Json::array();
    for (const std::size_t run : spread.worst_runs) worst.push_back(cell.runs[run].seed);
    json[figures()[spread.figure].name] = {{"unit", figures()[spread.figure].unit},
                                           {"runs", spread.runs},
                                           {"median", spread.median},
                                           {"p95", spread.p95},
                                           {"worst", spread.worst},
                                           {"worst_seeds", worst}};
  }
  return json;
}

Json failures(const Cell& cell) {
  Json json = Json::array();
  for (const RunSummary& run : cell.runs) {
    if (run.success) continue;
    const record::FailureRecord record = run.failure.value_or(record::FailureRecord{"?", "no reason was given"});
    json.push_back({{"seed", run.seed}, {"phase", record.phase}, {"reason", record.reason}});
  }
  return json;
}

Json run_json(const RunSummary& run) {
  Json values = Json::object();
  for (std::size_t i = 0; i < figures().size(); ++i) values[figures()[i].name] = number(run.figures[i]);
  Json json{{"seed", run.seed}, {"success", run.success}, {"false_success", run.false_success}, {"failure", failure(run.failure)}};
  if (!run.as_expected.empty()) json["as_expected"] = run.as_expected;
  json["figures"] = std::move(values);
  json["calibration_doubted"] = run.calibration_doubted;
  json["wall_s"] = number(run.wall_s);
  json["digest"] = run.digest;
  json["folder"] = run.folder;
  json["has_report"] = run.has_report;
  return json;
}

Json cell_json(const Cell& cell) {
  Json choice = Json::object(), experiment = Json::object(), runs = Json::array();
  for (const auto& [key, value] : cell.choice) choice[key] = value;
  for (const auto& [name, value] : cell.experiment) experiment[name] = value;
  for (const RunSummary& run : cell.runs) runs.push_back(run_json(run));
  const Tally tally = tally_of(cell);
  Json json{{"choice", choice}, {"folder", cell.folder}, {"hash", record::hash_of(cell.experiment)}};
  json.update(counts(tally));
  json["not_flown_seeds"] = cell.not_flown;
  json["errors"] = errors(cell, tally);
  json["failures"] = failures(cell);
  json["experiment"] = std::move(experiment);
  json["results"] = std::move(runs);
  return json;
}

Json causes_json(const Campaign& campaign) {
  Json json = Json::array();
  for (const Cause& cause : causes_of(campaign)) {
    Json runs = Json::array();
    for (const auto& [c, r] : cause.runs) {
      const Cell& cell = campaign.cells[c];
      Json run{{"seed", cell.runs[r].seed}};
      if (!cell.choice.empty()) run["cell"] = label_of(cell.choice);
      runs.push_back(std::move(run));
    }
    json.push_back({{"phase", cause.phase}, {"cause", cause.cause}, {"false_success", cause.false_success}, {"runs", runs}});
  }
  return json;
}

}  // namespace

Json json_of(const Campaign& campaign) {
  Json sittings = Json::array(), cells = Json::array();
  for (const Sitting& sitting : campaign.sittings)
    sittings.push_back({{"begun", sitting.begun}, {"ended", sitting.ended}, {"flown", sitting.flown}});
  for (const Cell& cell : campaign.cells) cells.push_back(cell_json(cell));
  Json json{{"format", 1},
            {"scenario", campaign.scenario},
            {"seeds", campaign.seeds},
            {"set", campaign.set},
            {"grid", campaign.keys},
            {"command", campaign.command},
            {"version", campaign.version},
            {"revision", campaign.revision},
            {"sittings", std::move(sittings)}};
  json.update(counts(total_of(campaign)));
  // Of a grid's cells each has figures of its own: together they would mean nothing.
  if (campaign.keys.empty()) {
    json["errors"] = cells[0]["errors"];
    json["failures"] = cells[0]["failures"];
  }
  json["causes"] = causes_json(campaign);
  json["cells"] = std::move(cells);
  return json;
}

}  // namespace lf::campaign
