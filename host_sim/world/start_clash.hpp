// Whether two things stand in each other. Internal to this folder.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include "shared/geometry/pose.hpp"
#include "shared/scene/scene.hpp"

namespace lf::world {

// How deep two colliders, of which none has to be in the world, overlap at their deepest point; 0 where they do not. Of a mesh only the surface counts.
double overlap_m(btMultiBodyDynamicsWorld& world, const btCollisionObject& a, const btCollisionObject& b);

// Whether a shape of `body` has its middle inside of a mesh of `object`, which Bullet takes for a surface.
bool is_inside(const scene::Body& body, const Pose& base_from_body, const scene::Body& object);

}  // namespace lf::world
