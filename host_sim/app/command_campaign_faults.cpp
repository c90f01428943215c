// `lanternfish campaign --faults`.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <set>

#include "hal/config/key_text.hpp"
#include "hal/config/nearest.hpp"
#include "host_sim/app/campaign_options.hpp"
#include "host_sim/app/fault_matrix.hpp"
#include "host_sim/app/fault_suite.hpp"
#include "host_sim/app/fault_table.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/matrix_rows.hpp"
#include "host_sim/app/progress_line.hpp"
#include "host_sim/campaign/utc_time.hpp"
#include "host_sim/judge/fault_rules.hpp"
#include "host_sim/record/run_folder.hpp"
#include "shared/input_error.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace {

std::string command_of(const CampaignOptions& options) {
  std::string command = "lanternfish campaign " + options.scenario + " --faults";
  if (options.pairs) command += " --pairs";
  for (const std::string& kind : options.kinds) command += " --kinds " + kind;
  for (const std::string& step : options.steps) command += " --steps '" + step + "'";
  for (const std::string& row : options.rows) command += " --rows '" + row + "'";
  if (options.rendered) command += " --rendered";
  if (options.one_in > 1) command += " --one-in " + std::to_string(options.one_in);
  if (options.into != usual_share_of_step) command += " --into " + config::number_text(options.into);
  for (const std::string& set : options.set) command += " --set '" + set + "'";
  if (options.shard != "1/1") command += " --shard " + options.shard;
  return command;
}

void say(const RowResult& row) {
  const char* verdict = !row.safe() ? "UNSAFE" : row.unclear.empty() ? "safe" : "unclear";
  std::fprintf(stderr, "%-8s %s\n", verdict, row.row.c_str());
}

std::vector<std::string> names_of_steps() {
  std::vector<std::string> steps{"power-on"};
  for (std::size_t i = 0; i < mission::step_count; ++i) {
    if (const auto step = static_cast<mission::Step>(i); step != mission::Step::idle) steps.emplace_back(mission::row(step).name);
  }
  return steps;
}

// A pair's name has two causes, and their times.
void check_pairs(const std::vector<std::string>& rows) {
  const std::vector<std::string> steps = names_of_steps();
  for (const std::string& row : rows) {
    const std::string step = row.substr(0, row.find(':'));
    config::check_names({step}, steps, "--rows");
    if (row.find(", then ") == std::string::npos)
      throw InputError("--rows: with --pairs a row is a pair, as in rows.jsonl: 'turn: estop, then silent slew 0.1234 s later', not '" +
                       row + "'");
  }
}

// What is misspelt is told before a mission is flown for its steps' times. A step that no walk of this scenario comes to is told after.
void check_names_early(const CampaignOptions& options, const judge::BusNodes& bus) {
  std::vector<std::string> kinds, rows;
  const std::vector<std::string> steps = names_of_steps();
  for (const judge::FaultRule& rule : judge::fault_rules()) kinds.push_back(rule.kind);
  config::check_names(options.kinds, kinds, "--kinds");
  config::check_names(options.steps, steps, "--steps");
  if (options.pairs) return check_pairs(options.rows);
  for (const std::string& step : steps) {
    for (const judge::Cause& cause : judge::all_causes(bus)) {
      if (happens_in(cause, step)) rows.push_back(step + ": " + cause.name());
    }
  }
  config::check_names(options.rows, rows, "--rows");
}

std::string step_of(const std::string& row) { return row.substr(0, row.find(':')); }

// Whose times have to be measured; none: of all.
std::set<std::string> steps_of(const CampaignOptions& options) {
  std::set<std::string> steps(options.steps.begin(), options.steps.end());
  for (const std::string& row : options.rows) steps.insert(step_of(row));
  return steps;
}

