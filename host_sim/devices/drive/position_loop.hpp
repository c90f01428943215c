// A drive's position loop: the speed that it asks of its motor.
//
// A motor that stands follows when the gear's friction breaks (gear_train.hpp). The loop has no integrator: on a joint that sticks it would hunt around its target.
// At rest the loop wakes at an error of 1.5 counts and sleeps again at the first reading within 0.75: no hunting, and a target is held within 2 counts.
#pragma once

#include <cmath>

namespace lf::devices {

class PositionLoop {
 public:
  struct Config {
    double still_rad_s = 0;  // a filtered feed-forward below it is none
    double max_velocity_rad_s = 1;
    double max_acceleration_rad_s2 = 1;
    double gain_per_s = 20;                // 50 ms: a count's quantisation makes 0.004 rad/s, 6 % of the slowest speed
    double feed_forward_filter_s = 0.016;  // four SYNCs: commands in whole counts arrive 0.7 to 2.6 counts apart
    double wake_counts = 1.5;
    double sleep_counts = 0.75;
  };

  explicit PositionLoop(const Config& config) : config_(config) {}

  void reset();
  // Goes on from a joint that moves so, whatever the loop has asked for.
  void take_up(double velocity_rad_s) { feed_forward_rad_s_ = velocity_rad_s_ = velocity_rad_s; }

  // The motor has not broken away: the speed begins at 0 when it does.
  void stand() { velocity_rad_s_ = 0; }

  // Joint velocity for the next `dt_s`. `demand` and its velocity are in counts and counts/s, `rad_per_count` is the geometry's at this place.
  // `smooth`: the drive's own ramp, whose velocity needs no filter.
  double step(double demand, double demand_velocity, double actual, double rad_per_count, double dt_s, bool smooth = false);

  double demand_velocity_rad_s() const { return feed_forward_rad_s_; }  // filtered
  double asked_rad_s() const { return asked_rad_s_; }                   // before acceleration and top speed limit it
  // By which a joint lags at most that follows: where its error alone would ask for the speed.
  double lag_counts(double counts_s) const { return std::abs(counts_s) / config_.gain_per_s + 2 * config_.wake_counts; }
  bool saturated() const { return saturated_; }  // the last step asked for more than the top speed or acceleration

 private:
  // `step`: by which the speed may change.
  double wanted(double error_rad, double error_counts, double step);

  Config config_;
  double feed_forward_rad_s_ = 0;
  double velocity_rad_s_ = 0;
  double asked_rad_s_ = 0;
  bool awake_ = false;
  bool saturated_ = false;
};

}  // namespace lf::devices
