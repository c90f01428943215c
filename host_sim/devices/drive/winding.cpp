#include "host_sim/devices/drive/winding.hpp"

#include <algorithm>

namespace lf::devices {

Winding::Winding(double water_celsius, double rise_at_rated_celsius)
    : water_celsius_(water_celsius), rise_at_rated_celsius_(rise_at_rated_celsius), celsius_(water_celsius) {}

void Winding::step(double load, double dt_s) {
  mean_load_ += (load - mean_load_) * std::min(1.0, dt_s / smoothing_s);
  const double heat = mean_load_ * mean_load_;
  excess_s_ = std::clamp(excess_s_ + (heat - 1) * dt_s, 0.0, 2 * trip_excess_s);
  celsius_ += (heat * rise_at_rated_celsius_ - (celsius_ - water_celsius_)) * dt_s / thermal_time_s;
}

}  // namespace lf::devices
