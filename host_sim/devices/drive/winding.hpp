// What overload does to a motor: an i^2 t guard against too much current, and the winding's temperature.
#pragma once

namespace lf::devices {

class Winding {
 public:
  // The reference arm's own drivers stop at 2 A for 1.5 s. With the rated torque at 1.33 A that is 1.5 times the rated torque,
  // an excess of (1.5^2 - 1) 1.5 s.
  static constexpr double trip_excess_s = (1.5 * 1.5 - 1) * 1.5;
  static constexpr double smoothing_s = 0.05;  // of the current: a drive's reading is filtered, and a contact of a moment does not trip
  static constexpr double thermal_time_s = 300;

  Winding(double water_celsius, double rise_at_rated_celsius);

  // `load` is the torque over the rated torque.
  void step(double load, double dt_s);

  bool overloaded() const { return excess_s_ > trip_excess_s; }
  double excess_ratio() const { return excess_s_ / trip_excess_s; }
  double celsius() const { return celsius_; }

 private:
  double water_celsius_;
  double rise_at_rated_celsius_;
  double mean_load_ = 0;
  double excess_s_ = 0;
  double celsius_;
};

}  // namespace lf::devices
