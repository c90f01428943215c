#include "hal/config/read_arm.hpp"

#include <cmath>

#include "hal/config/share.hpp"
#include "shared/arm/make_model.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

namespace {

Pose tool_of(const ArmDescription& arm, const arm::JointVector& q) {
  Pose base_from_body = Pose::Identity();
  for (std::size_t i = 0; i < arm.arm_joints(); ++i)
    base_from_body =
        base_from_body * arm.joints[i].parent_from_joint * Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], arm.joints[i].axis);
  return base_from_body * arm.wrist_from_tool;
}

}  // namespace

arm::Arm arm_of(const ArmDescription& description, const std::string& urdf_file) {
  constexpr double same = 1e-6;  // m, and of a rotation's numbers
  arm::Arm arm(make_model(description));
  for (const double share : {0.0, 0.3, 0.5, 0.8, 1.0}) {
    arm::JointVector q = arm::JointVector::Zero();
    for (std::size_t i = 0; i < description.arm_joints(); ++i) {
      const ArmJoint& joint = description.joints[i];
      q[static_cast<Eigen::Index>(i)] = std::lerp(joint.lower_rad, joint.upper_rad, i % 2 == 0 ? share : 1 - share);
    }
    const double off = (arm.base_from_tool(q).matrix() - tool_of(description, q).matrix()).cwiseAbs().maxCoeff();
    if (!(off <= same))
      throw InputError(urdf_file + ": the core's closed forms do not fit this arm: its tool would be " + std::to_string(off) +
                       " off. Begin with the frames of the shipped arm5e.urdf");
  }
  return arm;
}

NamedArm read_arm(const std::string& urdf_file) {
  const ArmDescription description = load_arm_urdf(urdf_file);
  return {arm_of(description, urdf_file), description.names()};
}

NamedArm arm_for_checks(const std::string& told_in, const std::string& urdf) {
  try {
    return read_arm(named_file(told_in, "arm.urdf", urdf));
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace lf::config
