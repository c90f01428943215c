#include "host_sim/world/joint_rows.hpp"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <numeric>

namespace lf::world {
namespace {

// Bullet leaves a joint's row rigid: its softness adds to the inverse of the row's mass.
void soften(btMultiBodySolverConstraint& row, double softness) {
  const double inverse_mass = 1 / (1 / row.m_jacDiagABInv + softness);
  row.m_rhs *= inverse_mass / row.m_jacDiagABInv;
  row.m_jacDiagABInv = inverse_mass;
  row.m_cfm = softness * inverse_mass;
}

}  // namespace

JointRows::Row JointRows::damper(double nm_s, double step_s) {
  constexpr double unlimited_n_m_s = 1e6;
  Row row;
  row.impulse_min = -unlimited_n_m_s;
  row.impulse_max = unlimited_n_m_s;
  row.softness = 1 / (nm_s * step_s);
  return row;
}

JointRows::JointRows(btMultiBody* body, int link, int second_link)
    : btMultiBodyConstraint(body, nullptr, link, -1, int(slot_count), false, MULTIBODY_CONSTRAINT_1DOF_JOINT_MOTOR),
      second_link_(second_link) {
  finalizeMultiDof();
  for (std::size_t i = 0; i < slot_count; ++i) internalSetAppliedImpulse(int(i), 0);
}

void JointRows::finalizeMultiDof() {
  allocateJacobiansMultiDof();
  m_numDofsFinalized = m_jacSizeBoth;
}

int JointRows::getIslandIdA() const {
  const btMultiBodyLinkCollider* collider = m_bodyA->getLink(m_linkA).m_collider;
  return collider != nullptr ? collider->getIslandTag() : -1;
}

void JointRows::begin() {
  for (std::size_t i = 0; i < slot_count; ++i) {
    slots_[i].start = impulse(i);
    slots_[i].used = false;
    internalSetAppliedImpulse(int(i), 0);
  }
}

void JointRows::set(std::size_t slot, const Row& row) {
  slots_[slot].row = row;
  slots_[slot].used = true;
  constexpr int base_coordinates = 6;
  double* jacobian = jacobianA(int(slot)) + base_coordinates;
  jacobian[m_bodyA->getLink(m_linkA).m_dofOffset] = row.first;
  if (second_link_ >= 0) jacobian[m_bodyA->getLink(second_link_).m_dofOffset] = row.second;
}

void JointRows::apply_start(double step_s) {
  double first = 0;
  double second = 0;
  for (Slot& slot : slots_) {
    slot.start = slot.used ? std::clamp(slot.start, slot.row.impulse_min, slot.row.impulse_max) : 0;
    first += slot.row.first * slot.start;
    second += slot.row.second * slot.start;
  }
  if (first != 0) m_bodyA->addJointTorque(m_linkA, first / step_s);
  if (second != 0 && second_link_ >= 0) m_bodyA->addJointTorque(second_link_, second / step_s);
}

double JointRows::impulse(std::size_t slot) const { return slots_[slot].start + m_data[int(slot)]; }

// Rows of the same coordinate differ in speed and bounds only: what a unit impulse does, which takes Bullet longest, is asked once for them.
void JointRows::createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data, const btContactSolverInfo& info) {
  const btVector3 unused(0, 0, 0);
  const Slot* filled = nullptr;
  int filled_row = 0;
  double rigid_inverse_mass = 0;
  for (int i = 0; i < int(slot_count); ++i) {
    const Slot& slot = slots_[std::size_t(i)];
    if (!slot.used) continue;
    btMultiBodySolverConstraint& row = rows.expandNonInitializing();
    const double speed = slot.row.speed - slot.row.softness * slot.start;
    const double lower = slot.row.impulse_min - slot.start, upper = slot.row.impulse_max - slot.start;
    if (filled != nullptr && filled->row.first == slot.row.first && filled->row.second == slot.row.second) {
      row = rows[filled_row];
      repeat(row, data);
      row.m_jacDiagABInv = rigid_inverse_mass;
      row.m_rhs = (speed - speed_along(jacobianA(i))) * rigid_inverse_mass;
      row.m_cfm = 0;
      row.m_lowerLimit = lower, row.m_upperLimit = upper;
    } else {
      fillMultiBodyConstraint(row, data, jacobianA(i), jacobianB(i), unused, unused, unused, unused, 0, info, lower, upper, false, 1, false,
                              speed);
      filled = &slot, filled_row = rows.size() - 1, rigid_inverse_mass = row.m_jacDiagABInv;
    }
    soften(row, slot.row.softness);
    row.m_orgConstraint = this;
    row.m_orgDofIndex = i;
    row.m_contactNormal1.setZero();
    row.m_contactNormal2.setZero();
    row.m_relpos1CrossNormal.setZero();
    row.m_relpos2CrossNormal.setZero();
  }
}

// Gives a copied row its own place among the jacobians and the responses.
void JointRows::repeat(btMultiBodySolverConstraint& row, btMultiBodyJacobianData& data) const {
  const int from = row.m_jacAindex, count = m_jacSizeA;
  row.m_jacAindex = data.m_jacobians.size();
  data.m_jacobians.resize(row.m_jacAindex + count);
  data.m_deltaVelocitiesUnitImpulse.resize(row.m_jacAindex + count);
  for (auto* values : {&data.m_jacobians, &data.m_deltaVelocitiesUnitImpulse})
    std::copy_n(&(*values)[from], count, &(*values)[row.m_jacAindex]);
}

double JointRows::speed_along(const double* jacobian) const {
  return std::inner_product(jacobian, jacobian + m_jacSizeA, m_bodyA->getVelocityVector(), 0.0);
}

}  // namespace lf::world
