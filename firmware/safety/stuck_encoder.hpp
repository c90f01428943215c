// A position that stands still while its set-point goes on and nothing holds the joint: what is reported is not where the joint is.
//
// A drive whose encoder is stuck goes on moving its joint, and faster the farther the set-point is. Drives that follow show the first count within 0.1 s, and
// lag by less than a tenth of these thresholds.
#pragma once

#include <cmath>
#include <cstdint>

#include "shared/messages/time.hpp"

namespace lf::safety {

class StuckEncoder {
 public:
  static constexpr std::int64_t least_counts = 8;
  static constexpr double least_rad = 0.003;  // of the set-point, since the position last changed
  static constexpr Duration least_time = Duration::from_ms(300);
  static constexpr double load_nm = 4;  // a joint whose torque has changed by this since then may be held by something
  // Nothing holds a joint for longer short of the end of its torque: its drive winds it up. In rad s from least_rad on, 1 s at 3 mrad: a joint that is not
  // held goes by this times the gain of its position loop meanwhile, 0.06 rad at the simulator's 20 a second.
  static constexpr double held_rad_s = 0.003;
  static constexpr Duration blind_time =
      Duration::from_ms(100);  // without a count, though the set-point goes on: no torque proves a contact then

  struct Sample {
    Time t;
    std::int32_t actual_counts = 0, target_counts = 0;
    double rad_per_count = 0;
    double torque_nm = 0;
    bool follows = false;  // it has power, is told where to go, and is not at the end of its torque
  };

  // True while it is stuck.
  bool update(const Sample& now) {
    if (!now.follows || !began_.follows || now.actual_counts != began_.actual_counts) {
      began_ = now;
      last_ = now.t;
      behind_rad_s_ = 0;
      shows_nothing_ = false;
      return false;
    }
    const std::int64_t gone = std::abs(std::int64_t{now.target_counts} - began_.target_counts);
    const double gone_rad = static_cast<double>(gone) * std::abs(now.rad_per_count);
    const bool left_behind = gone >= least_counts && gone_rad >= least_rad;
    if (left_behind) behind_rad_s_ += gone_rad * (now.t - last_).s();
    last_ = now.t;
    const bool held = std::abs(now.torque_nm - began_.torque_nm) >= load_nm && behind_rad_s_ < held_rad_s;
    shows_nothing_ = left_behind && now.t - began_.t >= blind_time;
    return left_behind && !held && now.t - began_.t >= least_time;
  }

  // Its torque may be that of a joint which runs off unseen. An arm that meets something goes on showing counts until it is stopped.
  bool shows_nothing() const { return shows_nothing_; }

 private:
  Sample began_;
  Time last_;
  double behind_rad_s_ = 0;
  bool shows_nothing_ = false;
};

}  // namespace lf::safety
