// What a mechanism that has been read promises: what of shared/urdf/mechanism.hpp can be checked without the file. For tests and the fuzz target.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "shared/urdf/mechanism.hpp"

namespace lf::urdf::test {

inline bool is_pose(const Pose& pose) {
  const Mat3 turned = pose.linear();
  return pose.matrix().allFinite() && (turned * turned.transpose() - Mat3::Identity()).norm() < 1e-9 && turned.determinant() > 0.5;
}

inline std::string fault_of(const Geometry& geometry) {
  if (const auto* box = std::get_if<Box>(&geometry)) return box->size_m.allFinite() && box->size_m.minCoeff() > 0 ? "" : "a box has a size";
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    return sphere->radius_m > 0 && std::isfinite(sphere->radius_m) ? "" : "a sphere has a size";
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    return cylinder->radius_m > 0 && cylinder->length_m > 0 && std::isfinite(cylinder->radius_m + cylinder->length_m)
               ? ""
               : "a cylinder has a size";
  const Mesh& mesh = std::get<Mesh>(geometry);
  if (mesh.file.empty() || !std::filesystem::is_regular_file(mesh.file)) return "a mesh has a file";
  return mesh.scale.allFinite() && mesh.scale.cwiseAbs().minCoeff() > 0 && mesh.metres_per_unit > 0 ? "" : "a mesh has a size";
}

inline std::string fault_of(const std::vector<Extension>& extensions) {
  std::set<std::string> elements;
  for (const Extension& extension : extensions) {
    if (extension.element.empty() || extension.line <= 0) return "an extension has a name and a line";
    if (!elements.insert(extension.element).second) return "an extension comes once";
    std::set<std::string> keys;
    if (extension.numbers.empty()) return "an extension holds numbers";
    for (const auto& [key, value] : extension.numbers)
      if (key.empty() || !keys.insert(key).second || !std::isfinite(value))
        return "an extension's numbers are finite, each under a key of its own";
  }
  return "";
}

inline std::string fault_of(const Link& link) {
  if (link.name.empty() || link.line <= 0) return "a link has a name and a line";
  for (const Visual& visual : link.visuals) {
    if (!is_pose(visual.link_from_shape) || visual.line <= 0) return "a visual has a place and a line";
    if (const std::string fault = fault_of(visual.geometry); !fault.empty()) return fault;
    if (!visual.rgba) continue;
    for (const float part : *visual.rgba)
      if (!(part >= 0 && part <= 1)) return "a colour is from 0 to 1";
  }
  for (const Collision& collision : link.collisions) {
    if (!is_pose(collision.link_from_shape) || collision.line <= 0) return "a collision has a place and a line";
    if (const std::string fault = fault_of(collision.extensions); !fault.empty()) return fault;
    if (const std::string fault = fault_of(collision.geometry); !fault.empty()) return fault;
  }
  if (const std::string fault = fault_of(link.extensions); !fault.empty()) return fault;
  if (!link.inertial) return "";
  if (!(link.inertial->mass_kg > 0) || !is_pose(link.inertial->link_from_com)) return "a mass is above 0, and somewhere";
  const Mat3& inertia = link.inertial->inertia_kg_m2;
  if (!inertia.allFinite() || inertia != inertia.transpose()) return "an inertia is symmetric";
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvalues();
  return principal[0] > 0 && principal[0] + principal[1] >= principal[2] * 0.999 ? "" : "an inertia is of a body";
}

inline std::string fault_of(const Joint& joint) {
  if (joint.name.empty() || joint.line <= 0) return "a joint has a name and a line";
  if (!is_pose(joint.parent_from_joint)) return "a joint has a place";
  if (std::abs(joint.axis.norm() - 1) > 1e-12) return "an axis is a unit vector";
  const bool ranged = joint.type == JointType::revolute || joint.type == JointType::prismatic;
  if (joint.range.has_value() != ranged) return "revolute and prismatic joints have a range, others none";
  if (ranged && !(joint.range->lower < joint.range->upper && std::isfinite(joint.range->upper - joint.range->lower)))
    return "a range has a width";
  for (const auto& rating : {joint.effort, joint.velocity})
    if (rating && !(*rating > 0 && std::isfinite(*rating))) return "a rating is above 0";
  if (!(joint.dynamics.damping >= 0 && joint.dynamics.friction >= 0)) return "losses are not negative";
  if (joint.mimic && !joint.moves()) return "what mimics moves";
  return fault_of(joint.extensions);
}

// Depth first, and children in the order of their joints in the file, which their lines tell: two joints may stand in one line.
inline std::string fault_of_order(const std::vector<Joint>& joints) {
  std::vector<std::size_t> way{Mechanism::root};     // from the root to the link before
  std::vector<int> last_line(joints.size() + 1, 0);  // of the joints that a link carries so far
  for (const Joint& joint : joints) {
    while (!way.empty() && way.back() != joint.parent) way.pop_back();
    if (way.empty()) return "links come depth first";
    if (joint.line < last_line[joint.parent]) return "children come in the order of their joints in the file";
    last_line[joint.parent] = joint.line;
    way.push_back(joint.child);
  }
  return "";
}

// "" when the mechanism is as its header says.
inline std::string fault_of(const Mechanism& mechanism) {
  if (mechanism.links.empty() || mechanism.joints.size() + 1 != mechanism.links.size()) return "a tree has a joint less than links";
  std::set<std::string> links, joints;
  for (const Link& link : mechanism.links) {
    if (const std::string fault = fault_of(link); !fault.empty()) return fault;
    if (!links.insert(link.name).second) return "a link's name is its own";
  }
  for (std::size_t i = 0; i < mechanism.joints.size(); ++i) {
    const Joint& joint = mechanism.joints[i];
    if (const std::string fault = fault_of(joint); !fault.empty()) return fault;
    if (!joints.insert(joint.name).second) return "a joint's name is its own";
    if (joint.child != i + 1 || joint.parent > i) return "a joint carries the link after it, and its parent comes before";
    for (std::size_t at = i, steps = 0; mechanism.joints[at].mimic; ++steps) {
      at = mechanism.joints[at].mimic->joint;
      if (at >= mechanism.joints.size() || !mechanism.joints[at].moves()) return "what is mimicked moves";
      if (steps > mechanism.joints.size()) return "mimics end";
    }
    const Mimic driver = mechanism.driver(i);
    if (mechanism.joints[driver.joint].mimic) return "a driver is free";
  }
  if (const std::string fault = fault_of_order(mechanism.joints); !fault.empty()) return fault;
  const std::size_t last = mechanism.links.size() - 1;
  std::size_t at = last;
  for (const Step& step : mechanism.path(last, Mechanism::root)) {
    if (step.outward || step.joint + 1 != at) return "the way to the root goes from parent to parent";
    at = mechanism.joints[step.joint].parent;
  }
  return at == Mechanism::root ? "" : "every way ends at the root";
}

}  // namespace lf::urdf::test
