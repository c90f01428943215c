#include "hal/config/sweep_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "firmware/arm/gripper.hpp"
#include "firmware/mission/look.hpp"
#include "firmware/mission/motion.hpp"
#include "hal/config/limits_check.hpp"
#include "hal/config/task_reach.hpp"

namespace lf::config {

namespace {

using arm::JointVector;

// A bar is seen from several lines across it. With lines 0.57 of its thickness apart it was found in 4 of 4 missions, with 0.79 in none of 2.
constexpr double widest_of_bar = 0.65;

std::string formatted(const char* form, ...) __attribute__((format(printf, 1, 2)));

std::string formatted(const char* form, ...) {
  char text[320];
  va_list values;
  va_start(values, form);
  std::vsnprintf(text, sizeof text, form, values);
  va_end(values);
  return text;
}

std::string docking_text(const mission::MissionConfig& mission) {
  return formatted("with 'mission.docking_m' at %.3g and 'mission.docking_rad' at %.3g", mission.docking.shift_m, mission.docking.turn_rad);
}

// The key of what stands out of the panel the most: the sweep passes over it. Empty on a bare plate.
std::string tallest_key(const PanelLayout& layout, const PanelSurvey& survey) {
  double most_m = 0;
  std::string key;
  for (std::size_t i = 0; i < layout.valves.size(); ++i)
    if (layout.valves[i].front_m() > most_m) most_m = layout.valves[i].front_m(), key = valve_key(survey, i, "height_m");
  for (std::size_t i = 0; i < layout.buttons.size(); ++i)
    if (layout.buttons[i].height_m > most_m) most_m = layout.buttons[i].height_m, key = button_key(survey, i, "height_m");
  return key;
}

std::string words(scan::SweepOutcome outcome, const PanelLayout& layout, const PanelSurvey& survey, bool planar) {
  const std::string min = plate_key(survey, "min_m"), max = plate_key(survey, "max_m"), tallest = tallest_key(layout, survey);
  switch (outcome) {
    case scan::SweepOutcome::top_unreachable:
      return "no pose of the arm puts the laser's line above the panel: see 'laser.position_m' and " + max;
    case scan::SweepOutcome::bottom_unreachable:
      return "no pose of the arm puts the laser's line below the panel: see 'laser.position_m' and " + min;
    case scan::SweepOutcome::fan_too_narrow:
      return "the laser's line is shorter than the panel is wide: see 'laser.fan_half_angle_deg', 'laser.position_m', " + min + " and " +
             max;
    case scan::SweepOutcome::no_way:
      return planar ? "the tool would come too near to the panel: see 'laser.position_m', " + min + ", " + max +
                          (tallest.empty() ? "" : " and " + tallest)
                    : "the arm would come too near to something, or hide the line from the camera: see 'laser.position_m' and "
                      "'camera.position_m'";
    case scan::SweepOutcome::bad_request:
    case scan::SweepOutcome::ok: break;
  }
  return "the sweep is not defined";
}

// What a part is called, and the keys that put it where it stands, for the end of a message.
std::string words(arm::PanelPart part, const PanelSurvey& survey) {
  using Kind = arm::PanelPart::Kind;
  switch (part.kind) {
    case Kind::plate: return "plate";
    case Kind::marker_plate:
      return survey.names.markers.at(part.index) == "marker" ? "marker plate" : "plate of marker " + survey.names.markers.at(part.index);
    case Kind::button: return survey.names.buttons.at(part.index) + " button";
    case Kind::valve: return survey.names.valves.at(part.index) == "valve" ? "handle" : "handle of " + survey.names.valves.at(part.index);
    case Kind::none: break;
  }
  return "none";
}

std::string keys_of(arm::PanelPart part, const PanelSurvey& survey) {
  using Kind = arm::PanelPart::Kind;
  switch (part.kind) {
    case Kind::plate: return ": see " + plate_key(survey, "min_m") + " and " + plate_key(survey, "max_m");
    case Kind::marker_plate: return ": see " + marker_key(survey, part.index, "at_m") + " and " + marker_key(survey, part.index, "plate_m");
    case Kind::button: return ": see " + button_key(survey, part.index, "at_m") + " and " + button_key(survey, part.index, "height_m");
    case Kind::valve: return ": see " + valve_key(survey, part.index, "height_m") + " and " + valve_key(survey, part.index, "length_m");
    case Kind::none: break;
  }
  return "";
}

// What is nearest to the arm in one pose, and how near.
struct Nearest {
  double distance_m = HUGE_VAL;
  std::string what;
  std::string keys;  // for the end of the message
};

class Neighbours {
 public:
  Neighbours(const arm::Arm& arm, const mission::MissionConfig& mission, const PanelSurvey& survey)
      : arm_(arm),
        mission_(mission),
        survey_(survey),
        base_from_panel_(mission.layout.nominal_base_from_panel()),
        panel_(arm::PanelShape(mission.layout).grown(base_from_panel_, mission.docking)) {}

