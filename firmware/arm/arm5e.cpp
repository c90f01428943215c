#include "firmware/arm/kinematics.hpp"
#include "shared/arm/arm_geometry.hpp"

namespace lf::arm {
namespace {

Vec3 vec3(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

Pose pose_of(const arm_geometry::Transform& transform) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(transform.rotation.data());
  pose.translation() = vec3(transform.translation_m);
  return pose;
}

ArmModel::Planar planar() {
  const auto& dh = arm_geometry::dh;
  return {.mount_yaw_rad = arm_geometry::mount_yaw_rad,
          .a0_m = dh[0].a_m,
          .a1_m = dh[1].a_m,
          .a2_m = dh[2].a_m,
          .d_m = dh[3].d_m,
          .shoulder_offset_rad = dh[1].theta_offset_rad,
          .elbow_offset_rad = dh[2].theta_offset_rad};
}

ArmModel::Joint joint(const arm_geometry::JointNumbers& n, float stiffness_nm_rad) {
  return {.lower_rad = n.lower_rad,
          .upper_rad = n.upper_rad,
          .velocity_rad_s = n.velocity_rad_s,
          .acceleration_rad_s2 = n.acceleration_rad_s2,
          .effort_nm = n.effort_nm,
          .rated_torque_nm = n.rated_torque_nm,
          .actuator = {n.pivot_a_m, n.pivot_b_m, n.offset_rad, n.counts_per_m, n.counts_per_rad},
          .stiffness_nm_rad = stiffness_nm_rad};
}

ArmModel::Jaw jaw() {
  const arm_geometry::JawNumbers& n = arm_geometry::jaw;
  const arm_geometry::JointNumbers& joint = arm_geometry::joints.back();
  return {.pivot_x_m = n.pivot_x_m,
          .pivot_z_m = n.pivot_z_m,
          .face_x_m = n.face_x_m,
          .face_z_m = n.face_z_m,
          .pad_width_m = n.pad_width_m,
          .pad_depth_m = n.pad_depth_m,
          .lower_rad = joint.lower_rad,
          .upper_rad = joint.upper_rad};
}

}  // namespace

ArmModel arm5e_model() {
  static_assert(arm_geometry::capsules.size() <= capacity::arm_shapes);
  ArmModel model;
  model.planar = planar();
  for (std::size_t i = 0; i < model.joint_count(); ++i)
    model.joints[i] = joint(arm_geometry::joints[i], ArmModel::usual_stiffness_nm_rad(i, model.arm_joints));
  for (std::size_t i = 0; i < arm_geometry::joint_origins.size(); ++i) model.origins[i] = pose_of(arm_geometry::joint_origins[i]);
  model.jaw = jaw();
  for (const arm_geometry::CapsuleNumbers& n : arm_geometry::capsules)
    (void)model.capsules.push_back(ArmModel::Capsule(n.link, vec3(n.a_m), vec3(n.b_m), n.radius_m));
  return model;
}

}  // namespace lf::arm
