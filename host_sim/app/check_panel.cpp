#include "host_sim/app/check_panel.hpp"

#include <filesystem>
#include <sstream>

#include "hal/config/panel_file.hpp"
#include "hal/config/share.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/outside_picture.hpp"
#include "host_sim/app/reach_survey.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/input_error.hpp"

namespace lf::app {
namespace {

struct Feature {
  std::string kind, name;
  Vec2 at_m{0, 0};
  std::string does;  // what a task would ask of it
  double tilt_deg = 0;
  std::vector<std::string> problems;  // why the default robot does not; empty: it does
};

// The default scenario before this panel, with one task.
scenario::Scenario with_task(const std::string& file, const Json& task) {
  return scenario::load_scenario("default", {"panel.file=" + Json(file).dump(), "tasks=" + Json::array({task}).dump()});
}

// The file that a message begins with is the default scenario's, which the user did not write.
std::string without_file(const std::string& line) {
  const std::size_t colon = line.find(": ");
  return colon == std::string::npos ? line : line.substr(colon + 2);
}

// By the rules that a mission is held against before it begins.
std::vector<std::string> problems_of(const std::string& file, const Json& task) {
  std::vector<std::string> problems;
  try {
    scenario::check_runnable(with_task(file, task));
  } catch (const InputError& error) {
    std::istringstream lines(error.what());
    for (std::string line; std::getline(lines, line);) problems.push_back(without_file(line));
  }
  return problems;
}

double tilt_deg(const arm::Arm& arm, const Pose& base_from_panel, const Vec3& place_m, double tip_m) {
  const arm::Reach reach = reach_of_tip(arm, base_from_panel, place_m, tip_m, arm::JointVector::Zero());
  return reach.outcome == arm::IkOutcome::ok ? deg_from_rad(reach.tilt_rad) : NAN;
}

std::string range_text(const PanelLayout::Valve& valve, const config::ValveNature& nature) {
  char text[160], deep[32] = "";
  if (valve.depth_m() != valve.handle_thickness_m) std::snprintf(deep, sizeof deep, ", %.1f mm deep", 1e3 * valve.depth_m());
  std::snprintf(text, sizeof text, "%.0f to %.0f deg, at most %.3g N m, bar %.0f x %.1f mm%s%s, %s", deg_from_rad(valve.handle_min_rad),
                deg_from_rad(valve.handle_max_rad), nature.torque_nm, 1e3 * valve.handle_length_m, 1e3 * valve.handle_thickness_m, deep,
                valve.carried == PanelLayout::Carried::by_posts ? " on two posts" : "",
                valve.has_pointer() ? "with a pointer" : "without a pointer");
  return text;
}

std::vector<Feature> features_of(const std::string& file, const config::PanelFile& panel) {
  const arm::Arm arm = arm::arm5e();  // that of the shipped scenarios
  std::vector<Feature> features;
  const Pose base_from_panel = panel.layout.nominal_base_from_panel();
  for (std::size_t i = 0; i < panel.layout.valves.size(); ++i) {
    const PanelLayout::Valve& valve = panel.layout.valves[i];
    const std::string& name = panel.survey.names.valves[i];
    const double middle_deg = deg_from_rad((valve.handle_min_rad + valve.handle_max_rad) / 2);
    features.push_back({"valve", name, valve.at_m, range_text(valve, panel.survey.valves[i]),
                        tilt_deg(arm, base_from_panel, valve.handle_centre_m(), 0),
                        problems_of(file, {{"turn_valve", {{"valve", name}, {"to_deg", middle_deg}}}})});
  }
  for (std::size_t i = 0; i < panel.layout.buttons.size(); ++i) {
    const PanelLayout::Button& button = panel.layout.buttons[i];
    const std::string& name = panel.survey.names.buttons[i];
    char text[96];
    std::snprintf(text, sizeof text, "%.0f mm wide, %.0f mm high, stroke %.1f mm", 1e3 * button.width_m, 1e3 * button.height_m,
                  1e3 * button.stroke_m);
    features.push_back({"button", name, button.at_m, text, tilt_deg(arm, base_from_panel, button.face_m(), closed_tip_m(arm)),
                        problems_of(file, {{"press_buttons", {{"order", Json::array({name})}}}})});
  }
  return features;
}

Json json_of(const Feature& feature) {
  Json json{{"kind", feature.kind}, {"name", feature.name}, {"at_m", {feature.at_m.x(), feature.at_m.y()}}};
  json["tilt_deg"] = std::isfinite(feature.tilt_deg) ? Json(feature.tilt_deg) : Json(nullptr);
  json["can"] = feature.problems.empty();
  json["problems"] = feature.problems;
  return json;
}

void tell(const Feature& feature) {
  print("  %-7s %-10s at %+.3f %+.3f m: %s\n", feature.kind.c_str(), feature.name.c_str(), feature.at_m.x(), feature.at_m.y(),
        feature.does.c_str());
  if (feature.problems.empty()) print("          the robot can, at a tilt of %.1f deg\n", feature.tilt_deg);
  for (const std::string& problem : feature.problems) print("          the robot cannot: %s\n", problem.c_str());
}

}  // namespace

int check_panel(const std::string& file, const std::string& picture, bool json) {
  const std::string named = config::panel_file_of(file);
  const std::filesystem::path found = named == file ? std::filesystem::path(file) : config::share_folder() / named;
  const config::PanelFile panel = config::read_panel_file(found);
  const std::string whole = std::filesystem::absolute(found).string();
  const std::vector<Feature> features = features_of(whole, panel);
  if (!picture.empty()) {
    const scenario::Scenario usual = scenario::load_scenario("default", {});
    scenario::Scenario scenario = usual;
    scenario.panel = panel.layout;
    scenario.survey = panel.survey;
    draw_outside(scenario, usual, picture);
  }
  if (json) {
    Json document{{"file", file}, {"features", Json::array()}, {"markers", Json::array()}};
    for (const Feature& feature : features) document["features"].push_back(json_of(feature));
    for (const PanelLayout::Marker& marker : panel.layout.markers)
      document["markers"].push_back({{"id", marker.id}, {"at_m", {marker.centre_m.x(), marker.centre_m.y()}}, {"size_m", marker.size_m}});
    if (!picture.empty()) document["picture"] = picture;
    print_json(document);
    return done;
  }
  print("%s: %s, %s, %s\n", file.c_str(), count_of(panel.layout.valves.size(), "valve").c_str(),
        count_of(panel.layout.buttons.size(), "button").c_str(), count_of(panel.layout.markers.size(), "marker").c_str());
  for (const Feature& feature : features) tell(feature);
  for (const PanelLayout::Marker& marker : panel.layout.markers)
    print("  marker  %-10d at %+.3f %+.3f m: %.0f mm\n", marker.id, marker.centre_m.x(), marker.centre_m.y(), 1e3 * marker.size_m);
  print("before the default robot, at its place in the default scenario\n");
  if (!picture.empty()) print("picture: %s\n", picture.c_str());
  return done;
}

}  // namespace lf::app
