#include "host_sim/world/obstacle.hpp"

#include <array>

#include "host_sim/world/bullet_types.hpp"

namespace lf::world {

namespace {

constexpr double side_m = 0.1;
constexpr double mass_kg = 4;      // with the water it takes along
constexpr double away_m = 0.2;     // at the start, from the middle of the wrist
constexpr double push_n = 80;      // above the core's contact threshold of 50 N at the wrist, below the 150 N that may not be passed
constexpr double speed_m_s = 0.2;  // at which the water's drag balances the push
constexpr double small_kg = 0.05;  // of the two links between the world and the box, which are nothing
constexpr int links = 3, box_link = 2;

Pose at(const Vec3& place_m) {
  Pose pose = Pose::Identity();
  pose.translation() = place_m;
  return pose;
}

scene::Body box() {
  scene::Body body;
  scene::Shape shape;
  shape.kind = scene::ShapeKind::box;
  shape.size_m = Vec3::Constant(side_m);
  shape.collides = true;
  body.shapes.push_back(shape);
  return body;
}

}  // namespace

// Along x, then z, then y, each with the water's drag.
Obstacle::Obstacle(btMultiBodyDynamicsWorld& world, const Vec3& target_m, int scene_body)
    : world_(world), part_(links, at(target_m - Vec3(0, away_m, 0))) {
  const btVector3 inertia(0.01, 0.01, 0.01);  // of no effect: it does not turn
  const std::array<btVector3, links> axes{btVector3(1, 0, 0), btVector3(0, 0, 1), btVector3(0, 1, 0)};
  for (int link = 0; link < links; ++link) {
    part_.body().setupPrismatic(link, link == box_link ? mass_kg : small_kg, inertia, link - 1, btQuaternion::getIdentity(),
                                axes[static_cast<std::size_t>(link)], btVector3(0, 0, 0), btVector3(0, 0, 0), false);
  }
  part_.finish_links();
  for (int link = -1; link < box_link; ++link)
    part_.add_collider(link, make_collision_shape({}, Pose::Identity()), no_body, Friction::free);
  part_.add_collider(box_link, make_collision_shape(box(), Pose::Identity()), scene_body, Friction::free);
  part_.update_poses();
  part_.enter(world_);
}

Obstacle::~Obstacle() { part_.leave(world_); }

void Obstacle::before_step() {
  for (int link = 0; link < links; ++link) {
    const double drag_n = push_n / speed_m_s * part_.body().getJointVel(link);
    part_.body().addJointTorque(link, (link == box_link ? push_n : 0) - drag_n);
  }
}

}  // namespace lf::world
