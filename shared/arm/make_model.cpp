#include "shared/arm/make_model.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "shared/geometry/pose.hpp"

namespace lf {

namespace {

double angle_of(const Vec3& in_plane) { return std::atan2(in_plane.y(), in_plane.x()); }

// Joint frames stand in the arm's plane, turned as their author likes: load_arm_urdf() has checked no more than that. Angles are of directions in that plane.
ArmModel::Planar planar(const ArmDescription& arm) {
  const Vec3 to_shoulder = arm.joints[1].parent_from_joint.translation(), to_elbow = arm.joints[2].parent_from_joint.translation();
  const Pose& elbow_from_roll = arm.joints[3].parent_from_joint;
  const Vec3 tool_x = elbow_from_roll.linear().col(0), tool_z = elbow_from_roll.linear().col(2), to_roll = elbow_from_roll.translation();
  ArmModel::Planar n;
  n.mount_yaw_rad = angle_of(arm.joints[0].parent_from_joint.linear().col(0));
  n.a0_m = to_shoulder.x();
  n.a1_m = to_elbow.head<2>().norm();
  const Vec3 shoulder_x = arm.joints[1].parent_from_joint.linear().col(0);
  const double turn_rad = std::atan2(shoulder_x.z(), shoulder_x.x());  // of the shoulder's own frame, in the plane that the slew turns
  n.shoulder_offset_rad = turn_rad + angle_of(to_elbow);
  n.elbow_offset_rad = angle_of(arm.joints[2].parent_from_joint.linear().col(0)) + angle_of(tool_x) - angle_of(to_elbow);
  n.a2_m = to_roll.dot(tool_x);
  n.d_m = to_roll.dot(tool_z) + arm.wrist_from_tool.translation().z();
  return n;
}

ArmModel::Jaw jaw(const ArmDescription& arm) {
  const ArmJoint& joint = arm.jaw();
  const Vec3 pivot = joint.parent_from_joint.translation(), pad = arm.pad.body_from_shape.translation();
  return {.pivot_x_m = pivot.x(),
          .pivot_z_m = pivot.z() - arm.wrist_from_tool.translation().z(),
          .face_x_m = pad.x() + arm.pad.size_m.x() / 2,
          .face_z_m = pad.z(),
          .pad_width_m = arm.pad.size_m.y(),
          .pad_depth_m = arm.pad.size_m.z(),
          .lower_rad = joint.lower_rad,
          .upper_rad = joint.upper_rad};
}

// About the shape's axis, 1.1 times as thick, so that it overhangs the ends by 0.64 of the radius only. A short and thick shape gets a sphere.
ArmModel::Capsule around(std::size_t link, const Pose& link_from_shape, const Vec3& axis, double radius_m, double length_m) {
  double thick_m = 1.1 * radius_m;
  const double half_m = std::max(0.0, length_m / 2 - std::sqrt(thick_m * thick_m - radius_m * radius_m));
  if (half_m == 0) thick_m = std::hypot(radius_m, length_m / 2);
  const Vec3 along = link_from_shape.linear() * (half_m * axis);
  return {link, link_from_shape.translation() - along, link_from_shape.translation() + along, thick_m};
}

ArmModel::Capsule around_box(std::size_t link, const scene::Shape& box) {
  Eigen::Index axis = 0;
  const double length_m = box.size_m.maxCoeff(&axis);
  const double radius_m = 0.5 * std::hypot(box.size_m[(axis + 1) % 3], box.size_m[(axis + 2) % 3]);
  return around(link, box.body_from_shape, Vec3::Unit(axis), radius_m, length_m);
}

ArmModel::Capsule capsule(std::size_t link, const scene::Shape& shape) {
  switch (shape.kind) {
    case scene::ShapeKind::box: return around_box(link, shape);
    case scene::ShapeKind::sphere:
      return {link, shape.body_from_shape.translation(), shape.body_from_shape.translation(), shape.size_m.x()};
    default: return around(link, shape.body_from_shape, Vec3::UnitZ(), shape.size_m.x(), shape.size_m.z());
  }
}

// That takes z to the axis, by the shortest way.
Mat3 turn_to(const Vec3& axis) { return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix(); }

}  // namespace

double stiffness_nm_rad(const ArmDescription& description, std::size_t joint) {
  const double told_nm_rad = description.joints[joint].stiffness_nm_rad;
  return told_nm_rad > 0 ? told_nm_rad : static_cast<double>(ArmModel::usual_stiffness_nm_rad(joint, description.arm_joints()));
}

ArmModel make_model(const ArmDescription& description) {
  ArmModel model;
  model.arm_joints = description.arm_joints();
  model.rolls = description.rolls;
  model.form = description.form;
  if (description.form == ArmModel::Form::planar) model.planar = planar(description);
  model.tool_z_m = description.wrist_from_tool.translation().z();
  // The core's joints turn about their own z. A link's frame is turned so, and what is given in it as well.
  std::vector<Mat3> link_from_turned(description.links.size(), Mat3::Identity());
  for (std::size_t i = 0; i < description.joints.size(); ++i) {
    const ArmJoint& joint = description.joints[i];
    model.joints[i] = {.lower_rad = joint.lower_rad,
                       .upper_rad = joint.upper_rad,
                       .velocity_rad_s = joint.velocity_rad_s,
                       .acceleration_rad_s2 = joint.acceleration_rad_s2,
                       .effort_nm = joint.effort_nm,
                       .rated_torque_nm = joint.rated_torque_nm,
                       .actuator = joint.actuator,
                       .stiffness_nm_rad = static_cast<float>(stiffness_nm_rad(description, i))};
    const bool of_arm = i < description.arm_joints();
    if (of_arm && !joint.axis.isApprox(Vec3::UnitZ(), 1e-12)) link_from_turned[i + 1] = turn_to(joint.axis);
    model.origins[i] = Pose(link_from_turned[i].transpose()) * joint.parent_from_joint * Pose(link_from_turned[i + 1]);
  }
  const std::size_t fingers = description.joints.size();
  model.origins[fingers] = Pose(link_from_turned[fingers - 1].transpose()) * description.finger_b.parent_from_joint;
  if (!model.rolls) model.origins[fingers + 1] = Pose(link_from_turned[fingers - 1].transpose()) * description.wrist_from_tool;
  model.jaw = jaw(description);
  for (std::size_t link = 1; link < description.links.size(); ++link) {  // no capsule resembles the base's plate
    for (scene::Shape shape : description.links[link].shapes) {
      if (!shape.collides) continue;
      shape.body_from_shape = Pose(link_from_turned[link].transpose()) * shape.body_from_shape;
      (void)model.capsules.push_back(capsule(link, shape));
    }
  }
  return model;
}

}  // namespace lf
