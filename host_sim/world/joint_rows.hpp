// Velocity constraints on one joint of a multibody, or on two coupled ones, set anew each step: drives, friction, stops. Internal to this folder.
//
// Each row asks the joint for a speed and may spend an impulse between two bounds to reach it. Bullet's own joint motor has one symmetric bound and its
// limit sees a stop only once it is passed. The rows start from the impulse of the step before (applied as a joint torque, the bounds moved by as much), which
// is what lets 20 to 50 iterations find the balance of friction and a slow contact on a light joint: from zero, each iteration adds only inertia x speed.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>

#include <array>
#include <cstddef>

namespace lf::world {

class JointRows : public btMultiBodyConstraint {
 public:
  // Rows have fixed slots, so that each finds its own impulse of the step before.
  static constexpr std::size_t slot_count = 6;

  struct Row {
    double speed = 0;                         // rad/s or m/s
    double impulse_min = 0, impulse_max = 0;  // N m s or N s
    double first = 1, second = 0;             // the row's coordinate: first x joint + second x second joint
    double softness = 0;                      // the joint gives way by softness x impulse: the row holds speed + softness x impulse
  };

  // A damper: torque against the coordinate's speed at the step's end, so that any coefficient is stable on any inertia.
  static Row damper(double nm_s, double step_s);

  // `second_link` -1: there is none.
  JointRows(btMultiBody* body, int link, int second_link = -1);

  // Between two steps: forgets the rows, keeping what they applied.
  void begin();
  void set(std::size_t slot, const Row& row);
  // After all rows are set: applies the starting impulses. `step_s` is the length of the coming step.
  void apply_start(double step_s);
  // Of the last step, both parts.
  double impulse(std::size_t slot) const;

  void finalizeMultiDof() override;
  int getIslandIdA() const override;
  int getIslandIdB() const override { return -1; }
  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data, const btContactSolverInfo& info) override;
  void debugDraw(btIDebugDraw*) override {}

 private:
  struct Slot {
    Row row;
    bool used = false;
    double start = 0;
  };
  void repeat(btMultiBodySolverConstraint& row, btMultiBodyJacobianData& data) const;
  double speed_along(const double* jacobian) const;

  int second_link_;
  std::array<Slot, slot_count> slots_;
};

}  // namespace lf::world
