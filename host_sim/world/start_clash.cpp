#include "host_sim/world/start_clash.hpp"

#include <algorithm>

#include "shared/mesh/winding.hpp"

namespace lf::world {
namespace {

struct DeepestPoint : btCollisionWorld::ContactResultCallback {
  double depth_m = 0;
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int,
                           int) override {
    depth_m = std::max(depth_m, -double(point.getDistance()));
    return 0;
  }
};

Vec3 middle_of(const scene::Shape& shape) {
  if (shape.kind != scene::ShapeKind::mesh || shape.vertices_m.empty()) return shape.body_from_shape.translation();
  Vec3 sum = Vec3::Zero();
  for (const Vec3& vertex : shape.vertices_m) sum += vertex;
  return shape.body_from_shape * Vec3(sum / double(shape.vertices_m.size()));
}

Eigen::AlignedBox3d bounds_of(const scene::Shape& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const Vec3& vertex : mesh.vertices_m) bounds.extend(vertex);
  return bounds;
}

}  // namespace

double overlap_m(btMultiBodyDynamicsWorld& world, const btCollisionObject& a, const btCollisionObject& b) {
  DeepestPoint deepest;
  // Bullet asks for objects that may change, and changes none.
  world.contactPairTest(const_cast<btCollisionObject*>(&a), const_cast<btCollisionObject*>(&b), deepest);
  return deepest.depth_m;
}

bool is_inside(const scene::Body& body, const Pose& base_from_body, const scene::Body& object) {
  for (const scene::Shape& mesh : object.shapes) {
    if (!mesh.collides || mesh.kind != scene::ShapeKind::mesh) continue;
    const Eigen::AlignedBox3d bounds = bounds_of(mesh);
    const Pose mesh_from_body = (object.base_from_body * mesh.body_from_shape).inverse() * base_from_body;
    for (const scene::Shape& shape : body.shapes) {
      const Vec3 middle = mesh_from_body * middle_of(shape);
      if (!shape.collides || !bounds.contains(middle)) continue;  // mostly: a large mesh is gone through for the rest alone
      if (mesh::winding_number(mesh.vertices_m, mesh.triangles, middle) > 0.5) return true;  // between 0 outside and 1 inside
    }
  }
  return false;
}

}  // namespace lf::world
