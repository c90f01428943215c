// A joint stays behind its target, shows no way towards it, and nothing holds it: then it is not where its encoder says.
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
  // A joint is behind once it is off its target by both, until it is back within half of either. A healthy drive holds its joint within two counts. In between,
  // time and lag stand still.
  static constexpr std::int64_t behind_counts = 3;
  static constexpr double behind_rad = 0.001;
  // An encoder that works shows a way: towards the target by both, beyond what was shown before, or away from there. A reading that wavers shows none and ends nothing:
  // while the joint is behind, the mean of the last ones is taken.
  static constexpr double alive_counts = 2;
  static constexpr double alive_rad = 0.00025;  // two counts of a slew
  static constexpr double away_rad = 0.001;     // no less than what counts as behind
  static constexpr double mean_s = 0.05, look_s = 0.02;
  // It is told after both: 0.5 s at 3 mrad, 0.3 s from 5 mrad on. A joint that stood and is not held has gone the sum times its loop's gain meanwhile: 0.03 rad at
  // the simulator's 20 a second; one whose encoder stops in motion has gone farther, by 0.3 s of that motion's growing lag. One that turns back has to unwind its
  // gear first: 0.2 s and 0.00066 rad s were seen.
  static constexpr Duration least_time = Duration::from_ms(300);
  static constexpr double least_rad_s = 0.0015;
  // Nothing holds a joint for longer short of the end of its torque: its drive winds it up. 1 s at 3 mrad, 0.06 rad at 20 a second.
  static constexpr double held_rad_s = 0.003;
  // No longer than this in all, whatever its torque, unless it comes so much nearer to its target: near a stroke's end a weak motor reaches no contact's threshold,
  // and pushes for good. What pins it softly lets it creep or sway by less.
  static constexpr Duration longest_excuse = Duration::from_s(1);
  static constexpr double excused_rad = 0.003;
  static constexpr double usual_s = 1;  // time constant of a following joint's torque: slower than one that meets something winds up
  // So long and so far behind without a sign: no torque proves a contact then. One count of a coarse encoder is so far, too.
  static constexpr Duration blind_time = Duration::from_ms(100);
  static constexpr double blind_rad = 0.003;
  static constexpr Duration longest_gap = Duration::from_ms(20);  // between samples: what lies beyond is not counted

  struct Sample {
    Time t;
    std::int32_t actual_counts = 0, target_counts = 0;
    double rad_per_count = 0;
    double torque_nm = 0;         // that the drive gives the joint
    double load_nm = 4;           // a joint that pushes by so much more than usual towards its target may be held by something
    bool follows = false;         // it has power and is told where to go
    bool holds_much = false;      // what holds a joint that pushes so much holds it: nothing is summed then, and nothing told for a second
    bool motor_at_limit = false;  // the same, of a motor that gives all that it may
  };

  // True while it is stuck.
  bool update(const Sample& now) {
    const Duration dt = std::min(now.t - last_, longest_gap);
    last_ = now.t;
    mean_counts_ += (now.actual_counts - mean_counts_) * (behind_ ? dt.s() / (dt.s() + mean_s) : 1);
    const double lag = now.target_counts - mean_counts_, lag_rad = std::abs(lag * now.rad_per_count);
    const double way = lag < 0 ? -1 : 1;
    const bool turned = way != way_;
    way_ = way;
    look(now, dt);
    if (!now.follows) usual_nm_ = now.torque_nm;
    const bool with_it = std::abs(lag) <= 0.5 * behind_counts || lag_rad <= behind_rad / 2;
    if (with_it || !now.follows || turned) behind_ = false;
    if (!behind_ || way_ * (mean_counts_ - excused_from_counts_) * std::abs(now.rad_per_count) >= excused_rad) {
      excused_from_counts_ = mean_counts_;
      excused_for_ = Duration();
    }
    if (!behind_ || lives(now, way_ * (mean_counts_ - farthest_counts_))) begin_anew(now, dt);
    const bool off = std::abs(lag) >= behind_counts && lag_rad >= behind_rad;
    behind_ = behind_ || off;
    return off && is_stuck(now, lag_rad, dt);
  }

  // Its torque may be that of a joint which runs off unseen. An arm that meets something goes on showing counts until it is stopped.
  bool shows_nothing() const { return shows_nothing_; }

 private:
  void begin_anew(const Sample& now, Duration dt) {
    const double s = (behind_for_ + dt).s();
    usual_nm_ += (now.torque_nm - usual_nm_) * s / (s + usual_s);
    farthest_counts_ = mean_counts_;
    behind_for_ = Duration();
    behind_rad_s_ = 0;
  }

  // `gone_counts`: towards the target.
  bool lives(const Sample& now, double gone_counts) const {
    const double gone_rad = gone_counts * std::abs(now.rad_per_count);
    return (gone_counts >= alive_counts && gone_rad >= alive_rad) || gone_rad <= -away_rad;
  }

  // A reading that never was so near to the target is a sign of life at once, however it wavers: its mean goes on for a tenth of a second after the reading has
  // stopped. That it goes away is told by the mean.
  void look(const Sample& now, Duration dt) {
    look_counts_ += (now.actual_counts - look_counts_) * (now.follows ? dt.s() / (dt.s() + look_s) : 1);
    const double lag = now.target_counts - look_counts_, lag_rad = std::abs(lag * now.rad_per_count);
    const double way = lag < 0 ? -1 : 1, count_rad = std::abs(now.rad_per_count);
    const double nearer_counts = way * (now.actual_counts - nearest_counts_);
    const bool away = way * (look_counts_ - look_from_counts_) * count_rad <= -away_rad;
    const bool anew = way != look_way_ || !now.follows || lag_rad < blind_rad / 2 || away;
    if (anew || nearer_counts * count_rad >= alive_rad / 2) {
      blind_for_ = Duration();
      nearest_counts_ = now.actual_counts;
    } else {
      blind_for_ = blind_for_ + dt;
    }
    if (anew || way * (look_counts_ - look_from_counts_) > 0) look_from_counts_ = look_counts_;
    look_way_ = way;
    shows_nothing_ = lag_rad >= blind_rad && blind_for_ >= blind_time;
  }

  bool is_stuck(const Sample& now, double lag_rad, Duration dt) {
    const double toward_nm = way_ * (now.rad_per_count < 0 ? -1 : 1) * now.torque_nm;
    const double usual_nm = way_ * (now.rad_per_count < 0 ? -1 : 1) * usual_nm_;
    const bool held = toward_nm > 0 && toward_nm - usual_nm >= now.load_nm;
    behind_for_ = behind_for_ + dt;
    if ((held && now.holds_much) || (now.motor_at_limit && toward_nm > 0)) {
      excused_for_ = excused_for_ + dt;
      return excused_for_ >= longest_excuse;
    }
    behind_rad_s_ += lag_rad * dt.s();
    return behind_for_ >= least_time && behind_rad_s_ >= (held ? held_rad_s : least_rad_s);
  }

  Time last_;
  double way_ = 1;  // of its target from it, in counts
  // Left behind.
  bool behind_ = false;
  double usual_nm_ = 0;
  double mean_counts_ = 0, farthest_counts_ = 0;
  Duration behind_for_;
  double behind_rad_s_ = 0;
  Duration excused_for_;
  double excused_from_counts_ = 0;
  // Unseen.
  Duration blind_for_;
  double look_way_ = 1;
  double look_counts_ = 0, look_from_counts_ = 0;  // their mean, and the nearest to the target that it was
  std::int32_t nearest_counts_ = 0;                // of the readings
  bool shows_nothing_ = false;
};

}  // namespace lf::safety
