#include "hal/config/arm_match.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "firmware/arm/kinematics.hpp"
#include "shared/arm/arm_geometry.hpp"
#include "shared/messages/joint_names.hpp"

namespace lf::config {

namespace {

// Constants are written with all their digits: what is more than rounding is another arm.
constexpr double same_m = 1e-5;
constexpr double same_rad = 1e-5;

Pose tool_of(const ArmDescription& arm, const arm::JointVector& q) {
  Pose base_from_body = Pose::Identity();
  for (std::size_t i = 0; i < arm_joint_count; ++i)
    base_from_body =
        base_from_body * arm.joints[i].parent_from_joint * Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], arm.joints[i].axis);
  return base_from_body * arm.wrist_from_tool;
}

// Angles over every joint's range: both ends, the middle, and two that share no fraction with another joint's.
arm::JointVector angles(int pick) {
  arm::JointVector q;
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    const auto& numbers = arm_geometry::joints[i];
    const double share = std::fmod(0.25 * pick * static_cast<double>(i + 1) + 0.1 * pick, 1.0);
    q[static_cast<Eigen::Index>(i)] = numbers.lower_rad + share * (numbers.upper_rad - numbers.lower_rad);
  }
  return q;
}

bool same(double a, double b) { return std::abs(a - b) <= 1e-6 * std::max(1.0, std::abs(b)); }

bool same_actuator(const ArmActuator& a, const arm_geometry::JointNumbers& core) {
  return same(a.pivot_a_m, core.pivot_a_m) && same(a.pivot_b_m, core.pivot_b_m) && same(a.offset_rad, core.offset_rad) &&
         same(a.counts_per_m, core.counts_per_m) && same(a.counts_per_rad, core.counts_per_rad);
}

bool same_motor(const ArmJoint& a, const arm_geometry::JointNumbers& core) {
  return same(a.effort_nm, core.effort_nm) && same(a.rated_torque_nm, core.rated_torque_nm) &&
         same(a.velocity_rad_s, core.velocity_rad_s) && same(a.acceleration_rad_s2, core.acceleration_rad_s2);
}

// The pad that holds the bar.
bool has_pad(const ArmLink& finger) {
  return std::any_of(finger.shapes.begin(), finger.shapes.end(), [](const scene::Shape& shape) {
    const Vec3& at = shape.body_from_shape.translation();
    return shape.collides && shape.kind == scene::ShapeKind::box &&
           std::abs(at.x() + shape.size_m.x() / 2 - arm_geometry::jaw.face_x_m) <= same_m &&
           std::abs(at.z() - arm_geometry::jaw.face_z_m) <= same_m &&
           std::abs(shape.size_m.y() - arm_geometry::jaw.pad_width_m) <= same_m &&
           std::abs(shape.size_m.z() - arm_geometry::jaw.pad_depth_m) <= same_m;
  });
}

double distance_to_capsule(const Vec3& point, const arm_geometry::CapsuleNumbers& capsule) {
  const Vec3 a(capsule.a_m[0], capsule.a_m[1], capsule.a_m[2]), b(capsule.b_m[0], capsule.b_m[1], capsule.b_m[2]);
  const double length2 = (b - a).squaredNorm();
  const double along = length2 > 0 ? std::clamp((point - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
  return (a + along * (b - a) - point).norm() - capsule.radius_m;
}

// A hull's corners: of a cylinder eight on each rim, of a mesh its vertices, of everything else its box's.
std::vector<Vec3> corners(const scene::Shape& shape) {
  if (shape.kind == scene::ShapeKind::mesh) return shape.vertices_m;
  const double radius_m = shape.size_m.x();
  Vec3 half_m(radius_m, radius_m, radius_m);  // of a sphere
  if (shape.kind == scene::ShapeKind::box) half_m = shape.size_m / 2;
  if (shape.kind == scene::ShapeKind::capsule) half_m.z() += shape.size_m.z() / 2;
  std::vector<Vec3> points;
  constexpr int around = 8;
  for (int i = 0; i < around; ++i) {
    const double turn = 2 * pi * i / around;
    for (const double end : {-1.0, 1.0}) {
      if (shape.kind == scene::ShapeKind::cylinder)
        points.emplace_back(radius_m * std::cos(turn), radius_m * std::sin(turn), end * shape.size_m.z() / 2);
      else
        points.push_back(half_m.cwiseProduct(Vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, end)));
    }
  }
  return points;
}

// By how much the link's shapes stand out of the core's capsules. Each has to lie within one of them: then so does all between its corners.
double stands_out_m(const ArmLink& link, std::size_t body) {
  double most_m = 0;
  for (const scene::Shape& shape : link.shapes) {
    if (!shape.collides) continue;
    const std::vector<Vec3> points = corners(shape);
    double least_m = std::numeric_limits<double>::infinity();
    for (const arm_geometry::CapsuleNumbers& capsule : arm_geometry::capsules) {
      if (capsule.link != body) continue;
      double farthest_m = 0;
      for (const Vec3& point : points) farthest_m = std::max(farthest_m, distance_to_capsule(shape.body_from_shape * point, capsule));
      least_m = std::min(least_m, farthest_m);
    }
    most_m = std::max(most_m, least_m);
  }
  return most_m;
}

// Where a finger's joint is on the wrist.
bool same_origin(const Pose& pose, const arm_geometry::Transform& core) {
  double off = 0;
  for (Eigen::Index row = 0; row < 3; ++row) {
    const auto r = static_cast<std::size_t>(row);
    off = std::max(off, std::abs(pose.translation()[row] - core.translation_m[r]));
    for (Eigen::Index column = 0; column < 3; ++column)
      off = std::max(off, std::abs(pose.linear()(row, column) - core.rotation[3 * r + static_cast<std::size_t>(column)]));
  }
  return off <= same_m;
}

std::string joined(const std::string& text, const std::string& more) { return text.empty() ? more : text + ", and " + more; }

}  // namespace

