// The bodies of the simulated scene, described once: physics collides them, optics draws them. Hosted side only.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/geometry/pose.hpp"

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

struct Body {
  std::string name;
  std::vector<Shape> shapes;
};

// Indices of the bodies in a Scene, which are always in this order. `base_from_body` of each is given by the world at every step.
enum class BodyId : std::size_t {
  vehicle,  // what is bolted to the arm's base: skid, camera and lamp housings
  slew,
  upper_arm,
  forearm,  // with the laser
  wrist,
  finger_a,
  finger_b,
  panel,
  handle,
  button_left,
  button_centre,
  button_right,
  obstacle,  // what a fault of the scenario pushes against the arm: met in contacts, but no part of a Scene
};
inline constexpr std::size_t body_count = 12;                        // of a Scene
inline constexpr std::size_t touchable_body_count = body_count + 1;  // in contacts

using Scene = std::array<Body, body_count>;
using BodyPoses = std::array<Pose, body_count>;  // base_from_body

}  // namespace lf::scene