  Nearest of(const JointVector& q_rad, double jaw_rad) const {
    const arm::LinkCapsules capsules = arm_.link_capsules(q_rad, jaw_rad);
    const arm::Clearance panel = panel_.clearance(capsules, base_from_panel_);
    Nearest nearest{panel.distance_m, "the panel's " + words(panel.part, survey_) + ", " + docking_text(mission_),
                    keys_of(panel.part, survey_) + place_text(mission_.layout)};
    const auto hold_against = [&](double distance_m, const std::string& what) {
      if (distance_m < nearest.distance_m) nearest = {distance_m, what, ""};
    };
    for (std::size_t i = 0; i < mission_.vehicle.boxes.size(); ++i) {
      arm::VehicleShape one;
      (void)one.boxes.push_back(mission_.vehicle.boxes[i]);
      const Vec3& at = mission_.vehicle.boxes[i].centre_m;
      hold_against(arm::clearance_to_vehicle(capsules, one),
                   formatted("box %zu of 'vehicle.boxes_m', at [%.3g, %.3g, %.3g]", i + 1, at.x(), at.y(), at.z()));
    }
    for (std::size_t i = 0; i < mission_.vehicle.rods.size(); ++i) {
      arm::VehicleShape one;
      (void)one.rods.push_back(mission_.vehicle.rods[i]);
      const Vec3& at = mission_.vehicle.rods[i].a_m;
      hold_against(arm::clearance_to_vehicle(capsules, one),
                   formatted("capsule %zu of 'vehicle.capsules_m', at [%.3g, %.3g, %.3g]", i + 1, at.x(), at.y(), at.z()));
    }
    hold_against(arm::clearance_to_itself(capsules), "the arm itself");
    return nearest;
  }

 private:
  const arm::Arm& arm_;
  const mission::MissionConfig& mission_;
  const PanelSurvey& survey_;
  Pose base_from_panel_;
  arm::PanelShape panel_;
};

std::string too_near(const char* when, const Nearest& nearest) {
  return formatted("%s the arm comes as near as %.0f mm to ", when, 1e3 * std::max(0.0, nearest.distance_m)) + nearest.what +
         formatted("; it has to keep %.0f mm off", 1e3 * mission::clearance_m) + nearest.keys;
}

JointVector vector_of(const PerArmJoint<double>& q) { return JointVector(q.data()); }

// An arm of many joints gets there if it is folded in much the same posture.
std::string begin_text(const arm::Arm& arm, const scan::SweepPlan& plan) {
  if (arm.is_planar()) return "";
  std::string text = "; the sweep begins at [";
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) text += formatted(i == 0 ? "%.2f" : ", %.2f", plan.start_rad[i]);
  return text + "] rad: 'arm.park_rad' may be too far from there";
}

// With what of the limits keeps the arm from it, where that is seen at the sweep's ends.
std::string unreachable_text(const arm::Arm& arm, const JointNames& names, const safety::Limits& limits, const PanelLayout& panel,
                             const scan::SweepPlan& plan) {
  std::string text =
      "the arm does not reach the poses from which the laser is swept over the panel: see 'laser.position_m'" + place_text(panel);
  std::vector<std::string> problems = pose_problems(arm, names, limits, vector_of(plan.start_rad), "the sweep's start");
  for (const std::string& problem : pose_problems(arm, names, limits, vector_of(plan.end_rad), "the sweep's end"))
    problems.push_back(problem);
  for (const std::string& problem : problems) text += "; in the safety limits " + problem;
  return text;
}

}  // namespace

std::optional<std::string> fold_problem(const ControllerConfig& controller, const PanelSurvey& survey) {
  constexpr int angles = 8;
  const Neighbours neighbours(controller.arm, controller.mission, survey);
  const ArmModel::Jaw& jaw = controller.arm.jaw();
  Nearest nearest;
  for (int i = 0; i <= angles; ++i) {
    const double jaw_rad = std::lerp(jaw.lower_rad, jaw.upper_rad, static_cast<double>(i) / angles);
    const Nearest parked = neighbours.of(controller.mission.park_rad, jaw_rad);
    if (parked.distance_m < nearest.distance_m) nearest = parked;
  }
  if (nearest.distance_m >= mission::clearance_m) return std::nullopt;
  return too_near("'arm.park_rad': folded up", nearest);
}

