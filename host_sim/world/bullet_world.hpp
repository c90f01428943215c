// Bullet's world with the settings everything here relies on. Internal to this folder.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <memory>

#include "host_sim/world/fixed_base_solver.hpp"
#include "shared/scene/scene.hpp"

namespace lf::world {

class BulletWorld {
 public:
  // `restitution` is that of every contact. Colliders name their body of `scene` by their user index: its role says what it can meet.
  BulletWorld(int solver_iterations, double restitution, const scene::Scene& scene, bool hand_rolls = true);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  // Advances by exactly one step.
  void step(double step_s);
  btMultiBodyDynamicsWorld& get() { return *world_; }

 private:
  std::unique_ptr<btDefaultCollisionConfiguration> configuration_;
  std::unique_ptr<btCollisionDispatcher> dispatcher_;
  std::unique_ptr<btDbvtBroadphase> broadphase_;
  std::unique_ptr<btOverlapFilterCallback> filter_;
  std::unique_ptr<FixedBaseSolver> solver_;
  std::unique_ptr<btMultiBodyDynamicsWorld> world_;
};

}  // namespace lf::world
