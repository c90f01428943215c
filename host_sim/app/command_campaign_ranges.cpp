// `lanternfish campaign --ranges`: every key of the scenario, drawn over its documented range.
#include <algorithm>
#include <ctime>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "hal/config/nearest.hpp"
#include "host_sim/app/campaign_options.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/copies.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/progress_line.hpp"
#include "host_sim/app/range_draws.hpp"
#include "host_sim/app/range_suite.hpp"
#include "host_sim/app/range_verdict.hpp"
#include "host_sim/app/run_session.hpp"
#include "host_sim/app/shell_word.hpp"
#include "host_sim/campaign/utc_time.hpp"
#include "host_sim/record/run_folder.hpp"
#include "host_sim/scenario/duration.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace {

std::string command_of(const CampaignOptions& options) {
  std::string command = "lanternfish campaign " + shell_word(options.scenario) + " --ranges --draws " + std::to_string(options.draws) +
                        " --many " + std::to_string(options.many);
  for (const std::string& key : options.kinds) command += " --kinds " + shell_word(key);
  for (const std::string& set : options.set) command += " --set " + shell_word(set);
  if (options.shard != "1/1") command += " --shard " + options.shard;
  return command;
}

std::string line_of(const RangeResult& result) {
  const Json json{{"row", result.name}, {"key", result.key}, {"set", result.set}, {"verdict", result.verdict}, {"reason", result.reason}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<RangeResult> parse(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return RangeResult{json.value("row", ""), json.value("key", ""), json.value("set", ""), json.value("verdict", ""),
                     json.value("reason", "")};
}

RangeResult fly_once(const CampaignOptions& options, const RangeRow& row) {
  std::vector<std::string> set = options.set;
  set.insert(set.end(), row.set.begin(), row.set.end());
  RunRequest request;
  const auto prepare = [&] {
    request.scenario = scenario::load_scenario(options.scenario, set);
    scenario::check_runnable(request.scenario);
    // Slow speeds are no failure: a run has the time that they need.
    request.scenario.time_limit_s = std::max(request.scenario.time_limit_s, scenario::longest_mission_s(request.scenario));
    request.seed = row.seed;
    request.outside = false;
    request.given_sight = !row.sees;
  };
  return verdict_of(row, prepare, [&] { return run_mission(request).result; });
}

RangeResult fly(const CampaignOptions& options, const RangeRow& row) {
  RangeResult result = fly_once(options, row);
  for (std::uint64_t i = 2; row.key == "many" && result.verdict == "refused" && i <= combinations; ++i)
    result = fly_once(options, many_row(row.seed, i));
  return result;
}

std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

constexpr const char* broken_off = "broken off\n";  // a copy's line, by Ctrl-C or a signal of its own

using Counts = std::map<std::string, std::size_t>;

std::string markdown_of(const std::vector<RangeResult>& results) {
  std::map<std::string, Counts> by_key;
  for (const RangeResult& result : results) ++by_key[result.key][result.verdict];
  std::string text = "| key | success | safe | refused | unnamed | unsafe |\n|---|---|---|---|---|---|\n";
  for (auto& [key, counts] : by_key) {
    text += "| `" + key + "` |";
    for (const char* verdict : verdicts) text += " " + (counts[verdict] > 0 ? std::to_string(counts[verdict]) : "") + " |";
    text += "\n";
  }
  text += "\n| drawn | came to | because |\n|---|---|---|\n";
  for (const RangeResult& result : results) {
    if (result.verdict != "success") text += "| `" + cell(result.set) + "` | " + result.verdict + " | " + cell(result.reason) + " |\n";
  }
  return text;
}

}  // namespace

int range_campaign(const CampaignOptions& options) {
  const Shard shard = parse_shard(options.shard);
  std::vector<std::string> known = drawn_keys();
  known.emplace_back("many");
  config::check_names(options.kinds, known, "--kinds");
  const scenario::Scenario base = scenario::load_scenario(options.scenario, options.set);
  const CampaignFolder folder(options, base, "ranges");
  catch_interrupts();
  const std::filesystem::path file = folder.path() / "rows.jsonl";
  std::vector<RangeRow> rows;
  const std::vector<RangeRow> all = range_rows(options.draws, options.many);
  for (std::size_t i = shard.index - 1; i < all.size(); i += shard.count) {
    if (options.kinds.empty() || std::find(options.kinds.begin(), options.kinds.end(), all[i].key) != options.kinds.end())
      rows.push_back(all[i]);
  }
  std::map<std::string, RangeResult> results;
  std::ifstream kept(file);
  for (std::string line; std::getline(kept, line);) {
    const std::optional<RangeResult> result = parse(line);
    // Versions until 5497bf1 kept a run that Ctrl-C had broken off.
    if (result && !result->reason.ends_with(": interrupted")) results[result->name] = *result;
  }
  std::vector<const RangeRow*> missing;
  for (const RangeRow& row : rows) {
    if (!results.contains(row.name)) missing.push_back(&row);
  }
  if (missing.size() < rows.size())
    std::fprintf(stderr, "%zu rows are kept, %zu are missing\n", rows.size() - missing.size(), missing.size());
  const std::string begun = campaign::utc_text(std::time(nullptr));
  LineFile lines(file);
  ProgressLine progress(missing.size(), "row");
  std::map<std::string, const RangeRow*> by_name;
  Copies copies(jobs_of(options), [&](const Copies::Ended& ended) {
    if (ended.line == broken_off) return;  // the next call flies it
    const RangeRow& row = *by_name.at(ended.name);
    RangeResult result = parse(ended.line).value_or(RangeResult{row.name, row.key, row.set.front(), "unsafe", ended.failure});
    lines.append(line_of(result));
    progress.ended(result.verdict == "unsafe" || result.verdict == "unnamed");
    progress.clear();
    std::fprintf(stderr, "%-8s %s %s\n", result.verdict.c_str(), result.name.c_str(), result.reason.c_str());
    progress.tick();
    results[result.name] = result;
  });
  for (const RangeRow* row : missing) {
    if (interrupted()) break;
    by_name[row->name] = row;
    copies.start(row->name, [&] {
      const RangeResult result = fly(options, *row);
      return interrupted() ? std::string(broken_off) : line_of(result);
    });
  }
  copies.finish();
  progress.clear();

  std::vector<RangeResult> mine;
  std::vector<std::string> not_flown;
  Counts counts, single;
  for (const RangeRow& row : rows) {
    const auto found = results.find(row.name);
    if (found == results.end()) {
      not_flown.push_back(row.name);
      continue;
    }
    mine.push_back(found->second);
    ++counts[found->second.verdict];
    if (row.key != "many" && !is_of_an_end(row.name)) ++single[found->second.verdict];
  }
  const record::RunFolder out(folder.path());
  out.write("ranges.md", markdown_of(mine));
  std::size_t singles = 0;
  for (const auto& [verdict, count] : single) singles += count;
  Json json{{"rows", mine.size()}, {"not_flown", not_flown.size()}, {"single_draws", singles}, {"folder", folder.path().string()}};
  for (const char* verdict : verdicts) json[verdict] = counts[verdict];
  json["provenance"] = folder.provenance(command_of(options), begun);
  out.write("ranges.json", json.dump(2) + "\n");
  campaign::TestSuite suite = range_suite(base.name, mine, not_flown);
  suite.begun = begun;
  suite.properties = {{"command", command_of(options)}, {"version", version()}, {"revision", revision()}};
  out.write(campaign::junit_file, junit_xml(suite));
  if (options.json) {
    print_json(json);
  } else {
    print("%s", markdown_of(mine).c_str());
    for (const char* verdict : verdicts) print("%s: %zu\n", verdict, counts[verdict]);
    if (!not_flown.empty()) print("not flown: %zu; the same command flies them\n", not_flown.size());
    print("single-key draws: %zu of %zu succeeded\n", single["success"], singles);
  }
  if (interrupted()) return exit_interrupted;
  const bool enough = static_cast<double>(single["success"]) >= single_share * static_cast<double>(singles);
  return counts["unsafe"] + counts["unnamed"] + not_flown.size() == 0 && enough ? done : failed;
}

}  // namespace lf::app
