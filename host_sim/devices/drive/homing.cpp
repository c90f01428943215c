#include "host_sim/devices/drive/homing.hpp"

#include <cmath>

namespace lf::devices {
namespace {

constexpr double standing_time_s = 0.05;
constexpr double stroke_reserve = 1.2;

}  // namespace

void Homing::start(std::int64_t method, double speed_counts_s, double stroke_counts, double actual) {
  velocity_ = method == -1 ? -speed_counts_s : speed_counts_s;
  stroke_ = stroke_counts;
  begin_ = last_ = actual;
  standing_s_ = 0;
  state_ = method > 0 ? State::attained : State::running;
}

void Homing::step(double actual, double torque_ratio, double threshold_ratio, double dt_s) {
  const bool pressing = torque_ratio * (velocity_ < 0 ? -1 : 1) >= threshold_ratio;
  standing_s_ = pressing && std::abs(actual - last_) < 1 ? standing_s_ + dt_s : 0;
  if (standing_s_ == 0) last_ = actual;
  if (standing_s_ >= standing_time_s) {
    state_ = State::attained;
  } else if (std::abs(actual - begin_) > stroke_reserve * stroke_) {
    state_ = State::failed;
  }
}

}  // namespace lf::devices
