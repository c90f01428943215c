// The bodies of the simulated scene, described once: physics collides them, optics draws them. Hosted side only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/geometry/pose.hpp"
#include "shared/messages/capacity.hpp"
#include "shared/panel/panel_layout.hpp"
#include "shared/panel/panel_names.hpp"

namespace lf::scene {

enum class ShapeKind : std::uint8_t { box, cylinder, capsule, sphere, mesh };

// `size_m`: box: full extents; cylinder and capsule: radius in x, height along the shape's z in z (capsule: without its caps); sphere: radius in x.
struct Shape {
  ShapeKind kind = ShapeKind::box;
  Vec3 size_m = Vec3::Zero();
  Pose body_from_shape = Pose::Identity();
  std::array<float, 3> albedo{0.5f, 0.5f, 0.5f};  // diffuse reflectance at red, green, blue
  double friction = 0.6;
  bool collides = true;
  bool visible = true;
  std::int32_t marker_id = -1;   // a 36h11 tag drawn on the +z face (box only), x right and y up; -1 none
                                 // upright as AprilTag's own images have it: OpenCV's dictionaries draw it turned by half a turn
  double marker_size_m = 0;      // side of its black square
  std::vector<Vec3> vertices_m;  // mesh only
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// What a body is to the rest: who may touch it, whether it moves, what a camera keeps of it from frame to frame.
enum class Role : std::uint8_t {
  vehicle,   // what is bolted to the arm's base
  link,      // of the arm, before its hand
  hand,      // carries the fingers
  finger,    // may touch other fingers, handles and buttons
  panel,     // stands still while the vehicle is docked
  handle,    // turns when fingers turn it
  button,    // slides when fingers press it
  intruder,  // comes from outside and pushes
  object,    // anything else that stands about: nothing of the robot may touch it
};

struct Body {
  std::string name;
  std::vector<Shape> shapes;
  Role role = Role::object;
  Pose base_from_body = Pose::Identity();  // of an object; where the others are the world says
};

// Which body of a Scene: its place there.
using BodyId = std::size_t;

// The bodies that each Scene begins with: what is bolted to the arm's base (skid, camera and lamp housings), the arm's links, base to tip, finger_a and finger_b,
// the panel, and an obstacle, which a fault of the scenario pushes against the arm: met in contacts, not seen. The panel's handles follow, then its buttons, then objects.
struct OwnBodies {
  explicit constexpr OwnBodies(std::size_t arm_joints) : hand(arm_joints) {}

  static constexpr BodyId vehicle = 0;
  BodyId hand;                                                 // the last link, which carries the fingers
  constexpr BodyId before_hand() const { return hand - 1; }    // which carries the laser of an arm that rolls
  constexpr BodyId finger_a() const { return hand + 1; }       // and finger_b
  constexpr BodyId finger_b() const { return hand + 2; }       //
  constexpr BodyId panel() const { return hand + 3; }          //
  constexpr BodyId obstacle() const { return hand + 4; }       //
  constexpr BodyId first_feature() const { return hand + 5; }  // the first handle, or, on a panel without valves, the first button
};
inline constexpr std::size_t max_objects = 51;
// Of a Scene: a record of the served renderer has 9 kB of poses then.
inline constexpr std::size_t max_bodies =
    OwnBodies(capacity::arm_joints).first_feature() + PanelLayout::max_valves + PanelLayout::max_buttons + max_objects;

using Scene = std::vector<Body>;
using BodyPoses = std::vector<Pose>;  // base_from_body of each body of a Scene

// The robot's and the panel's bodies, named and in their order, without shapes. `links`: of the arm, the default machine's where none are given.
Scene bare_scene(const PanelLayout& layout, const PanelNames& names, const std::vector<std::string>& links = {});
inline Scene bare_scene() { return bare_scene(PanelLayout{}, PanelNames{}); }
// Of a scene that begins with them.
OwnBodies own_bodies(const Scene& scene);

// Indices of all bodies of a role, in their order: handles as the layout's valves, buttons as its buttons.
std::vector<std::size_t> bodies_of(const Scene& scene, Role role);
// How many bodies there are before the objects.
std::size_t own_body_count(const Scene& scene);

// All at the base's origin.
inline BodyPoses poses_at_origin(const Scene& scene) { return BodyPoses(scene.size(), Pose::Identity()); }

}  // namespace lf::scene
