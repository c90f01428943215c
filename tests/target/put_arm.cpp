#include <array>

#include "firmware/arm/inverse_kinematics.hpp"
#include "firmware/arm/kinematics.hpp"
#include "firmware/arm/trajectory.hpp"
#include "firmware/scan/sweep.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/target/ledger.hpp"
#include "tests/target/same_everywhere.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::test {
namespace {

using arm::JointVector;

// Sines and cosines of glibc and newlib differ by a unit in the last place, 1e-16; on the way to a metre or a radian some ten of them add up.
constexpr double tolerance_m = 1e-14, tolerance_rad = 1e-13;

// Of the rows of a build with room for more.
template <class Rows>
std::array<double, arm5e_joint::of_arm> of_arm(const Rows& rows) {
  std::array<double, arm5e_joint::of_arm> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = rows[i];
  return all;
}

JointVector draw(SameRandom& random, const arm::JointLimits& limits) {
  JointVector q = JointVector::Zero();
  for (int i = 0; i < 4; ++i)
    q[i] = 0.5 * (limits.lower_rad[i] + limits.upper_rad[i]) + 0.5 * random.share() * (limits.upper_rad[i] - limits.lower_rad[i]);
  return q;
}

void put_kinematics(Ledger& ledger) {
  const arm::JointLimits limits = test::arm5e.limits();
  const LaserCalibration laser = nominal_laser();
  SameRandom random(1);
  ledger.operation("forward kinematics", tolerance_m);
  for (int i = 0; i < 100; ++i) {
    const JointVector q = draw(random, limits);
    ledger.pose(ledger.turn([&] { return test::arm5e.base_from_tool(q); }));
  }
  ledger.operation("laser's pose", tolerance_m);
  for (int i = 0; i < 100; ++i) {
    const JointVector q = draw(random, limits);
    ledger.pose(ledger.turn([&] { return test::arm5e.base_from_laser(q, laser); }));
  }
  ledger.operation("Jacobian", tolerance_m);
  for (int i = 0; i < 100; ++i) {
    const JointVector q = draw(random, limits);
    const arm::Jacobian jacobian = ledger.turn([&] { return test::arm5e.jacobian(q); });
    ledger.numbers(jacobian.leftCols<arm5e_joint::of_arm>().reshaped());
  }
}

void put_inverse_kinematics(Ledger& ledger) {
  SameRandom random(2);
  // A box around the reach: a third of it has an answer, the rest a reason.
  ledger.operation("inverse kinematics", tolerance_rad);
  for (int i = 0; i < 300; ++i) {
    const Vec3 tool_m = Vec3(0.45, 0, 0.55) + random.shares().cwiseProduct(Vec3(0.25, 0.4, 0.4));
    const double roll_rad = 3.2 * random.share();
    const arm::IkResult ik = ledger.turn([&] { return arm::inverse_kinematics(test::arm5e, tool_m, roll_rad); });
    ledger.integer(static_cast<std::uint64_t>(ik.outcome));
    if (ik.ok()) ledger.numbers(of_arm(ik.q_rad));
  }
}

void put_motions(Ledger& ledger) {
  const arm::JointLimits limits = test::arm5e.limits(0.05, 0.6);
  SameRandom random(3);
  // A motion's time is a cube root of its way; a line's reach is searched for.
  ledger.operation("joint motion, planned", 1e-13);
  arm::JointTrajectory motion;
  for (int i = 0; i < 30; ++i) {
    const JointVector from = draw(random, limits);
    const JointVector to = draw(random, limits);
    ledger.integer(static_cast<std::uint64_t>(ledger.turn([&] { return motion.plan(from, to, limits); })));
    ledger.number(motion.duration_s());
  }
  ledger.operation("joint motion, a sample", 1e-12);
  for (int i = 0; i < 30; ++i) {
    const arm::JointState state = ledger.turn([&] { return motion.sample(motion.duration_s() * i / 30); });
    ledger.numbers(of_arm(state.q_rad));
    ledger.numbers(of_arm(state.qd_rad_s));
  }

  const arm::IkResult start = arm::inverse_kinematics(test::arm5e, Vec3(0.33, 0.02, 0.58), 0.3);
  ledger.operation("straight line, planned", 1e-12);
  arm::CartesianLine line;
  for (int i = 0; i < 10; ++i) {
    const Vec3 goal_m = Vec3(0.40, 0, 0.58) + random.shares().cwiseProduct(Vec3(0.02, 0.05, 0.03));
    const arm::LinePlan plan = ledger.turn([&] { return line.plan(test::arm5e, start.q_rad, goal_m, 0.5, {}, limits); });
    ledger.integer(static_cast<std::uint64_t>(plan.outcome));
    ledger.number(plan.speed_m_s);
    ledger.number(line.duration_s());
  }
  ledger.operation("straight line, a sample", 1e-11);
  for (int i = 0; i < 30; ++i) {
    const arm::JointState state = ledger.turn([&] { return line.sample(line.duration_s() * i / 30); });
    ledger.numbers(of_arm(state.q_rad));
    ledger.numbers(of_arm(state.qd_rad_s));
  }
}

void put_sweep(Ledger& ledger) {
  scan::SweepRequest request;
  request.base_from_panel = PanelLayout{}.nominal_base_from_panel();
  (void)request.handles.push_back({});
  const LaserCalibration laser = nominal_laser();
  // Ends are found by bisection to 1e-9 rad.
  ledger.operation("sweep, planned", 1e-8);
  const scan::SweepPlan plan = ledger.turn([&] { return scan::plan_sweep(test::arm5e, request, laser); });
  ledger.integer(static_cast<std::uint64_t>(plan.outcome));
  ledger.numbers(of_arm(plan.start_rad));
  ledger.numbers(of_arm(plan.end_rad));
  ledger.numbers(of_arm(plan.speed_rad_s));
  ledger.number(plan.duration.s());
  ledger.number(plan.widest_spacing_m);
}

}  // namespace

void put_arm(Ledger& ledger) {
  put_kinematics(ledger);
  put_inverse_kinematics(ledger);
  put_motions(ledger);
  put_sweep(ledger);
}

}  // namespace lf::test
