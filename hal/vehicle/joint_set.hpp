// Some of a machine's joints, the jaw's among them.
#pragma once

#include "shared/messages/joint_io.hpp"

namespace lf::hal {

using JointSet = PerJoint<bool>;

// Every joint that an arm may have.
inline JointSet all_joints() {
  JointSet all;
  all.fill(true);
  return all;
}

}  // namespace lf::hal
