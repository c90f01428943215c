#include "host_sim/world/bullet_world.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <algorithm>

#include "shared/scene/scene.hpp"

namespace lf::world {
namespace {

using scene::BodyId;

// Whether two bodies can ever meet: not neighbours in the arm's chain, whose shapes overlap at the joint, nor what stands still together. Objects stand still, as vehicle
// and panel do, and meet all that moves.
bool can_meet(int first, int second) {
  if (first < 0 || second < 0 || first == second) return false;
  const auto a = BodyId(std::min(first, second));
  const auto b = BodyId(std::max(first, second));
  const bool b_is_object = std::size_t(b) >= scene::own_body_count;
  if (b_is_object) return a != BodyId::vehicle && a != BodyId::panel && std::size_t(a) < scene::own_body_count;
  if (a >= BodyId::panel) return false;                          // panel, what is set in it, and an obstacle
  if (a == BodyId::vehicle && b >= BodyId::panel) return false;  // docked
  if (a <= BodyId::forearm && int(b) == int(a) + 1) return false;
  const bool b_is_finger = b == BodyId::finger_a || b == BodyId::finger_b;
  return !(b_is_finger && (a == BodyId::wrist || a == BodyId::forearm));  // the jaw opens sideways, ahead of the forearm
}

struct PairFilter : btOverlapFilterCallback {
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
    return can_meet(static_cast<const btCollisionObject*>(a->m_clientObject)->getUserIndex(),
                    static_cast<const btCollisionObject*>(b->m_clientObject)->getUserIndex());
  }
};

}  // namespace

BulletWorld::BulletWorld(int solver_iterations, double restitution) {
  btDefaultCollisionConstructionInfo pools;  // the default of 4096 each costs 5 MB a world; a grip has about 10 contacts
  pools.m_defaultMaxPersistentManifoldPoolSize = 256;
  pools.m_defaultMaxCollisionAlgorithmPoolSize = 256;
  configuration_ = std::make_unique<btDefaultCollisionConfiguration>(pools);
  dispatcher_ = std::make_unique<btCollisionDispatcher>(configuration_.get());
  broadphase_ = std::make_unique<btDbvtBroadphase>();
  filter_ = std::make_unique<PairFilter>();
  broadphase_->getOverlappingPairCache()->setOverlapFilterCallback(filter_.get());
  solver_ = std::make_unique<FixedBaseSolver>(restitution);
  world_ = std::make_unique<btMultiBodyDynamicsWorld>(dispatcher_.get(), broadphase_.get(), solver_.get(), configuration_.get());
  world_->setGravity(btVector3(0, 0, 0));  // weight less buoyancy is applied to each link
  world_->setForceUpdateAllAabbs(false);
  btContactSolverInfo& info = world_->getSolverInfo();
  info.m_numIterations = solver_iterations;
  info.m_leastSquaresResidualThreshold = 1e-18;  // ends when no row changes by more than 1e-9 m/s or rad/s
  info.m_globalCfm = 0;
  info.m_erp2 = 0.2;
  info.m_frictionERP = 0.2;
}

BulletWorld::~BulletWorld() = default;

void BulletWorld::step(double step_s) {
  solver_->begin_step(*world_);
  world_->stepSimulation(step_s, 0);
}

}  // namespace lf::world
