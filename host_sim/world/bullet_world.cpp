#include "host_sim/world/bullet_world.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <algorithm>
#include <vector>

namespace lf::world {
namespace {

using scene::Role;

bool is_arm(Role role) { return role == Role::link || role == Role::hand || role == Role::finger; }

// Whether two bodies can ever meet: not neighbours in the arm's chain, whose shapes overlap at the joint, nor what stands still together, nor the panel and what is set
// in it, nor an obstacle and anything but the arm and objects. Objects stand still, as vehicle and panel do, and meet all that moves.
bool can_meet(int first, int second, const std::vector<Role>& roles, const scene::OwnBodies& own, bool hand_rolls) {
  if (first < 0 || second < 0 || first == second) return false;
  const auto low = std::size_t(std::min(first, second)), high = std::size_t(std::max(first, second));
  const Role a = roles[low], b = roles[high];
  if (b == Role::object) return a != Role::vehicle && a != Role::panel && a != Role::object;
  if (!is_arm(a) && !is_arm(b)) return false;
  if (!is_arm(b)) return true;  // the arm comes before all that it can meet but the vehicle
  if (low < own.hand && high == low + 1) return false;
  // The jaw of a hand that rolls opens sideways, ahead of the forearm.
  return !(b == Role::finger && (low == own.hand || (hand_rolls && low == own.before_hand())));
}

struct PairFilter : btOverlapFilterCallback {
  PairFilter(const scene::Scene& scene, bool rolls) : own(scene::own_bodies(scene)), hand_rolls(rolls) {
    for (const scene::Body& body : scene) roles.push_back(body.role);
  }
  std::vector<Role> roles;
  scene::OwnBodies own;
  bool hand_rolls;
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
    return can_meet(static_cast<const btCollisionObject*>(a->m_clientObject)->getUserIndex(),
                    static_cast<const btCollisionObject*>(b->m_clientObject)->getUserIndex(), roles, own, hand_rolls);
  }
};

}  // namespace

BulletWorld::BulletWorld(int solver_iterations, double restitution, const scene::Scene& scene, bool hand_rolls) {
  btDefaultCollisionConstructionInfo pools;  // the default of 4096 each costs 5 MB a world; a grip has about 10 contacts
  pools.m_defaultMaxPersistentManifoldPoolSize = 256;
  pools.m_defaultMaxCollisionAlgorithmPoolSize = 256;
  configuration_ = std::make_unique<btDefaultCollisionConfiguration>(pools);
  dispatcher_ = std::make_unique<btCollisionDispatcher>(configuration_.get());
  broadphase_ = std::make_unique<btDbvtBroadphase>();
  filter_ = std::make_unique<PairFilter>(scene, hand_rolls);
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
