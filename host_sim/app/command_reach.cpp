#include <cmath>
#include <cstdio>
#include <memory>

#include "hal/config/read_arm.hpp"
#include "hal/config/share.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/reach_picture.hpp"
#include "host_sim/app/reach_survey.hpp"
#include "host_sim/record/file_sink.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string scenario = "default";
  std::vector<std::string> set;
  std::string out = "reach.png";
  int draws = 2000;
  bool json = false;
};

constexpr std::array<double, 4> tilt_limits_deg{5, 10, 15, 20};

Json json_of(const ReachTarget& target) {
  Json json{{"name", target.name}, {"reachable", target.nominal.outcome == arm::IkOutcome::ok}};
  if (target.nominal.outcome == arm::IkOutcome::ok) {
    json["tilt_deg"] = deg_from_rad(target.nominal.tilt_rad);
  } else {
    json["reason"] = arm::name(target.nominal.outcome);
  }
  json["docking_errors"] = target.draws;
  json["reached"] = target.reached;
  json["worst_tilt_deg"] = deg_from_rad(target.worst_tilt_rad);
  if (std::isfinite(target.handle_clearance_m)) json["handle_clearance_mm"] = 1e3 * target.handle_clearance_m;
  return json;
}

Json json_of(const ReachGrid& grid) {
  Json areas = Json::array();
  for (const double limit : tilt_limits_deg) areas.push_back({{"tilt_deg", limit}, {"area_m2", grid.area_m2(rad_from_deg(limit))}});
  return {{"height_m", grid.height_m}, {"areas", areas}};
}

void tell(const ReachTarget& target) {
  if (target.nominal.outcome != arm::IkOutcome::ok) {
    print("%-14s out of reach: %s\n", target.name.c_str(), arm::name(target.nominal.outcome));
    return;
  }
  print("%-14s tilt %5.1f deg, at worst %5.1f; within reach at %d of %d docking errors", target.name.c_str(),
        deg_from_rad(target.nominal.tilt_rad), deg_from_rad(target.worst_tilt_rad), target.reached, target.draws);
  if (std::isfinite(target.handle_clearance_m)) print("; %.1f mm clear of the handle", 1e3 * target.handle_clearance_m);
  print("\n");
}

// Why a mission may fail at a place that is within reach where the panel should stand.
std::vector<std::string> doubts_of(const std::vector<ReachTarget>& targets) {
  std::vector<std::string> doubts;
  for (const ReachTarget& target : targets) {
    if (target.nominal.outcome != arm::IkOutcome::ok) continue;
    if (target.reached < target.draws)
      doubts.push_back("the " + target.name + " is out of reach at " + std::to_string(target.draws - target.reached) + " of " +
                       std::to_string(target.draws) + " docking errors");
    if (target.handle_clearance_m >= 0) continue;
    char text[64];
    (void)std::snprintf(text, sizeof text, "%.1f mm into the handle's circle", -1e3 * target.handle_clearance_m);
    doubts.push_back("a press of the " + target.name + " comes " + text + ": at some angles of the handle the arm touches it");
  }
  return doubts;
}

int reach(const Options& options) {
  const std::string format = picture_format(options.out);
  scenario::Scenario scenario = scenario::load_scenario(options.scenario, options.set);
  scenario.told_arm = config::read_arm(config::named_file(scenario.file, "arm.urdf", scenario.arm.urdf)).arm;  // or why it cannot be read
  // At the height of the first of each kind: on most panels all of a kind are alike.
  std::vector<ReachGrid> grids;
  if (!scenario.panel.buttons.empty())
    grids.push_back(survey_grid(scenario, scenario.panel.buttons[0].height_m, closed_tip_m(scenario.told_arm)));
  if (!scenario.panel.valves.empty()) grids.push_back(survey_grid(scenario, scenario.panel.valves[0].handle_height_m, 0));
  const std::vector<ReachTarget> targets = survey_targets(scenario, options.draws);
  const std::vector<std::uint8_t> picture = draw_reach(scenario, grids, targets, format);
  record::write_file_atomically(options.out, {reinterpret_cast<const char*>(picture.data()), picture.size()});
  bool all = true;
  for (const ReachTarget& target : targets) all = all && target.nominal.outcome == arm::IkOutcome::ok;
  const std::vector<std::string> doubts = doubts_of(targets);
  tell_doubts(scenario.file, doubts);
  if (options.json) {
    Json json{{"scenario", scenario.name}, {"image", options.out}, {"targets", Json::array()}, {"heights", Json::array()}};
    for (const ReachTarget& target : targets) json["targets"].push_back(json_of(target));
    for (const ReachGrid& grid : grids) json["heights"].push_back(json_of(grid));
    json["doubts"] = doubts;
    print_json(json);
  } else {
    for (const ReachTarget& target : targets) tell(target);
    for (const ReachGrid& grid : grids) {
      print("%3.0f mm over the panel:", 1e3 * grid.height_m);
      for (const double limit : tilt_limits_deg)
        print(" %.3f m2 within %.0f deg%s", grid.area_m2(rad_from_deg(limit)), limit, limit < 20 ? "," : "\n");
    }
    print("%s\n", options.out.c_str());
  }
  return all && doubts.empty() ? done : failed;
}

}  // namespace

void add_reach(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("reach", "Draw where on the panel the tool can work, and within which tilt");
  auto options = std::make_shared<Options>();
  command->add_option("SCENARIO", options->scenario, "A file or a shipped name")->capture_default_str();
  command->add_option("--set", options->set, "path.to.key=value, as for run")->allow_extra_args(false);
  command->add_option("--out", options->out, "The picture, .png or .jpg")->capture_default_str();
  command->add_option("--draws", options->draws, "Docking errors to try")->check(CLI::Range(1, 1000000))->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return reach(*options); }; });
}

}  // namespace lf::app
