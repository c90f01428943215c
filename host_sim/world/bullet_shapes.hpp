// Bullet's collision shape of a body of the scene. Internal to this folder.
#pragma once

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <memory>
#include <vector>

#include "shared/geometry/pose.hpp"
#include "shared/scene/scene.hpp"

namespace lf::world {

// A compound and the shapes it is made of, which it does not own by itself. A point that touches nothing has no friction.
struct CollisionShape {
  std::unique_ptr<btCompoundShape> compound;
  std::vector<std::unique_ptr<btCollisionShape>> children;
  std::vector<double> frictions;  // of each child; the compound's user pointer leads here
};

// Friction of the compound's child `child`. `shape` is one that make_collision_shape made.
double friction_of(const btCollisionShape& shape, int child);

// The shapes of `body` with `collides`, seen from `body_from_frame`; a point that touches nothing when there is none.
CollisionShape make_collision_shape(const scene::Body& body, const Pose& body_from_frame);

}  // namespace lf::world
