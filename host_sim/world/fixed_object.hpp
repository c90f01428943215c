// Something of the scene that stands still: a collider for each of its shapes. A mesh collides as its triangles, so that what is hollow is. Internal to this
// folder.
#pragma once

#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <memory>
#include <vector>

#include "shared/geometry/pose.hpp"
#include "shared/scene/scene.hpp"

namespace lf::world {

class FixedObject {
 public:
  // Enters `world`, which outlives it. `scene_body`: the body it counts as.
  FixedObject(btMultiBodyDynamicsWorld& world, const scene::Body& body, const Pose& base_from_body, int scene_body);
  ~FixedObject();
  FixedObject(const FixedObject&) = delete;
  FixedObject& operator=(const FixedObject&) = delete;

  // One a colliding shape.
  std::vector<btCollisionObject*> colliders() const;

 private:
  // In the order in which they need each other.
  struct Part {
    std::vector<btVector3> vertices_m;  // of a mesh
    std::vector<int> indices;
    std::unique_ptr<btTriangleIndexVertexArray> triangles;
    std::unique_ptr<btCollisionShape> shape;
    double friction = 0;
    std::unique_ptr<btRigidBody> body;
  };

  btMultiBodyDynamicsWorld& world_;
  std::vector<std::unique_ptr<Part>> parts_;
};

}  // namespace lf::world
