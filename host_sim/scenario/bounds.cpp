#include "host_sim/scenario/bounds.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "firmware/arm/gripper.hpp"
#include "hal/config/handle_check.hpp"
#include "hal/config/homing_file.hpp"
#include "hal/config/limits_file.hpp"
#include "hal/config/panel_check.hpp"
#include "hal/config/share.hpp"
#include "shared/arm/motor.hpp"

namespace lf::scenario {

namespace {

// Force at which a press ends, over the torque that says bottom. A button of 20 N at half its stroke is pressed with 7 N m, one of 25 N is not; 30 N with 14.
constexpr double force_of_press_n_nm = 20.0 / 7;
// A bound that must not be met is missed by this share of itself, or of the range.
constexpr double clearly = 0.01;
// What comes on top of a latency, at most: the SYNC that looks for an image, and the frames of a question and its answer.
constexpr double image_reserve_s = 0.004, vision_reserve_s = 0.02;

Bounds within(const config::Key& key, double min, double max) {
  const double least = std::clamp(min, key.min, key.max);
  return {least, std::clamp(max, least, key.max)};
}

Bounds of_stops(const config::Key& key, const Scenario& s) {
  if (key.path == "tasks" || key.path == "valve.start_deg") return {s.valve.stop_min_deg, s.valve.stop_max_deg};
  double least = s.valve.start_deg.min, most = s.valve.start_deg.max;
  for (const Task& task : s.tasks) {
    if (task.kind != Task::Kind::turn_valve) continue;
    least = std::min(least, task.to_deg);
    most = std::max(most, task.to_deg);
  }
  if (key.path == "valve.stop_min_deg") return within(key, s.valve.stop_max_deg - config::widest_range_deg, least);
  return within(key, most, s.valve.stop_min_deg + config::widest_range_deg);
}

// The longest of the buttons' strokes by std::greater, the shortest by std::less; that of today's button where there is none.
template <typename Before>
double stroke_m(const PanelLayout& panel, Before before) {
  std::optional<double> best_m;
  for (const PanelLayout::Button& button : panel.buttons) {
    if (!best_m || before(button.stroke_m, *best_m)) best_m = button.stroke_m;
  }
  return best_m.value_or(PanelLayout::Button{}.stroke_m);
}

Bounds of_buttons(const config::Key& key, const Scenario& s) {
  const double half_way_m = stroke_m(s.panel, std::greater()) / 2, pressed_n = pressed_force_n(s);
  const Buttons& b = s.buttons;
  if (key.path == "buttons.preload_n") return within(key, key.min, pressed_n - b.spring_n_m * half_way_m);
  if (key.path == "buttons.spring_n_m")
    return within(key, (b.click_drop_n - b.preload_n) / b.release_depth_m * (1 + clearly), (pressed_n - b.preload_n) / half_way_m);
  if (key.path == "buttons.click_depth_m") return within(key, b.release_depth_m * (1 + clearly), stroke_m(s.panel, std::less()));
  if (key.path == "buttons.release_depth_m") return within(key, key.min, b.click_depth_m * (1 - clearly));
  if (key.path == "buttons.click_drop_n") return within(key, key.min, returning_force_n(s) * (1 - clearly));
  return {key.min, key.max};
}

// The lower a cap, the more aslant the arm comes to it: the height that is asked for depends on the height.
double lowest_button_m(const Scenario& s) {
  config::Machine work = work_of(s);
  for (int i = 0; i < 4; ++i) {
    const double lowest_m = config::lowest_button_m(work, work.panel.buttons[0]);
    for (PanelLayout::Button& button : work.panel.buttons) button.height_m = lowest_m;
  }
  return work.panel.buttons[0].height_m + 1e-6;
}

Bounds of_panel(const config::Key& key, const Scenario& s) {
  if (!s.survey.file.empty()) return {key.min, key.max};  // a file's panel has no such keys
  const PanelLayout& panel = s.panel;
  const PanelLayout::Valve& valve = panel.valves[0];
  const PanelLayout::Button& button = panel.buttons[0];
  const PanelLayout::Marker& marker = panel.markers[0];
  const double lowest_m = lowest_button_m(s);
  if (key.path == "panel.button_stroke_m")
    return within(key, s.buttons.click_depth_m,
                  std::min(2 * (pressed_force_n(s) - s.buttons.preload_n) / s.buttons.spring_n_m,
                           button.stroke_m + button.height_m - config::lowest_button_m(work_of(s), button) - 1e-6));
  if (key.path == "panel.button_height_m") return within(key, lowest_m, key.max);
  if (key.path == "panel.marker_size_m") return within(key, key.min, marker.plate_m * (1 - clearly));
  if (key.path == "panel.marker_plate_m")
    return within(key, marker.size_m * (1 + clearly), config::largest_marker_plate_m(panel, marker) * (1 - clearly));
  if (key.path == "panel.handle_thickness_m")
    return within(key, arm::thinnest_bar_m(s.told_arm.jaw()), config::thickest_bar_m(s.told_arm.jaw(), valve));
  if (key.path == "panel.pointer_length_m") return within(key, key.min, config::longest_mark_m(valve));
  return {key.min, key.max};
}

Bounds of_latency(const config::Key& key, const Scenario& s) {
  const LongestLatencies longest = longest_latencies(s);
  return within(key, key.min, key.path == "latency.image_ms" ? longest.image_ms : longest.panel_vision_ms);
}

// Of a joint's motor, or of all of them.
Bounds of_drives(const config::Key& key, const Scenario& s, const ArmDescription& arm) {
  Bounds bounds{key.min, key.max};
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const bool all = key.path == "drives.counts_per_rev";
    if (!all && !key.path.starts_with("drives." + arm.joints[i].name + ".")) continue;
    const double counts = config::drive_of(s.drives, i).counts_per_rev;
    if (key.path.ends_with(".counts_per_rev"))
      bounds = within(key, bounds.min, std::min(bounds.max, best_motor_ratio(arm.joints[i], counts) * counts * (1 - clearly)));
    if (key.path.ends_with(".rated_torque_nm")) {
      const double nm = motor_of(arm.joints[i], counts).rated_torque_nm;
      bounds = within(key, nm / (1 + rating_apart_share) * (1 + clearly), nm / (1 - rating_apart_share) * (1 - clearly));
    }
  }
  return bounds;
}

}  // namespace

