// Bullet's sequential-impulse solver for a world of small fixed-base mechanisms. Internal to this folder.
//
// Same rows and same order as btMultiBodyConstraintSolver's, with its iterations written anew: each row is copied once into fixed-size vectors without the six
// coordinates of a base that does not move, and the iterations end when no row changes a speed any more. Steps with a gripped handle take half the time
// (81 to 50 us, 21 Nov 2026). Friction is projected radially onto its cone.
//
// Bullet turns penetration into speed, which the bodies keep: a collision at v would rebound at up to 0.2 v. Here that speed is at most `push_out_m_s`
// down to the depth of a blow at `blow_m_s`; what lies deeper, as pads that are pressed into a turning bar faster than the iterations keep them out
// (1.2 mm/s), is pushed out within `recovery_s`.
//
// Bullet applies restitution to the speed that the step's forces have already changed, so that what is pressed bounces in every step. Here a contact
// rebounds at the restitution times the speed at which it closed before the step, from `bounce_m_s` on, or at the speed that takes it out of its overlap,
// whichever is more. Friction is that of the two shapes that touch; Bullet has one value a body.
//
// Only for worlds whose multibodies have fixed bases and at most `max_joints` joints, and whose rigid bodies do not move.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <Eigen/Core>
#include <vector>

#include "shared/messages/capacity.hpp"

namespace lf::world {

class FixedBaseSolver : public btMultiBodyConstraintSolver {
 public:
  static constexpr int max_joints = capacity::arm_joints + 2;  // the arm's, and a finger each
  static constexpr double push_out_m_s = 0.0005;               // out of 0.2 mm, a step's depth of a blow at 0.2 m/s, in 0.4 s
  static constexpr double blow_m_s = 0.5;
  static constexpr double recovery_s = 0.05;
  static constexpr double bounce_m_s = 0.01;

  explicit FixedBaseSolver(double restitution) : restitution_(restitution) {}

  // Before each step: the speeds of `world` are those at which its contacts close.
  void begin_step(btMultiBodyDynamicsWorld& world);

 protected:
  btScalar solveGroupCacheFriendlySetup(btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds, int manifold_count,
                                        btTypedConstraint** constraints, int constraint_count, const btContactSolverInfo& info,
                                        btIDebugDraw* drawer) override;
  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
                                int manifold_count, btTypedConstraint** constraints, int constraint_count, const btContactSolverInfo& info,
                                btIDebugDraw* drawer) override;
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count, const btContactSolverInfo& info) override;

 private:
  using Joints = Eigen::Matrix<double, max_joints, 1>;

  // One mechanism's part in a row: its jacobian and what a unit impulse does to its joints' speeds.
  struct Side {
    double speed(const Joints& speeds) const { return only_joint >= 0 ? jacobian[only_joint] * speeds[only_joint] : jacobian.dot(speeds); }
    void push(Joints& speeds, double impulse) const;

    int mechanism = -1;   // index of its speeds; -1 none
    int joints = 0;       // that it has
    int only_joint = -1;  // the one that the row is about; -1 if more than one
    Joints jacobian = Joints::Zero();
    Joints response = Joints::Zero();
  };

  struct Row {
    Side a, b;
    double inverse_mass = 0;  // of the row: impulse that changes its speed by 1
    double rhs = 0, cfm = 0;
    double lower = 0, upper = 0;
    double applied = 0;
    double friction = 0;
    int normal_row = 0;  // friction rows: the contact they belong to
  };

  // A mechanism's speeds before the step.
  struct Before {
    const btMultiBody* body = nullptr;
    Joints speeds = Joints::Zero();
  };

  void prepare(btPersistentManifold& manifold, const btContactSolverInfo& info) const;
  double speed_before(const btMultiBody* body, int jacobian_index) const;
  void add_rebounds(const btContactSolverInfo& info);
  void take_rows();
  void take(const btMultiBodyConstraintArray& from, std::vector<Row>& to);
  Side side(const btMultiBody* body, int speeds_index, int jacobian_index);
  double wanted_impulse(const Row& row) const;
  double apply(Row& row, double impulse);
  double solve(Row& row);
  double solve_friction(Row& first, Row& second);
  void give_back(const std::vector<Row>& from, btMultiBodyConstraintArray& to);

  double restitution_;
  std::vector<Before> before_;  // empty without restitution
  std::vector<Row> joints_, normals_, frictions_;
  std::vector<const btMultiBody*> mechanisms_;
  std::vector<Joints> speeds_;  // what the impulses have changed so far
};

}  // namespace lf::world
