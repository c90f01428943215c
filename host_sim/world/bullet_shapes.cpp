#include "host_sim/world/bullet_shapes.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include "host_sim/world/bullet_types.hpp"

namespace lf::world {

std::unique_ptr<btCollisionShape> make_convex_shape(const scene::Shape& shape) {
  using scene::ShapeKind;
  const Vec3& size = shape.size_m;
  std::unique_ptr<btCollisionShape> made;
  switch (shape.kind) {
    case ShapeKind::box: made = std::make_unique<btBoxShape>(to_bullet(Vec3(0.5 * size))); break;
    case ShapeKind::cylinder: made = std::make_unique<btCylinderShapeZ>(btVector3(size.x(), size.x(), 0.5 * size.z())); break;
    case ShapeKind::capsule: return std::make_unique<btCapsuleShapeZ>(size.x(), size.z());
    case ShapeKind::sphere: return std::make_unique<btSphereShape>(size.x());
    case ShapeKind::mesh: {
      auto hull = std::make_unique<btConvexHullShape>();
      for (const Vec3& vertex : shape.vertices_m) hull->addPoint(to_bullet(vertex), false);
      hull->recalcLocalAabb();
      made = std::move(hull);
      break;
    }
  }
  made->setMargin(edge_radius_m);
  return made;
}

CollisionShape make_collision_shape(const scene::Body& body, const Pose& body_from_frame) {
  CollisionShape made;
  made.compound = std::make_unique<btCompoundShape>();
  for (const scene::Shape& shape : body.shapes) {
    if (!shape.collides) continue;
    made.children.push_back(make_convex_shape(shape));
    made.compound->addChildShape(to_bullet(Pose(body_from_frame.inverse() * shape.body_from_shape)), made.children.back().get());
    made.frictions.push_back(shape.friction);
  }
  if (made.children.empty()) {
    made.children.push_back(std::make_unique<btSphereShape>(1e-4));
    made.compound->addChildShape(btTransform::getIdentity(), made.children.back().get());
    made.frictions.push_back(0);
  }
  made.compound->setUserPointer(made.frictions.data());  // stays where it is when `made` is moved
  return made;
}

double friction_of(const btCollisionShape& shape, int child) {
  return static_cast<const double*>(shape.getUserPointer())[shape.isCompound() ? child : 0];  // a mesh's points count triangles
}

}  // namespace lf::world
