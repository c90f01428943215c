#include "host_sim/world/fixed_object.hpp"

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>

#include "host_sim/world/bullet_shapes.hpp"
#include "host_sim/world/bullet_types.hpp"

namespace lf::world {
namespace {

// Triangles have no inside into which Bullet could put the margin: it stands out of the surface.
constexpr double mesh_margin_m = 0.0001;

}  // namespace

FixedObject::FixedObject(btMultiBodyDynamicsWorld& world, const scene::Body& body, const Pose& base_from_body, int scene_body)
    : world_(world) {
  for (const scene::Shape& shape : body.shapes) {
    if (!shape.collides) continue;
    auto part = std::make_unique<Part>();
    if (shape.kind == scene::ShapeKind::mesh) {
      for (const Vec3& vertex : shape.vertices_m) part->vertices_m.push_back(to_bullet(vertex));
      for (const auto& triangle : shape.triangles) {
        for (const std::uint32_t corner : triangle) part->indices.push_back(static_cast<int>(corner));
      }
      part->triangles = std::make_unique<btTriangleIndexVertexArray>(
          static_cast<int>(shape.triangles.size()), part->indices.data(), static_cast<int>(3 * sizeof(int)),
          static_cast<int>(part->vertices_m.size()), &part->vertices_m.front()[0], static_cast<int>(sizeof(btVector3)));
      part->shape = std::make_unique<btBvhTriangleMeshShape>(part->triangles.get(), true);
      part->shape->setMargin(mesh_margin_m);
    } else {
      part->shape = make_convex_shape(shape);
    }
    part->friction = shape.friction;
    part->shape->setUserPointer(&part->friction);
    part->body = std::make_unique<btRigidBody>(0, nullptr, part->shape.get());
    part->body->setWorldTransform(to_bullet(Pose(base_from_body * shape.body_from_shape)));
    part->body->setUserIndex(scene_body);
    world_.addCollisionObject(part->body.get());
    parts_.push_back(std::move(part));
  }
}

std::vector<btCollisionObject*> FixedObject::colliders() const {
  std::vector<btCollisionObject*> all;
  for (const auto& part : parts_) all.push_back(part->body.get());
  return all;
}

FixedObject::~FixedObject() {
  for (const auto& part : parts_) world_.removeCollisionObject(part->body.get());
}

}  // namespace lf::world
