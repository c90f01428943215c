// A joint whose drive follows a target, or does not, and what the watch makes of it.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "firmware/safety/stuck_encoder.hpp"

namespace lf::safety::test {

inline constexpr double never = 10;  // s
inline constexpr double rad_per_count = 1.3e-4;
inline constexpr double end_nm = 13;  // of a joint's torque, as the watch has it by default

// A joint at its target, and what is made of it from now on.
struct FollowingJoint {
  StuckEncoder encoder;
  StuckEncoder::Sample now;
  FollowingJoint() {
    now.rad_per_count = rad_per_count;
    (void)encoder.update(now);  // without power
    now.follows = true;
  }

  // `change` makes the sample after so many seconds. Seconds until it is found stuck; `never` when it is not.
  double run(const std::function<void(StuckEncoder::Sample&, double)>& change, double for_s = never) {
    const Time began = now.t;
    while (now.t - began < Duration::from_s(for_s)) {
      now.t = now.t + Duration::from_ms(4);
      const double s = (now.t - began).s();
      change(now, s);
      now.holds_much = std::abs(now.torque_nm) >= end_nm;
      if (encoder.update(now)) return s;
    }
    return never;
  }
  // The target goes at `counts_s`, the position follows at `share` of it, the torque rises.
  double go(double counts_s, double share, double torque_nm_s = 0, double for_s = never) {
    const std::int32_t from = now.actual_counts;
    const double from_nm = now.torque_nm;
    return run(
        [=](StuckEncoder::Sample& sample, double s) {
          sample.target_counts = from + static_cast<std::int32_t>(std::lround(counts_s * s));
          sample.actual_counts = from + static_cast<std::int32_t>(std::lround(share * counts_s * s));
          sample.torque_nm = from_nm + torque_nm_s * s;
        },
        for_s);
  }
  void stand(double for_s) {
    (void)run([](StuckEncoder::Sample&, double) {}, for_s);
  }
  // It stays where it is, and the target so many counts off.
  double left_at(std::int32_t counts, double torque_nm, double for_s = never) {
    return run(
        [=](StuckEncoder::Sample& sample, double) {
          sample.target_counts = sample.actual_counts + counts;
          sample.torque_nm = torque_nm;
        },
        for_s);
  }
};

// A reading's noise, up to `by` counts either way.
inline std::int32_t waver(double s, std::int32_t by) {
  const auto tick = static_cast<std::uint32_t>(std::lround(s / 4e-3));
  return static_cast<std::int32_t>((tick * 2654435761U >> 16) % (2 * static_cast<std::uint32_t>(by) + 1)) - by;
}

}  // namespace lf::safety::test