double pressed_force_n(const Scenario& s) { return force_of_press_n_nm * s.mission.press_torque_nm; }

double returning_force_n(const Scenario& s) { return s.buttons.preload_n + s.buttons.spring_n_m * s.buttons.release_depth_m; }

LongestLatencies longest_latencies(const Scenario& s) {
  const bool own = !s.safety.mission_limits.empty();
  const std::string file =
      config::named_file(s.file, own ? "safety.mission_limits" : "safety.limits", own ? s.safety.mission_limits : s.safety.limits);
  const safety::Limits limits = config::read_limits(file, s.joints);
  return {std::max(0.0, 1e3 * (limits.stale_image_s - image_reserve_s)), std::max(0.0, 1e3 * (limits.vision_timeout_s - vision_reserve_s)),
          file};
}

Bounds bounds_of(const config::Key& key, const Scenario& scenario, const ArmDescription& arm) {
  if (key.path == "tasks" || key.path == "valve.start_deg" || key.path.starts_with("valve.stop_")) return of_stops(key, scenario);
  if (key.path == "mission.press_torque_nm") {
    const Buttons& b = scenario.buttons;
    return within(key, (b.preload_n + b.spring_n_m * stroke_m(scenario.panel, std::greater()) / 2) / force_of_press_n_nm, key.max);
  }
  if (key.path.starts_with("buttons.")) return of_buttons(key, scenario);
  if (key.path.starts_with("panel.")) return of_panel(key, scenario);
  if (key.path == "jaw.torque_nm") return within(key, arm.jaw().rated_torque_nm, key.max);
  if (key.path.starts_with("latency.")) return of_latency(key, scenario);
  if (key.path.starts_with("drives.")) return of_drives(key, scenario, arm);
  return {key.min, key.max};
}

}  // namespace lf::scenario
