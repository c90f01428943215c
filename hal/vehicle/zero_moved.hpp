// By how much a joint's zero has moved, as an angle.
#pragma once

#include "shared/arm/arm_model.hpp"

namespace lf::hal {

// A zero that moves by more is told. Two commissionings agree within 0.003 rad; a drive's encoder that was exchanged, or an obstacle that was taken for the
// stop, is farther off.
inline constexpr double told_move_rad = 0.03;

// What a joint at `place_rad` is off by when its zero is `moved_counts` off. At a stop one of the two ways leads out of the stroke: the other one tells.
double zero_moved_rad(const ArmModel::Joint& joint, double place_rad, double moved_counts);

}  // namespace lf::hal
