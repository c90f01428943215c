// How much a build of the core holds. What exceeds it is refused by whoever reads it.
#pragma once

#include <cstddef>

// Of a panel its valves, buttons and markers; of the vehicle's shape the boxes, and as many rods; of the arm the joints that place its tool, and the
// collision shapes.
namespace lf::capacity {

#ifdef LANTERNFISH_SMALL_CORE
// A controller in the 64 KiB of a Cortex-M7's tightly coupled memory.
inline constexpr std::size_t valves = 2, buttons = 4, markers = 2, vehicle_shapes = 8, arm_shapes = 16, arm_joints = 4;
#else
inline constexpr std::size_t valves = 16, buttons = 16, markers = 16, vehicle_shapes = 16, arm_shapes = 96, arm_joints = 8;
#endif
inline constexpr std::size_t joints = arm_joints + 1;  // with the jaw
inline constexpr std::size_t nodes = joints + 1;       // with the output node

}  // namespace lf::capacity