// What the walks of this scenario do not come to is no misspelling.
void check_reached(const std::set<std::string>& steps, const std::vector<FaultMoment>& moments) {
  for (const std::string& step : steps) {
    if (std::none_of(moments.begin(), moments.end(), [&](const FaultMoment& moment) { return moment.name == step; }))
      throw InputError(
          "no fault can be made in '" + step +
          "': this scenario's mission does not come to it. It has no task for it, or ends before it: fly it with 'lanternfish run'");
  }
}

}  // namespace

int fault_campaign(const CampaignOptions& options) {
  const Shard shard = parse_shard(options.shard);
  const scenario::Scenario base = scenario::load_scenario(options.scenario, options.set);
  const judge::BusNodes bus = bus_of(base);
  check_names_early(options, bus);
  scenario::check_runnable(base);
  std::string kind = options.pairs ? "fault-pairs" : "faults";
  if (options.rendered) kind += "-rendered";
  if (options.into != usual_share_of_step) kind += "-into-" + config::number_text(options.into);
  const CampaignFolder folder(options, base, kind);
  catch_interrupts();
  const MatrixChoice choice{options.kinds, options.steps, options.rows,   options.pairs,
                            shard.index,   shard.count,   options.one_in, options.into};
  const std::set<std::string> steps = steps_of(options);
  const std::vector<FaultMoment> moments = survey_moments(base, options.into, steps);
  if (interrupted()) {
    constexpr const char* told = "interrupted while the steps' times were measured: no row was flown";
    std::fprintf(stderr, "lanternfish: %s\n", told);
    if (options.json) print_json({{"problems", Json::array({told})}, {"exit_status", exit_interrupted}});
    return exit_interrupted;
  }
  check_reached(steps, moments);
  const std::vector<MatrixRow> all = matrix_rows(moments, choice, bus);

  if (all.empty() && shard.count == 1) throw InputError("no row of the matrix is of this choice");

  // Rows of this choice that are there are kept.
  const std::filesystem::path file = folder.path() / "rows.jsonl";
  std::set<std::string> wanted;
  for (const MatrixRow& row : all) wanted.insert(row.name());
  std::vector<RowResult> results;
  for (RowResult& row : read_rows(file)) {
    if (wanted.erase(row.row) > 0) results.push_back(std::move(row));
  }
  const std::size_t kept = results.size();
  std::vector<MatrixRow> missing;
  for (const MatrixRow& row : all) {
    if (wanted.contains(row.name())) missing.push_back(row);
  }
  if (kept > 0) std::fprintf(stderr, "%zu rows are kept, %zu are missing\n", kept, missing.size());
  const std::string begun = campaign::utc_text(std::time(nullptr));
  ProgressLine progress(missing.size(), "row");
  fly_matrix(base, missing, options.rendered ? Sight::rendered : Sight::given, jobs_of(options), file, [&](const RowResult& row) {
    progress.ended(!row.safe());
    progress.clear();
    say(row);
    progress.tick();
    wanted.erase(row.row);
    results.push_back(row);
  });
  progress.clear();

  std::sort(results.begin(), results.end(), [](const RowResult& a, const RowResult& b) { return a.row < b.row; });
  const FaultTable table = tabulate_faults(results);
  const record::RunFolder out(folder.path());
  out.write("faults.csv", csv_of(results));
  out.write("faults.md", markdown_of(table, command_of(options)));
  Json json = json_of(table);
  json["folder"] = folder.path().string();
  json["provenance"] = folder.provenance(command_of(options), begun);
  out.write("faults.json", json.dump(2) + "\n");
  campaign::TestSuite suite = fault_suite(base.name, results, table, {wanted.begin(), wanted.end()});
  suite.begun = begun;
  suite.properties = {{"command", command_of(options)}, {"version", version()}, {"revision", revision()}};
  out.write(campaign::junit_file, junit_xml(suite));
  options.json ? print_json(json) : tell(table);
  if (interrupted()) return exit_interrupted;
  return table.good() ? done : failed;
}

}  // namespace lf::app
