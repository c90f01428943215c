#include "host_sim/world/fixed_base_solver.hpp"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <algorithm>
#include <cmath>

#include "host_sim/world/bullet_shapes.hpp"

namespace lf::world {
namespace {

void limit_push_out(btManifoldPoint& point, const btContactSolverInfo& info) {
  const double depth_m = -point.getDistance();
  if (depth_m <= 0) return;
  const double too_deep_m = std::max(0.0, depth_m - FixedBaseSolver::blow_m_s * info.m_timeStep);
  const double push_out_m_s = FixedBaseSolver::push_out_m_s + too_deep_m / FixedBaseSolver::recovery_s;
  point.m_contactERP = std::min(info.m_erp2, push_out_m_s * info.m_timeStep / depth_m);
  point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_ERP;
}

}  // namespace

btScalar FixedBaseSolver::solveGroupCacheFriendlySetup(btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
                                                       int manifold_count, btTypedConstraint** constraints, int constraint_count,
                                                       const btContactSolverInfo& info, btIDebugDraw* drawer) {
  for (int i = 0; i < manifold_count; ++i) prepare(*manifolds[i], info);
  const btScalar residual = btMultiBodyConstraintSolver::solveGroupCacheFriendlySetup(bodies, body_count, manifolds, manifold_count,
                                                                                      constraints, constraint_count, info, drawer);
  if (restitution_ > 0) add_rebounds(info);
  return residual;
}

void FixedBaseSolver::begin_step(btMultiBodyDynamicsWorld& world) {
  if (restitution_ == 0) return;
  before_.clear();
  for (int i = 0; i < world.getNumMultibodies(); ++i) {
    const btMultiBody& body = *world.getMultiBody(i);
    Before& before = before_.emplace_back();
    before.body = &body;
    for (int joint = 0; joint < body.getNumDofs(); ++joint) before.speeds[joint] = body.getVelocityVector()[6 + joint];
  }
}

void FixedBaseSolver::prepare(btPersistentManifold& manifold, const btContactSolverInfo& info) const {
  // A contact that is solved ahead of time, while there is still a gap, is braked before it closes and has nothing to rebound with.
  if (restitution_ > 0) manifold.setContactProcessingThreshold(0);
  const btCollisionShape& a = *manifold.getBody0()->getCollisionShape();
  const btCollisionShape& b = *manifold.getBody1()->getCollisionShape();
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    point.m_combinedFriction = friction_of(a, point.m_index0) * friction_of(b, point.m_index1);
    point.m_combinedRestitution = 0;  // add_rebounds has it
    limit_push_out(point, info);
  }
}

double FixedBaseSolver::speed_before(const btMultiBody* body, int jacobian_index) const {
  const auto found = std::find_if(before_.begin(), before_.end(), [&](const Before& before) { return before.body == body; });
  if (body == nullptr || found == before_.end()) return 0;
  double speed = 0;
  for (int i = 0; i < body->getNumDofs(); ++i) speed += m_data.m_jacobians[jacobian_index + 6 + i] * found->speeds[i];
  return speed;
}

// Bullet's rows end at the push-out's speed.
void FixedBaseSolver::add_rebounds(const btContactSolverInfo& info) {
  for (int i = 0; i < m_multiBodyNormalContactConstraints.size(); ++i) {
    btMultiBodySolverConstraint& row = m_multiBodyNormalContactConstraints[i];
    const double closing_m_s = -speed_before(row.m_multiBodyA, row.m_jacAindex) - speed_before(row.m_multiBodyB, row.m_jacBindex);
    if (closing_m_s < bounce_m_s) continue;
    const auto& point = *static_cast<const btManifoldPoint*>(row.m_originalContactPoint);
    const double leaving_m_s = std::max(0.0, -point.getDistance()) * point.m_contactERP / info.m_timeStep;
    row.m_rhs += std::max(0.0, restitution_ * closing_m_s - leaving_m_s) * row.m_jacDiagABInv;
  }
}

FixedBaseSolver::Side FixedBaseSolver::side(const btMultiBody* body, int speeds_index, int jacobian_index) {
  Side made;
  if (body == nullptr || speeds_index < 0) return made;
  const auto found = std::find(mechanisms_.begin(), mechanisms_.end(), body);
  made.mechanism = int(found - mechanisms_.begin());
  if (found == mechanisms_.end()) {
    mechanisms_.push_back(body);
    speeds_.push_back(Joints::Zero());
  }
  made.joints = body->getNumDofs();
  int moved = 0;
  for (int i = 0; i < made.joints; ++i) {
    made.jacobian[i] = m_data.m_jacobians[jacobian_index + 6 + i];
    made.response[i] = m_data.m_deltaVelocitiesUnitImpulse[jacobian_index + 6 + i];
    if (made.jacobian[i] != 0) made.only_joint = i, ++moved;
  }
  if (moved != 1) made.only_joint = -1;
  return made;
}

