// Bullet's world with the settings everything here relies on. Internal to this folder.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <memory>

namespace lf::world {

class BulletWorld {
 public:
  explicit BulletWorld(int solver_iterations);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  // Advances by exactly one step.
  void step(double step_s) { world_->stepSimulation(step_s, 0); }
  btMultiBodyDynamicsWorld& get() { return *world_; }
  // Restitution needs contacts without position correction.
  void make_restitution_exact();

 private:
  std::unique_ptr<btDefaultCollisionConfiguration> configuration_;
  std::unique_ptr<btCollisionDispatcher> dispatcher_;
  std::unique_ptr<btDbvtBroadphase> broadphase_;
  std::unique_ptr<btOverlapFilterCallback> filter_;
  std::unique_ptr<btMultiBodyConstraintSolver> solver_;
  std::unique_ptr<btMultiBodyDynamicsWorld> world_;
};

}  // namespace lf::world
