// The joints of the default machine, which most tests fly, by their names.
#pragma once

#include <cstddef>

namespace lf::arm5e_joint {

inline constexpr std::size_t slew = 0, shoulder = 1, elbow = 2, roll = 3, jaw = 4;
inline constexpr std::size_t count = 5;   // with the jaw
inline constexpr std::size_t of_arm = 4;  // those that place the tool
inline constexpr std::size_t links = 7;   // with the base

// One of each, all the same.
template <class Vector, class Value>
void fill(Vector& of_joints, const Value& value) {
  of_joints.clear();
  while (of_joints.size() < count) (void)of_joints.push_back(value);
}

}  // namespace lf::arm5e_joint
