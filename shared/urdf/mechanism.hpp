// A mechanism as a URDF file describes it: links, the joints between them, and their shapes. Hosted side only; read_urdf() makes it.
//
// Units are SI: metres, radians, kilograms, newtons. A frame is named by what it maps, as in shared/geometry/pose.hpp: `parent_from_joint` takes coordinates
// of the joint's frame to those of the parent link. A link's frame is the frame of the joint that carries it, after the joint has moved. The root's frame is the
// mechanism's. Source: the URDF specification, wiki.ros.org/urdf/XML (link, joint), version 1.0.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "shared/geometry/pose.hpp"

namespace lf::urdf {

// Centred at the shape's origin.
struct Box {
  Vec3 size_m = Vec3::Zero();
};

// Centred at the shape's origin, its axis along z.
struct Cylinder {
  double radius_m = 0;
  double length_m = 0;
};

// Centred at the shape's origin.
struct Sphere {
  double radius_m = 0;
};

// A vertex v of the file stands at metres_per_unit * (scale * v), factor by factor.
struct Mesh {
  std::filesystem::path file;  // was there when the URDF was read
  Vec3 scale = Vec3::Ones();   // a negative factor mirrors
  double metres_per_unit = 1;  // from a COLLADA file's <unit meter="...">; 1 for formats that state no unit (STL, OBJ, PLY), as URDF has it
};

using Geometry = std::variant<Box, Cylinder, Sphere, Mesh>;

// What URDF has no words for: an element of this project's own, as <lanternfish:drive rated_torque_nm="30"/>. Its place and its keys have been
// checked against a table, the values are finite numbers. Whoever uses it checks their meaning.
struct Extension {
  std::string element;  // without the prefix: "drive"
  int line = 0;
  std::vector<std::pair<std::string, double>> numbers;

  // The value of a key; nothing when the file does not give it.
  std::optional<double> number(std::string_view key) const;
};

struct Inertial {
  double mass_kg = 0;                     // above 0
  Pose link_from_com = Pose::Identity();  // its axes are those of the inertia
  Mat3 inertia_kg_m2 =
      Mat3::Identity();  // about the centre of mass; positive definite, and no principal moment exceeds the sum of the others
};

// What is seen.
struct Visual {
  std::string name;  // may be empty
  Pose link_from_shape = Pose::Identity();
  Geometry geometry;
  std::optional<std::array<float, 4>> rgba;  // 0 to 1; nothing when the file gives no colour
  int line = 0;
};

// What is touched.
struct Collision {
  std::string name;  // may be empty
  Pose link_from_shape = Pose::Identity();
  Geometry geometry;
  std::vector<Extension> extensions;
  int line = 0;
};

struct Link {
  std::string name;                  // as the file writes it, slashes and inner spaces included
  std::optional<Inertial> inertial;  // nothing: the link has no mass
  std::vector<Visual> visuals;
  std::vector<Collision> collisions;
  std::vector<Extension> extensions;
  int line = 0;
};

enum class JointType { revolute, continuous, prismatic, fixed };

// Of the joint's coordinate: rad, or m for a prismatic joint.
struct Range {
  double lower = 0;
  double upper = 0;

  bool holds(double q) const { return lower <= q && q <= upper; }
  double middle() const { return (lower + upper) / 2; }
};

// The joint's coordinate is multiplier * (coordinate of `joint`) + offset. Between a revolute and a prismatic joint the multiplier is in rad/m or m/rad.
struct Mimic {
  std::size_t joint = 0;
  double multiplier = 1;
  double offset = 0;
};

// Losses at the joint: damping in N m s/rad or N s/m, friction in N m or N. 0 where the file gives none.
struct Dynamics {
  double damping = 0;
  double friction = 0;
};

struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  std::size_t parent = 0;                     // link
  std::size_t child = 0;                      // link
  Pose parent_from_joint = Pose::Identity();  // at coordinate 0
  Vec3 axis =
      Vec3::UnitX();  // unit, in the joint's frame; the child turns about it, or slides along it. Of no use where the joint is fixed
  std::optional<Range> range;      // revolute and prismatic, lower < upper, soft limits included; the range need not hold 0
  std::optional<double> effort;    // N m or N, above 0; nothing when the file writes what stands for "not known"
  std::optional<double> velocity;  // rad/s or m/s, above 0; the same
  Dynamics dynamics;
  std::optional<Mimic> mimic;  // one step: what it names may mimic, too. Mechanism::driver() follows them
  std::vector<Extension> extensions;
  int line = 0;

  bool moves() const { return type != JointType::fixed; }
  // The child's frame in the parent's at a coordinate: rad or m; ignored where the joint is fixed.
  Pose parent_from_child(double q) const;
};

// One joint of a path. Outward: from its parent to its child.
struct Step {
  std::size_t joint = 0;
  bool outward = true;

  bool operator==(const Step&) const = default;
};

// A tree: exactly one link, the root, is no joint's child. Every link comes after its parent, depth first, and children in the order of their joints in the file.
// So links[0] is the root and joints[i] carries links[i + 1].
struct Mechanism {
  static constexpr std::size_t root = 0;

  std::string name;
  std::string file;  // where it was read, for messages; with the lines of links and joints
  std::vector<Link> links;
  std::vector<Joint> joints;

  // By name. Nothing when there is none of that name.
  std::optional<std::size_t> find_link(std::string_view name) const;
  std::optional<std::size_t> find_joint(std::string_view name) const;
  // The same, but throws InputError with the file and the names that there are.
  std::size_t link(std::string_view name) const;
  std::size_t joint(std::string_view name) const;

  // The joint that carries a link; nothing for the root.
  std::optional<std::size_t> joint_of(std::size_t link) const;
  // The joints from one link to another, in their order on the way. Empty from a link to itself. O(links).
  std::vector<Step> path(std::size_t from, std::size_t to) const;
  // Of these, the joints that move on their own: neither fixed nor mimicking.
  std::vector<std::size_t> free_joints(const std::vector<Step>& path) const;
  // What decides a joint's coordinate in the end, through any number of mimics: itself, with multiplier 1 and offset 0, where it does not mimic.
  Mimic driver(std::size_t joint) const;
};

// Turns a tool link's own axes into the tool frame of shared/geometry/pose.hpp. `approach` and `opening` name an axis of the link: "x", "-z" ...
// The result is link_from_tool: the tool's z is `approach` and the tool's x, along which the fingers move, is `opening`. Makers disagree: UR and Franka
// approach along z, ROBOTIS and Interbotix along x. Throws InputError when a word names no axis or both name the same line.
Mat3 tool_axes(std::string_view approach, std::string_view opening);

}  // namespace lf::urdf
