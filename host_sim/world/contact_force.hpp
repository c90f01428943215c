// The force of a contact as a sensor would give it: the impulse exchanged over a stated window t, divided by t (F = m dv / t).
//
// The force of one physics step means nothing for a rigid contact: it grows without bound as the step shrinks. The impulse does not: for bodies that
// collide with restitution e at closing speed v it is (1 + e) v / (1/m1 + 1/m2), a fixed structure having infinite mass, whatever the step.
#pragma once

#include <cstddef>
#include <vector>

#include "shared/geometry/pose.hpp"

namespace lf::world {

struct Wrench {
  Vec3 force_n = Vec3::Zero();
  Vec3 torque_nm = Vec3::Zero();
};

// Moving average of a contact's wrench over the last `window_s`.
class ForceWindow {
 public:
  // The window is rounded to whole steps, at least one. Throws InputError unless 0 < step_s <= window_s, both finite.
  ForceWindow(double window_s, double step_s);

  // Takes the impulse of one step: force_n in N s, torque_nm in N m s.
  void add(const Wrench& impulse);

  // Sum of the window's impulses over its length. Summed anew each time, so that it returns to exactly zero when the contact is over.
  Wrench mean() const;
  double window_s() const { return static_cast<double>(steps_.size()) * step_s_; }

 private:
  double step_s_;
  std::size_t next_ = 0;
  std::size_t steps_since_contact_;
  std::vector<Wrench> steps_;
};

}  // namespace lf::world