std::optional<std::string> sweep_problem(const ControllerConfig& controller, const JointNames& names, const PanelSurvey& survey) {
  const mission::MissionConfig& mission = controller.mission;
  const Neighbours neighbours(controller.arm, mission, survey);
  const double jaw_rad = arm::jaw_from_gap(controller.arm.jaw(), 0);
  if (const Nearest parked = neighbours.of(mission.park_rad, jaw_rad); parked.distance_m < mission::clearance_m)
    return too_near("folded up", parked);

  scan::SweepRequest request = mission::sweep_over_panel(mission);
  request.camera_m = controller.camera.base_from_camera.translation();
  const arm::Room room{request.base_from_panel, mission.docking, {jaw_rad, jaw_rad}, 0};
  arm::Surroundings surroundings(controller.arm, mission.layout, mission.vehicle);
  surroundings.enter(room);
  const scan::SweepPlan plan = scan::plan_sweep(controller.arm, request, controller.laser, mission.park_rad, surroundings);
  if (plan.outcome != scan::SweepOutcome::ok) {
    return "the laser cannot be swept over the whole panel wherever it may stand " + docking_text(mission) + ": " +
           words(plan.outcome, mission.layout, survey, controller.arm.is_planar()) + place_text(mission.layout);
  }
  if (!controller.arm.is_planar()) {
    for (const auto& [q_rad, where] : {std::pair{plan.start_rad, "the sweep's start"}, {plan.end_rad, "the sweep's end"}}) {
      for (const std::string& problem : pose_problems(controller.arm, names, controller.mission_limits, vector_of(q_rad), where))
        return "in the safety limits " + problem;
    }
  }
  const double frame_share = mission.camera_syncs * can_map::sync_period.s() / request.stripe_period.s();
  const double spacing_m = plan.widest_spacing_m * frame_share;
  for (std::size_t i = 0; i < mission.layout.valves.size(); ++i) {
    const double widest_m = widest_of_bar * mission.layout.valves[i].handle_thickness_m;
    const bool turned = std::any_of(mission.tasks.begin(), mission.tasks.end(), [&](const mission::Task& task) {
      return task.kind == mission::Task::Kind::turn_valve && task.valve == i;
    });
    if (spacing_m <= widest_m || (!survey.file.empty() && !turned)) continue;
    return "the laser's lines would lie " + formatted("%.1f mm", 1e3 * spacing_m) + " apart on the panel " + docking_text(mission) +
           formatted(", 'mission.sweep_speed_rad_s' at %.3g and 'mission.camera_syncs' at %u: no more than %.1f mm show a handle of this ",
                     mission.sweep_speed_rad_s, static_cast<unsigned>(mission.camera_syncs), 1e3 * widest_m) +
           valve_key(survey, i, "thickness_m") + "; see also 'laser.fan_half_angle_deg', 'laser.position_m', " +
           plate_key(survey, "min_m") + " and " + plate_key(survey, "max_m") + place_text(mission.layout);
  }
  mission::Motion motion(controller.arm, controller.mission_limits, mission.layout, mission.vehicle, mission.park_rad);
  motion.start_at(mission.park_rad);
  motion.go_to_sweep(request, controller.laser, room, jaw_rad, mission.move_speed_fraction);
  while (motion.planning()) motion.step(can_map::sync_period.s());
  if (motion.failure() == StepFailure::none) return std::nullopt;
  if (motion.failure() == StepFailure::unreachable)
    return unreachable_text(controller.arm, names, controller.mission_limits, mission.layout, plan);

  // The sweep, and the straight way to it: the core looks at more poses, and stops at the first that is too near.
  constexpr int poses = 200;
  Nearest nearest;
  const auto look_along = [&](const JointVector& from_rad, const JointVector& to_rad) {
    for (int i = 0; i <= poses; ++i) {
      const Nearest here = neighbours.of(from_rad + (to_rad - from_rad) * i / poses, jaw_rad);
      if (here.distance_m < nearest.distance_m) nearest = here;
    }
  };
  look_along(mission.park_rad, vector_of(plan.start_rad));
  look_along(vector_of(plan.start_rad), vector_of(plan.end_rad));
  return too_near("sweeping the laser over the panel", nearest) + begin_text(controller.arm, plan);
}

}  // namespace lf::config