std::string difference_from_core(const ArmDescription& arm) {
  double off_m = 0, turned_rad = 0;
  constexpr int picks = 8;
  for (int pick = 0; pick < picks; ++pick) {
    const arm::JointVector q = angles(pick);
    const Pose core_from_arm = arm::base_from_tool(q).inverse() * tool_of(arm, q);
    off_m = std::max(off_m, core_from_arm.translation().norm());
    turned_rad = std::max(turned_rad, Eigen::AngleAxisd(core_from_arm.linear()).angle());
  }
  std::string text;
  if (off_m > same_m || turned_rad > same_rad) {
    std::array<char, 96> words;
    (void)std::snprintf(words.data(), words.size(), "its tool is up to %.2f mm and %.3f degrees off", 1e3 * off_m,
                        deg_from_rad(turned_rad));
    text = words.data();
  }
  std::string limits;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const auto& numbers = arm_geometry::joints[i];
    const bool same = std::abs(arm.joints[i].lower_rad - numbers.lower_rad) <= same_rad &&
                      std::abs(arm.joints[i].upper_rad - numbers.upper_rad) <= same_rad;
    if (!same) limits += (limits.empty() ? "" : ", ") + std::string(joint_names[i]);
  }
  if (!limits.empty()) text = joined(text, "the limits of " + limits + " differ");
  std::string actuators;
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (!same_actuator(arm.joints[i].actuator, arm_geometry::joints[i]))
      actuators += (actuators.empty() ? "" : ", ") + std::string(joint_names[i]);
  }
  if (!actuators.empty()) text = joined(text, "the screw or gear of " + actuators + " differs");
  std::string motors;
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (!same_motor(arm.joints[i], arm_geometry::joints[i])) motors += (motors.empty() ? "" : ", ") + std::string(joint_names[i]);
  }
  if (!motors.empty()) text = joined(text, "torque, speed or acceleration of " + motors + " differs");
  constexpr auto jaw = static_cast<std::size_t>(Joint::jaw);
  if (!same_origin(arm.joints[jaw].parent_from_joint, arm_geometry::joint_origins[jaw]) ||
      !same_origin(arm.finger_b.parent_from_joint, arm_geometry::joint_origins[jaw + 1]))
    text = joined(text, "its fingers are elsewhere on the wrist");
  constexpr auto finger_a = static_cast<std::size_t>(scene::BodyId::finger_a);
  if (!has_pad(arm.links[finger_a])) text = joined(text, "its fingers' pads are others");
  for (std::size_t body = 1; body < ArmDescription::link_count; ++body) {
    const double out_m = stands_out_m(arm.links[body], body);
    if (out_m <= same_m) continue;
    std::array<char, 96> words;
    (void)std::snprintf(words.data(), words.size(), "its %s stands %.1f mm out of what is kept clear for it", arm.links[body].name.c_str(),
                        1e3 * out_m);
    text = joined(text, words.data());
  }
  return text;
}

}  // namespace lf::config
