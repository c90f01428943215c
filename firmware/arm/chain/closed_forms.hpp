// All postures that put the tool where a task wants it, by closed forms: no iteration and no starting guess.
//
// With E_i the turn about axis i as it lies at joint values 0, G = target * home^-1 = E_1 E_2 ... E_n. What the parallel axes 2, 3 (and 4) leave
// unchanged, the height along their direction h, gives the first joint. The last joints follow from a direction or a point that they leave
// unchanged, and what remains is a triangle in the plane square to h. Limits play no part here, nor whole turns.
#pragma once

#include "firmware/arm/chain/axis_geometry.hpp"
#include "firmware/arm/chain/ik_task.hpp"

namespace lf::chain {

struct Postures {
  // Two for the first joint, two for the triangle, two for the wrist.
  static constexpr std::size_t capacity = 8;
  std::array<JointValues, capacity> q;
  std::size_t count = 0;
  // A joint's angle did not matter, and the seed's was taken: there are infinitely many more.
  bool more = false;

  void push(const JointValues& one) {
    if (count < capacity) q[count++] = one;
  }
};

// False where the family has no form for such a task. `seed` gives the angles that do not matter.
bool has_closed_form(const AxisGeometry& geometry, std::size_t joints, const IkTask& task);
void closed_forms(const AxisGeometry& geometry, std::size_t joints, const IkTask& task, const JointValues& seed, Postures& out);

}  // namespace lf::chain
