#include "host_sim/world/contact_force.hpp"

#include <cmath>

#include "shared/input_error.hpp"

namespace lf::world {

ForceWindow::ForceWindow(double window_s, double step_s) : step_s_(step_s) {
  if (!(step_s > 0) || !(window_s >= step_s) || !std::isfinite(window_s)) {
    throw InputError("contact force window: needs 0 < step <= window, both finite");
  }
  steps_.resize(static_cast<std::size_t>(std::lround(window_s / step_s)));
  steps_since_contact_ = steps_.size();
}

void ForceWindow::add(const Wrench& impulse) {
  steps_[next_] = impulse;
  next_ = (next_ + 1) % steps_.size();
  const bool contact = !impulse.force_n.isZero(0) || !impulse.torque_nm.isZero(0);
  if (contact) {
    steps_since_contact_ = 0;
  } else if (steps_since_contact_ < steps_.size()) {
    ++steps_since_contact_;
  }
}

Wrench ForceWindow::mean() const {
  Wrench sum;
  if (steps_since_contact_ == steps_.size()) return sum;
  for (const Wrench& step : steps_) {
    sum.force_n += step.force_n;
    sum.torque_nm += step.torque_nm;
  }
  sum.force_n /= window_s();
  sum.torque_nm /= window_s();
  return sum;
}

}  // namespace lf::world
