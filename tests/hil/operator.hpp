// An operator at the test bench: orders given to a rig, and what they come to.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "tests/arm5e_joints.hpp"
#include "tests/hil/rig.hpp"

namespace lf::test {

// Half a second on the motion's own way (mission/motion.cpp), the drives behind it, and the arm's swing.
inline constexpr double halt_time_s = 0.9;
inline constexpr double standing_rad_s = 0.02;

inline std::vector<std::string> turn_only() { return {"tasks=[{turn_valve: {to_deg: 90}}]"}; }
inline std::vector<std::string> press_only() { return {"tasks=[{press_buttons: {order: [centre]}}]"}; }

inline bool give(Rig& rig, Command command) { return rig.controller().on_command(command, rig.now()); }

inline bool jog(Rig& rig, std::size_t joint, double by_rad) {
  mission::Order order;
  order.command = Command::jog;
  order.joint = joint;
  order.by_rad = by_rad;
  return rig.controller().on_order(order, rig.now());
}

inline bool set_tasks(Rig& rig, std::initializer_list<mission::Task> tasks) {
  mission::Order order;
  order.command = Command::set_tasks;
  for (const mission::Task& task : tasks) EXPECT_TRUE(order.tasks.push_back(task));
  return rig.controller().on_order(order, rig.now());
}

inline bool run_until(Rig& rig, mission::Standing wanted, double limit_s) {
  const Time end = rig.now() + Duration::from_s(limit_s);
  while (rig.mission().standing() != wanted && rig.now() < end) rig.step();
  return rig.mission().standing() == wanted;
}

inline bool home(Rig& rig) { return give(rig, Command::home) && run_until(rig, mission::Standing::ready, 30); }

inline double angle_rad(const Rig& rig, std::size_t joint) { return rig.world().readings()[static_cast<std::size_t>(joint)].position_rad; }

inline PerJoint<double> angles_rad(const Rig& rig) {
  PerJoint<double> all{};
  for (std::size_t i = 0; i < rig.arm().joints.size(); ++i) all[i] = angle_rad(rig, i);
  return all;
}

inline double farthest_apart(const PerJoint<double>& a, const PerJoint<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

// Lets the ordered jog end; false when it takes longer than a person would wait.
inline bool finish_jog(Rig& rig) {
  rig.run_for(0.02);
  return run_until(rig, mission::Standing::ready, 20);
}

}  // namespace lf::test
