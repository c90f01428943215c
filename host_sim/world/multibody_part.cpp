#include "host_sim/world/multibody_part.hpp"

#include "host_sim/world/bullet_types.hpp"

namespace lf::world {

MultibodyPart::MultibodyPart(int links, const Pose& base_from_root) {
  body_ = std::make_unique<btMultiBody>(links, 1.0, btVector3(1, 1, 1), true, false);
  body_->setBaseWorldTransform(to_bullet(base_from_root));
  body_->setLinearDamping(0);  // Bullet's default of 0.04 would brake everything
  body_->setAngularDamping(0);
  body_->setHasSelfCollision(true);
}

MultibodyPart::~MultibodyPart() = default;

void MultibodyPart::finish_links() {
  body_->finalizeMultiDof();
  update_poses();
}

void MultibodyPart::add_collider(int link, CollisionShape shape, int scene_body, Friction friction) {
  auto collider = std::make_unique<btMultiBodyLinkCollider>(body_.get(), link);
  collider->setCollisionShape(shape.compound.get());
  collider->setUserIndex(scene_body);
  collider->setActivationState(DISABLE_DEACTIVATION);
  int flags = friction == Friction::anchored ? btCollisionObject::CF_HAS_FRICTION_ANCHOR : 0;
  if (link < 0) {
    flags |= btCollisionObject::CF_STATIC_OBJECT;
    body_->setBaseCollider(collider.get());
  } else {
    body_->getLink(link).m_collider = collider.get();
  }
  collider->setCollisionFlags(collider->getCollisionFlags() | flags);
  shapes_.push_back(std::move(shape));
  colliders_.push_back(std::move(collider));
}

JointRows& MultibodyPart::add_rows(int link, int second_link) {
  rows_.push_back(std::make_unique<JointRows>(body_.get(), link, second_link));
  return *rows_.back();
}

void MultibodyPart::enter(btMultiBodyDynamicsWorld& world) {
  if (entered_) return;
  world.addMultiBody(body_.get());
  for (const auto& collider : colliders_) world.addCollisionObject(collider.get());
  for (const auto& rows : rows_) world.addMultiBodyConstraint(rows.get());
  entered_ = true;
}

void MultibodyPart::leave(btMultiBodyDynamicsWorld& world) {
  if (!entered_) return;
  for (const auto& rows : rows_) world.removeMultiBodyConstraint(rows.get());
  for (const auto& collider : colliders_) world.removeCollisionObject(collider.get());
  world.removeMultiBody(body_.get());
  entered_ = false;
}

void MultibodyPart::update_poses() {
  body_->forwardKinematics(scratch_rotations_, scratch_origins_);
  body_->updateCollisionObjectWorldTransforms(scratch_rotations_, scratch_origins_);
}

Pose MultibodyPart::base_from_link(int link) const {
  return from_bullet(link < 0 ? body_->getBaseWorldTransform() : body_->getLink(link).m_collider->getWorldTransform());
}

}  // namespace lf::world