// Of the sizes that mechanisms have: handles and buttons, an arm of four joints with its fingers, any.
void FixedBaseSolver::Side::push(Joints& speeds, double impulse) const {
  if (joints <= 2)
    speeds.head<2>() += impulse * response.head<2>();
  else if (joints <= 6)
    speeds.head<6>() += impulse * response.head<6>();
  else
    speeds += impulse * response;
}

void FixedBaseSolver::take(const btMultiBodyConstraintArray& from, std::vector<Row>& to) {
  to.clear();
  for (int i = 0; i < from.size(); ++i) {
    const btMultiBodySolverConstraint& c = from[i];
    Row row;
    row.a = side(c.m_multiBodyA, c.m_deltaVelAindex, c.m_jacAindex);
    row.b = side(c.m_multiBodyB, c.m_deltaVelBindex, c.m_jacBindex);
    row.inverse_mass = c.m_jacDiagABInv;
    row.rhs = c.m_rhs;
    row.cfm = c.m_cfm;
    row.lower = c.m_lowerLimit;
    row.upper = c.m_upperLimit;
    row.friction = c.m_friction;
    row.normal_row = c.m_frictionIndex;
    to.push_back(row);
  }
}

void FixedBaseSolver::take_rows() {
  mechanisms_.clear();
  speeds_.clear();
  take(m_multiBodyNonContactConstraints, joints_);
  take(m_multiBodyNormalContactConstraints, normals_);
  take(m_multiBodyFrictionContactConstraints, frictions_);
}

double FixedBaseSolver::wanted_impulse(const Row& row) const {
  double speed = 0;
  if (row.a.mechanism >= 0) speed += row.a.speed(speeds_[std::size_t(row.a.mechanism)]);
  if (row.b.mechanism >= 0) speed += row.b.speed(speeds_[std::size_t(row.b.mechanism)]);
  return row.applied + row.rhs - row.applied * row.cfm - speed * row.inverse_mass;
}

// Returns the change of speed along the row.
double FixedBaseSolver::apply(Row& row, double impulse) {
  const double change = impulse - row.applied;
  row.applied = impulse;
  if (row.a.mechanism >= 0) row.a.push(speeds_[std::size_t(row.a.mechanism)], change);
  if (row.b.mechanism >= 0) row.b.push(speeds_[std::size_t(row.b.mechanism)], change);
  return change / row.inverse_mass;
}

double FixedBaseSolver::solve(Row& row) { return apply(row, std::clamp(wanted_impulse(row), row.lower, row.upper)); }

double FixedBaseSolver::solve_friction(Row& first, Row& second) {
  const double limit = first.friction * normals_[std::size_t(first.normal_row)].applied;
  double along = wanted_impulse(first);
  double across = wanted_impulse(second);
  const double size = std::sqrt(along * along + across * across);
  if (size > limit) {
    along *= limit / size;
    across *= limit / size;
  }
  const double change = apply(first, along);
  return std::max(std::abs(change), std::abs(apply(second, across)));
}

btScalar FixedBaseSolver::solveSingleIteration(int iteration, btCollisionObject**, int, btPersistentManifold**, int, btTypedConstraint**,
                                               int, const btContactSolverInfo&, btIDebugDraw*) {
  if (iteration == 0) take_rows();
  double change = 0;
  for (std::size_t i = 0; i < joints_.size(); ++i) {  // to and fro, as Bullet does
    Row& row = joints_[iteration % 2 != 0 ? i : joints_.size() - 1 - i];
    change = std::max(change, std::abs(solve(row)));
  }
  for (Row& row : normals_) change = std::max(change, std::abs(solve(row)));
  for (std::size_t i = 0; i + 1 < frictions_.size(); i += 2) change = std::max(change, solve_friction(frictions_[i], frictions_[i + 1]));
  return change * change;
}

void FixedBaseSolver::give_back(const std::vector<Row>& from, btMultiBodyConstraintArray& to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const btMultiBodySolverConstraint& c = to[int(i)];
    const double change = from[i].applied - c.m_appliedImpulse;
    c.m_appliedImpulse = from[i].applied;
    if (from[i].a.mechanism >= 0) c.m_multiBodyA->applyDeltaVeeMultiDof2(&m_data.m_deltaVelocitiesUnitImpulse[c.m_jacAindex], change);
    if (from[i].b.mechanism >= 0) c.m_multiBodyB->applyDeltaVeeMultiDof2(&m_data.m_deltaVelocitiesUnitImpulse[c.m_jacBindex], change);
  }
}

btScalar FixedBaseSolver::solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count, const btContactSolverInfo& info) {
  give_back(joints_, m_multiBodyNonContactConstraints);
  give_back(normals_, m_multiBodyNormalContactConstraints);
  give_back(frictions_, m_multiBodyFrictionContactConstraints);
  return btMultiBodyConstraintSolver::solveGroupCacheFriendlyFinish(bodies, body_count, info);
}

}  // namespace lf::world
