// Homing: where the drive's position is said to be 607C.
//
//   method 35, 37   the present position is home
//   method -1, -2   manufacturer's: runs in the negative (-1) or positive (-2) direction of counts at 6099:01 until the joint stands at a hard stop:
//                   torque of at least object 2080 (thousandths of 6076) and no count for 50 ms. That place is home
// A run that goes further than 1.2 times the whole stroke without a stop has failed.
#pragma once

#include <cstdint>

namespace lf::devices {

constexpr bool known_homing_method(std::int64_t method) { return method == 35 || method == 37 || method == -1 || method == -2; }

class Homing {
 public:
  enum class State : std::uint8_t { idle, running, attained, failed };

  // `stroke_counts` bounds the run. Methods 35 and 37 attain at once.
  void start(std::int64_t method, double speed_counts_s, double stroke_counts, double actual);
  // Call once a step while running.
  void step(double actual, double torque_ratio, double threshold_ratio, double dt_s);
  void abandon() { state_ = State::idle; }

  State state() const { return state_; }
  double velocity_counts_s() const { return state_ == State::running ? velocity_ : 0; }

 private:
  State state_ = State::idle;
  double velocity_ = 0;
  double stroke_ = 0;
  double begin_ = 0;
  double last_ = 0;
  double standing_s_ = 0;
};

}  // namespace lf::devices
