// A joint that stays behind its target, shows no way towards it, and that nothing holds: what its encoder reports is not where it is.
//
// A drive whose encoder is stuck goes on moving its joint, at the gain of its position loop times the lag, and faster the farther the target is. So the lag is
// summed while the joint shows nothing: the sum times the gain is the way that the joint has gone unseen. A drive that follows shows a count within 0.1 s.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "shared/messages/time.hpp"

namespace lf::safety {

class StuckEncoder {
 public:
  // A joint is behind from both on, until it is within half of either.
  static constexpr std::int64_t behind_counts = 8;
  static constexpr double behind_rad = 0.001;
  // An encoder lives that goes so far towards its target beyond all that it showed before, or so far away from there: one that wavers about its place does not.
  static constexpr std::int64_t alive_counts = 2, alive_away_counts = 8;
  // It is told after both: 0.5 s at 3 mrad, 0.3 s from 5 mrad on. A joint that is not held has gone the sum times its loop's gain meanwhile: 0.03 rad at the
  // simulator's 20 a second. One that turns back has to unwind its gear first: 0.2 s and 0.00066 rad s were seen.
  static constexpr Duration least_time = Duration::from_ms(300);
  static constexpr double least_rad_s = 0.0015;
  // Nothing holds a joint for longer short of the end of its torque: its drive winds it up. 1 s at 3 mrad, 0.06 rad at 20 a second.
  static constexpr double held_rad_s = 0.003;
  static constexpr double load_nm =
      4;  // a joint that pushes by so much more towards its target than when it last followed may be held by something
  // So long and so far behind without coming nearer by a count, or going away: no torque proves a contact then. One count of a coarse encoder is so far, too.
  static constexpr Duration blind_time = Duration::from_ms(100);
  static constexpr double blind_rad = 0.003;
  static constexpr Duration longest_gap = Duration::from_ms(20);  // between samples: what lies beyond is not counted

  struct Sample {
    Time t;
    std::int32_t actual_counts = 0, target_counts = 0;
    double rad_per_count = 0;
    double torque_nm = 0;          // that the drive gives the joint
    bool follows = false;          // it has power and is told where to go
    bool at_torque_limit = false;  // what holds a joint that pushes so much holds it: nothing is summed then, and nothing told
  };

  // True while it is stuck.
  bool update(const Sample& now) {
    const Duration dt = std::min(now.t - last_, longest_gap);
    const std::int64_t lag = std::int64_t{now.target_counts} - now.actual_counts;
    const std::int64_t way = lag < 0 ? -1 : 1;
    const double lag_rad = std::abs(static_cast<double>(lag) * now.rad_per_count);
    const bool turned = way != way_;
    last_ = now.t;
    way_ = way;
    look(now, turned || !now.follows, lag_rad, dt);
    const bool with_it = std::abs(lag) <= behind_counts / 2 || lag_rad <= behind_rad / 2;
    const bool ends = with_it || !now.follows || (behind_ && turned);
    if (ends) behind_ = false;
    if (!behind_) {
      const bool moves = std::abs(std::int64_t{now.actual_counts} - shown_.actual_counts) >= alive_counts;
      if (ends || moves) shows(now);
      behind_ = std::abs(lag) >= behind_counts && lag_rad >= behind_rad;
      farthest_counts_ = now.actual_counts;
    }
    if (lives(now.actual_counts - farthest_counts_, alive_counts)) {
      shows(now);
      farthest_counts_ = now.actual_counts;
    }
    return behind_ && is_stuck(now, lag_rad, dt);
  }

  // Its torque may be that of a joint which runs off unseen. An arm that meets something goes on showing counts until it is stopped.
  bool shows_nothing() const { return shows_nothing_; }

 private:
  // A sign of life.
  void shows(const Sample& now) {
    shown_ = now;
    behind_for_ = Duration();
    behind_rad_s_ = 0;
  }

  bool lives(std::int64_t gone_counts, std::int64_t toward_counts) const {
    return way_ * gone_counts >= toward_counts || way_ * gone_counts <= -alive_away_counts;
  }

  void look(const Sample& now, bool anew, double lag_rad, Duration dt) {
    const bool moves = lives(now.actual_counts - nearest_counts_, 1);
    blind_for_ = blind_for_ + dt;
    if (anew || moves || lag_rad < blind_rad / 2) {
      blind_for_ = Duration();
      nearest_counts_ = now.actual_counts;
    }
    shows_nothing_ = lag_rad >= blind_rad && blind_for_ >= blind_time;
  }

  bool is_stuck(const Sample& now, double lag_rad, Duration dt) {
    const double toward = static_cast<double>(way_) * (now.rad_per_count < 0 ? -1 : 1);
    const bool held = toward * (now.torque_nm - shown_.torque_nm) >= load_nm;
    behind_for_ = behind_for_ + dt;
    if (held && now.at_torque_limit) return false;
    behind_rad_s_ += lag_rad * dt.s();
    return behind_for_ >= least_time && behind_rad_s_ >= (held ? held_rad_s : least_rad_s);
  }

  Time last_;
  std::int64_t way_ = 1;  // of its target from it, in counts
  // Left behind.
  Sample shown_;  // when it last followed, or showed a way
  bool behind_ = false;
  std::int64_t farthest_counts_ = 0;
  Duration behind_for_;
  double behind_rad_s_ = 0;
  // Unseen.
  Duration blind_for_;
  std::int64_t nearest_counts_ = 0;
  bool shows_nothing_ = false;
};

}  // namespace lf::safety
