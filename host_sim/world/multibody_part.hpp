// A multibody with the colliders of its base and links. Internal to this folder.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <memory>
#include <vector>

#include "host_sim/world/bullet_shapes.hpp"
#include "host_sim/world/joint_rows.hpp"

namespace lf::world {

// Marks a collider that touches nothing.
inline constexpr int no_body = -1;

// What holds a touching body sideways. A friction anchor keeps a standing contact where it was: without one a pressed cap creeps. But Bullet keeps an
// anchored point's normal, too, as long as the bodies touch, however they turn: pads that have carried a bar through a quarter turn stick to it and do
// not let go. What is turned by contact goes without.
enum class Friction { anchored, free };

// Bullet ignores constraints on a link without a collider, so each has one.
class MultibodyPart {
 public:
  // Fixed base at `base_from_root`; links are set up through `body()` before colliders are added.
  MultibodyPart(int links, const Pose& base_from_root);
  ~MultibodyPart();
  MultibodyPart(const MultibodyPart&) = delete;
  MultibodyPart& operator=(const MultibodyPart&) = delete;

  btMultiBody& body() { return *body_; }
  const btMultiBody& body() const { return *body_; }

  // After all links are set up.
  void finish_links();
  // link -1 is the base; user index: the body of the scene, or `no_body`.
  void add_collider(int link, CollisionShape shape, int scene_body, Friction friction);
  JointRows& add_rows(int link, int second_link = -1);

  // Brings everything into the world, or takes it out.
  void enter(btMultiBodyDynamicsWorld& world);
  void leave(btMultiBodyDynamicsWorld& world);
  bool entered() const { return entered_; }
  // Positions to poses, of links and colliders.
  void update_poses();
  Pose base_from_link(int link) const;

  const std::vector<std::unique_ptr<btMultiBodyLinkCollider>>& colliders() const { return colliders_; }

 private:
  std::unique_ptr<btMultiBody> body_;
  std::vector<CollisionShape> shapes_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  std::vector<std::unique_ptr<JointRows>> rows_;
  btAlignedObjectArray<btQuaternion> scratch_rotations_;
  btAlignedObjectArray<btVector3> scratch_origins_;
  bool entered_ = false;
};

}  // namespace lf::world
