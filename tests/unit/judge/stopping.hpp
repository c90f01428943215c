// Runs made by hand, whose times are known to the millisecond.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "host_sim/judge/verdict.hpp"

namespace lf::judge {

inline constexpr std::uint8_t all_joints = 0x1F;

inline Cause cause_of(const std::string& name) {
  for (const Cause& cause : all_causes()) {
    if (cause.name() == name) return cause;
  }
  ADD_FAILURE() << "no cause " << name;
  return {};
}

// The elbow moves at 0.3 rad/s when its drive reports a fault at 100 ms. The stop is on the bus `stop_ms` later, the elbow brakes with 2 rad/s2, and
// the power goes off `off_ms` after it stands.
struct Stopping {
  int stop_ms = 8, off_ms = 50;
  double force_n = 20, grip_n = 0, stands_at_rad_s = 0;
  double pulled_rad = 0;  // the joint, by a motor that stands, in 50 ms
  int pulled_ms = 600;    // then

  Seen seen() const {
    Seen seen;
    seen.fault_reported_s = 0.100;
    seen.last_heard_s.fill(3);
    double angle_rad = 0, motor_rad = 0;
    for (int t = 0; t < 3000; ++t) {
      Moment moment;
      const int braking_ms = t - (100 + stop_ms);
      double speed = std::clamp(0.3 - 0.002 * braking_ms, stands_at_rad_s, 0.3);
      motor_rad += 0.001 * speed;
      if (t >= pulled_ms && t < pulled_ms + 50) speed += pulled_rad / 0.050;
      angle_rad += 0.001 * speed;
      moment.speed_rad_s[2] = static_cast<float>(speed);
      moment.angle_rad[2] = static_cast<float>(angle_rad);
      moment.motor_rad[2] = static_cast<float>(motor_rad);
      moment.force_n = static_cast<float>(force_n);
      moment.grip_n = static_cast<float>(grip_n);
      moment.told_to_run = braking_ms < 0 ? all_joints : 0;
      moment.power = braking_ms < 140 + off_ms ? all_joints : 0;  // 0.02 rad/s are reached after 140 ms
      seen.moments.push_back(moment);
    }
    return seen;
  }
};

inline Situation situation_of(const Cause& cause) {
  Situation situation;
  situation.causes = {cause};
  situation.begins_s = {0.09};
  situation.deceleration_rad_s2.fill(2);
  situation.gear_gives_rad.fill(0.004);
  situation.slips_rad.fill(0.004);
  return situation;
}

inline Ending failed(const std::string& reason) {
  Ending ending;
  ending.ended = true;
  ending.step = "stopped";
  ending.reason = reason;
  return ending;
}

// Two causes 0.1 s apart, the first 90 ms after watching began.
inline Situation situation_of(const Cause& first, const Cause& second) {
  Situation situation = situation_of(first);
  situation.causes.push_back(second);
  situation.begins_s.push_back(0.19);
  return situation;
}

}  // namespace lf::judge
