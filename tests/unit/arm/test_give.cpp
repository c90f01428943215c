// What arms give way by and how hard they press, against forward kinematics alone: levers by differences, a stop stepped through in time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "firmware/arm/give.hpp"
#include "firmware/arm/trajectory.hpp"
#include "tests/unit/arm/arm_of_file.hpp"

namespace lf::arm {
namespace {

class Give : public ArmOfFile {
 protected:
  double along(const JointVector& q, const Vec3& way) const { return way.dot(arm.base_from_tool(q).translation()); }

  // How far the tool goes along `way` for a radian of each joint.
  JointVector levers(const JointVector& q, const Vec3& way) const {
    constexpr double step_rad = 1e-5;
    JointVector levers = JointVector::Zero();
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(arm.arm_joints()); ++i) {
      const JointVector step = step_rad * JointVector::Unit(i);
      levers[i] = (along(q + step, way) - along(q - step, way)) / (2 * step_rad);
    }
    return levers;
  }
};

// A newton at the tool turns each joint by its lever over its stiffness.
TEST_P(Give, IsWhatTheJointsGiveWayBy) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (int k = 0; k < 200; ++k) {
    const JointVector q = draw();
    const Vec3 way = direction();
    const JointVector lever_m = levers(q, way);
    double gives_m_n = 0;
    for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
      const double lever = lever_m[static_cast<Eigen::Index>(i)];
      gives_m_n += lever * lever / stiffness_nm_rad(description, i);
    }
    ASSERT_NEAR(tool_stiffness_n_m(arm, q, way) * gives_m_n, 1, 1e-6);
  }
}

// A joint's torque is force times lever: the first to reach its threshold feels it.
TEST_P(Give, IsFeltByTheFirstJointWhoseTorqueRisesAsFar) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (int k = 0; k < 200; ++k) {
    const JointVector q = draw();
    const Vec3 way = direction();
    const JointVector lever_m = levers(q, way);
    JointVector torques_nm = JointVector::Zero();
    for (std::size_t i = 0; i < arm.arm_joints(); ++i) torques_nm[static_cast<Eigen::Index>(i)] = uniform(5, 30);
    const double felt_n = least_felt_n(arm, q, way, torques_nm);
    double furthest = 0;
    for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
      const auto joint = static_cast<Eigen::Index>(i);
      furthest = std::max(furthest, felt_n * std::abs(lever_m[joint]) / torques_nm[joint]);
    }
    ASSERT_NEAR(furthest, 1, 1e-6) << k;
  }
  EXPECT_EQ(least_felt_n(arm, draw(), Vec3::Zero(), JointVector::Ones()), std::numeric_limits<double>::infinity());
}

// Something hard is met: 40 ms at full speed, then each joint brakes, all of it wound up into the arm.
TEST_P(Give, AnArmAtTheGentleSpeedPressesThatHardAndNoHarder) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  constexpr double step_s = 1e-4, push_n = 65;
  int judged = 0;
  const JointLimits limits = arm.limits();
  for (int k = 0; k < 100; ++k) {
    const JointVector q = draw();
    const Vec3 way = direction();
    JointVector rates = JointVector::Zero();
    for (std::size_t i = 0; i < arm.arm_joints(); ++i) rates[static_cast<Eigen::Index>(i)] = uniform(-3, 3);
    const JointVector lever_m = levers(q, way);
    rates /= std::max(0.2, std::abs(lever_m.dot(rates)));
    const double speed = gentle_speed_m_s(arm, q, rates, way, limits, push_n);
    ASSERT_GE(speed, 0.002);
    if (speed == 0.002) continue;  // no line creeps, however hard it presses
    ++judged;
    JointVector rad_s = speed * rates;
    double way_m = 0.04 * speed;
    while (rad_s.cwiseAbs().maxCoeff() > 0) {
      for (Eigen::Index i = 0; i < rad_s.size(); ++i) {
        const double slower = std::copysign(std::max(0.0, std::abs(rad_s[i]) - step_s * limits.acceleration_rad_s2[i]), rad_s[i]);
        way_m += std::abs(lever_m[i] * (rad_s[i] + slower) / 2) * step_s;
        rad_s[i] = slower == 0 ? 0 : slower;
      }
    }
    ASSERT_NEAR(way_m * tool_stiffness_n_m(arm, q, way), push_n, 0.02 * push_n);
  }
  EXPECT_GT(judged, 80);
}

TEST_P(Give, ALineGoesNoFasterThanThatAndStillArrives) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const JointLimits limits = arm.limits();
  int slowed = 0;
  for (int k = 0; k < 300; ++k) {
    const JointVector start = draw();
    const Vec3 from = arm.base_from_tool(start).translation(), to = from + 0.06 * direction();
    LineLimits hasty, gentle;
    gentle.push_n = 65;
    CartesianLine fast, slow;
    const double roll_rad = arm.roll_rad(start);
    const LinePlan hasty_plan = fast.plan(arm, start, to, roll_rad, hasty, limits);
    const LinePlan gentle_plan = slow.plan(arm, start, to, roll_rad, gentle, limits);
    ASSERT_EQ(gentle_plan.outcome, hasty_plan.outcome) << "a line that is slow is not refused";
    if (gentle_plan.outcome != PlanOutcome::ok) continue;
    ASSERT_LE(gentle_plan.speed_m_s, hasty_plan.speed_m_s * (1 + 1e-9));
    slowed += gentle_plan.speed_m_s < 0.99 * hasty_plan.speed_m_s ? 1 : 0;
    const Vec3 way = (to - from).normalized();
    for (int i = 0; i <= 20; ++i) {
      const JointState s = slow.sample(slow.duration_s() * i / 20);
      const double speed = (arm.jacobian(s.q_rad).topRows<3>() * s.qd_rad_s).norm();
      if (speed < 1e-3) continue;
      ASSERT_LE(speed, 1.05 * gentle_speed_m_s(arm, s.q_rad, s.qd_rad_s / speed, way, limits, gentle.push_n));
    }
    ASSERT_LT((arm.base_from_tool(slow.sample(1e9).q_rad).translation() - to).norm(), 1e-8);
  }
  EXPECT_GT(slowed, 20);
}

INSTANTIATE_TEST_SUITE_P(Arms, Give,
                         testing::Values("shared/arm/arm5e.urdf", "shared/arm/oberon7/oberon7.urdf", "shared/arm/predator/predator.urdf",
                                         "shared/arm/ur5/ur5.urdf"),
                         [](const auto& file) {
                           std::string name = file.param;
                           name = name.substr(name.rfind('/') + 1);
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace lf::arm
