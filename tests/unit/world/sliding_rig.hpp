// Bodies on rails in the world's solver, for collisions and friction that have closed forms.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cmath>
#include <memory>
#include <vector>

#include "host_sim/world/bullet_types.hpp"
#include "host_sim/world/bullet_world.hpp"
#include "host_sim/world/contact_sensor.hpp"
#include "host_sim/world/multibody_part.hpp"
#include "tests/arm5e_bodies.hpp"

namespace lf::world {

inline scene::Body box_body(const Vec3& size_m, const Pose& body_from_shape = Pose::Identity(), double friction = 0.5) {
  scene::Shape shape;
  shape.kind = scene::ShapeKind::box;
  shape.size_m = size_m;
  shape.body_from_shape = body_from_shape;
  shape.friction = friction;
  return {"box", {shape}, scene::Role::object, Pose::Identity()};
}

// A fixed structure: infinite mass.
class Wall {
 public:
  Wall(BulletWorld& world, const scene::Body& body, const Pose& pose, scene::BodyId id = arm5e_body::panel)
      : world_(world), shape_(make_collision_shape(body, Pose::Identity())), body_(0, nullptr, shape_.compound.get()) {
    body_.setWorldTransform(to_bullet(pose));
    body_.setUserIndex(int(id));
    world_.get().addCollisionObject(&body_);
  }
  ~Wall() { world_.get().removeCollisionObject(&body_); }

 private:
  BulletWorld& world_;
  CollisionShape shape_;
  btRigidBody body_;
};

// A mass that slides along x, y and z of `pose`, without turning. The colliding box is the last link's.
class Sled {
 public:
  Sled(BulletWorld& world, double mass_kg, const scene::Body& body, const Pose& pose, scene::BodyId id = arm5e_body::finger_a)
      : world_(world), part_(3, pose) {
    const btVector3 inertia(1e-3, 1e-3, 1e-3);
    constexpr double rail_mass_kg = 1e-9;  // the rails weigh nothing beside the sled
    const btVector3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; ++i) {
      part_.body().setupPrismatic(i, i == 2 ? mass_kg : rail_mass_kg, inertia, i - 1, btQuaternion::getIdentity(), axes[i],
                                  btVector3(0, 0, 0), btVector3(0, 0, 0), false);
    }
    part_.finish_links();
    part_.add_collider(-1, make_collision_shape({}, Pose::Identity()), no_body, Friction::anchored);
    for (int i = 0; i < 2; ++i) part_.add_collider(i, make_collision_shape({}, Pose::Identity()), no_body, Friction::anchored);
    part_.add_collider(2, make_collision_shape(body, Pose::Identity()), int(id), Friction::anchored);
    part_.update_poses();
    part_.enter(world.get());
  }
  ~Sled() { part_.leave(world_.get()); }

  void set_speed(const Vec3& speed_m_s) {
    for (int i = 0; i < 3; ++i) part_.body().setJointVel(i, speed_m_s[i]);
  }
  Vec3 speed_m_s() const { return {part_.body().getJointVel(0), part_.body().getJointVel(1), part_.body().getJointVel(2)}; }
  Vec3 position_m() const { return {part_.body().getJointPos(0), part_.body().getJointPos(1), part_.body().getJointPos(2)}; }
  // World axes, for the coming step.
  void push(const Vec3& force_n) { part_.body().addLinkForce(2, to_bullet(force_n)); }

 private:
  BulletWorld& world_;
  MultibodyPart part_;
};

}  // namespace lf::world
