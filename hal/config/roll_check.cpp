#include "hal/config/roll_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "firmware/arm/inverse_kinematics.hpp"
#include "hal/config/task_reach.hpp"

namespace lf::config {

namespace {

constexpr double step_rad = 0.1, shortest_share = 0.25;
// What the core keeps off the limits, and what the panel may be turned by.
constexpr double margin_rad = 0.01;
constexpr double nearly_there_rad = 0.05;

struct RollRange {
  double lower_rad = 0, upper_rad = 0;
};

bool can_begin(const Machine& machine, const arm::JointVector& q_rad, double from_rad, double to_rad, const RollRange& range) {
  const Mat3 base_from_panel = machine.panel.nominal_base_from_panel().linear();
  const Vec3 bar = base_from_panel * Vec3(-std::sin(from_rad), std::cos(from_rad), 0);
  const std::optional<arm::BarRolls> rolls = arm::rolls_for_bar(machine.arm, q_rad, bar);
  // Seen along the tool, into the panel, the handle turns the other way round.
  return rolls && arm::roll_for_turn(*rolls, shortest_share * (from_rad - to_rad), range.lower_rad, range.upper_rad);
}

std::vector<std::string> no_roll_problems(const Machine& machine) {
  const std::size_t last = machine.arm.arm_joints() - 1;
  std::vector<std::string> problems;
  for (const Task& task : machine.tasks) {
    const std::optional<std::size_t> valve =
        task.kind == Task::Kind::turn_valve ? find_valve(machine.survey.names, task.valve) : std::nullopt;
    if (!valve) continue;
    problems.push_back(valve_text(machine.survey.names, *valve) + " cannot be turned: this arm has no roll, its last joint, '" +
                       std::string(machine.joints[last]) + "', swings the hand. It presses buttons");
  }
  return problems;
}

}  // namespace

std::vector<std::string> roll_problems(const Machine& machine, const safety::Limits& limits) {
  if (!machine.arm.rolls()) return no_roll_problems(machine);
  const ArmModel::Joint& roll = machine.arm.joint(machine.arm.roll_joint());
  const safety::JointLimit& limit = limits.joints[machine.arm.roll_joint()];
  const double off_rad = margin_rad + machine.mission.docking.turn_rad;
  const RollRange range{std::max(roll.lower_rad, limit.min_rad) + off_rad, std::min(roll.upper_rad, limit.max_rad) - off_rad};
  std::vector<std::string> problems;
  for (const Task& task : machine.tasks) {
    if (task.kind != Task::Kind::turn_valve) continue;
    const std::optional<std::size_t> valve = find_valve(machine.survey.names, task.valve);
    if (!valve) continue;
    const arm::IkResult at_bar = pose_at(machine, place_of_valve(machine, *valve));
    if (!at_bar.ok()) continue;
    const PanelLayout::Valve& handle = machine.panel.valves[*valve];
    const double to_rad = rad_from_deg(task.to_deg);
    const int steps = static_cast<int>((handle.handle_max_rad - handle.handle_min_rad) / step_rad);
    for (int i = 0; i <= steps; ++i) {
      const double from_rad = handle.handle_min_rad + i * step_rad;
      if (std::abs(from_rad - to_rad) < nearly_there_rad || can_begin(machine, at_bar.q_rad, from_rad, to_rad, range)) continue;
      char text[240];
      std::snprintf(text, sizeof text, ": a handle at %.0f deg cannot be turned toward %.0f: the wrist's roll goes from %.0f to %.0f deg",
                    deg_from_rad(from_rad), task.to_deg, deg_from_rad(range.lower_rad - off_rad), deg_from_rad(range.upper_rad + off_rad));
      problems.push_back("'turn_valve.to_deg' of " + valve_text(machine.survey.names, *valve) + text);
      break;
    }
  }
  return problems;
}

}  // namespace lf::config
