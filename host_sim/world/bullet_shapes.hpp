// Bullet's collision shape of a body of the scene. Internal to this folder.
#pragma once

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <memory>
#include <vector>

#include "shared/geometry/pose.hpp"
#include "shared/scene/scene.hpp"

namespace lf::world {

// Rounds the edges of boxes, cylinders and hulls inside their true surface. Bullet's 40 mm would swallow a 12.6 mm handle; below about
// 0.1 mm GJK loses the closest points of touching faces.
inline constexpr double edge_radius_m = 0.0005;

// A compound and the shapes it is made of, which it does not own by itself. A point that touches nothing has no friction.
struct CollisionShape {
  std::unique_ptr<btCompoundShape> compound;
  std::vector<std::unique_ptr<btCollisionShape>> children;
  std::vector<double> frictions;  // of each child; the compound's user pointer leads here
};

// A single shape, a mesh as its convex hull.
std::unique_ptr<btCollisionShape> make_convex_shape(const scene::Shape& shape);

// Friction of a compound's child `child`, which make_collision_shape made, or of a shape by itself: its user pointer leads to one, or to as many.
double friction_of(const btCollisionShape& shape, int child);

// The shapes of `body` with `collides`, seen from `body_from_frame`; a point that touches nothing when there is none.
CollisionShape make_collision_shape(const scene::Body& body, const Pose& body_from_frame);

}  // namespace lf::world
