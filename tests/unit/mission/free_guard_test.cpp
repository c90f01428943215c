// What the arm takes for a contact where nothing may be touched, and what for a drive that does not do as told.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware/mission/workbench.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::mission {
namespace {

safety::Limits limits_of(double torque_nm) {
  safety::Limits limits;
  limits.max_contact_torque_nm = 25;
  arm5e_joint::fill(limits.joints, safety::JointLimit{0, 0, 0, torque_nm});
  return limits;
}

// Feeds the elbow's torque for `seconds`, and rises by `nm_s` meanwhile. True once it is a contact.
bool touches(arm::GuardedMotion& guard, double& t_s, double& nm, double nm_s, double seconds) {
  for (int i = 0; i < int(seconds * 250); ++i) {
    t_s += 0.004;
    nm += 0.004 * nm_s;
    arm::JointVector torque_nm = arm::JointVector::Zero();
    torque_nm[2] = nm;
    guard.update(Time::from_s(t_s), arm::JointVector::Zero(), arm::JointVector::Zero(), arm::JointVector::Zero(), torque_nm);
    if (guard.touched()) return true;
  }
  return false;
}

// The baseline follows a load that rises slowly: an arm that something pushes and that wedges itself was never in contact.
TEST(FreeMotionGuard, ALoadThatRisesSlowlyIsAContactInTheEnd) {
  arm::GuardedMotion guard(free_motion_guard(test::arm5e, limits_of(26)));
  double t_s = 0, nm = -7;
  EXPECT_FALSE(touches(guard, t_s, nm, 0, 0.5));
  EXPECT_FALSE(touches(guard, t_s, nm, 5, 5)) << nm;
  EXPECT_NEAR(nm, 18, 0.1);
  EXPECT_TRUE(touches(guard, t_s, nm, 5, 0.2));
  EXPECT_LT(nm, 0.75 * 26);
}

TEST(FreeMotionGuard, ARiseByHalfOfTheLimitIsAContact) {
  for (const double limit_nm : {10.0, 26.0, 100.0}) {
    arm::GuardedMotion guard(free_motion_guard(test::arm5e, limits_of(limit_nm)));
    double t_s = 0, nm = 0;
    EXPECT_FALSE(touches(guard, t_s, nm, 0, 0.5));
    const double rise_nm = std::min(25.0, 0.5 * limit_nm);
    nm = 0.95 * rise_nm;
    EXPECT_FALSE(touches(guard, t_s, nm, 0, 0.1)) << limit_nm;
    nm = 1.2 * rise_nm;
    EXPECT_TRUE(touches(guard, t_s, nm, 0, 0.1)) << limit_nm;
  }
}

// A press: the elbow's set-point stands still, the joint is `error_rad` behind it, and the motor pushes with `nm`.
arm::GuardedMotion pressed(double error_rad, double nm) {
  arm::GuardConfig config(4);
  config.contact_torque_nm.setConstant(7);
  arm::GuardedMotion guard(config);
  double t_s = 0, free_nm = 0;
  EXPECT_FALSE(touches(guard, t_s, free_nm, 0, 0.5));
  arm::JointVector command_rad = arm::JointVector::Zero(), torque_nm = arm::JointVector::Zero();
  command_rad[2] = error_rad;
  torque_nm[2] = nm;
  for (int i = 0; i < 25; ++i)
    guard.update(Time::from_s(t_s += 0.004), command_rad, arm::JointVector::Zero(), arm::JointVector::Zero(), torque_nm);
  EXPECT_TRUE(guard.touched());
  return guard;
}

TEST(RunsOff, IsADriveThatPushesItsJointAwayFromTheSetPoint) {
  for (const double way : {-1.0, 1.0}) {
    EXPECT_TRUE(runs_off(pressed(way * 0.01, way * -10)));
    EXPECT_FALSE(runs_off(pressed(way * 0.01, way * 10))) << "something holds the joint back, or pushes it ahead: the drive resists";
    EXPECT_FALSE(runs_off(pressed(way * 0.003, way * -10))) << "no further than a joint lags";
    EXPECT_FALSE(runs_off(pressed(way * 0.05, way * -10))) << "told by its lag already";
  }
}

// The elbow on its way at `asked_rad_s`, going `rad_s` itself, its motor pushing with `nm`: what the guard shows once it has taken that for a touch.
arm::GuardedMotion moving(double asked_rad_s, double rad_s, double nm) {
  arm::GuardConfig config(4);
  config.contact_torque_nm.setConstant(7);
  arm::GuardedMotion guard(config);
  arm::JointVector command_rad = arm::JointVector::Zero(), position_rad = command_rad, velocity_rad_s = command_rad,
                   torque_nm = command_rad;
  constexpr double period_s = 0.004;
  double t_s = 0;
  for (int i = 0; i < 100 && !guard.touched(); ++i) {
    const bool learned = i >= 50;
    velocity_rad_s[2] = learned ? rad_s : asked_rad_s;
    torque_nm[2] = learned ? nm : 0;
    command_rad[2] += asked_rad_s * period_s;
    position_rad[2] += velocity_rad_s[2] * period_s;
    guard.update(Time::from_s(t_s += period_s), command_rad, position_rad, velocity_rad_s, torque_nm);
  }
  EXPECT_TRUE(guard.touched());
  return guard;
}

TEST(DrivesItselfOff, IsAMotorThatMovesItsJointOtherwiseThanAsked) {
  for (const double way : {-1.0, 1.0}) {
    EXPECT_TRUE(drives_itself_off(test::arm5e, moving(0, way * 0.05, way * 10))) << "it stands by its set-point";
    EXPECT_TRUE(drives_itself_off(test::arm5e, moving(way * 0.05, way * 0.15, way * 10))) << "faster than asked, by its own torque";
    EXPECT_TRUE(drives_itself_off(test::arm5e, moving(way * 0.05, way * -0.05, way * -10))) << "back, by its own torque";
    EXPECT_FALSE(drives_itself_off(test::arm5e, moving(way * 0.05, 0, way * 10))) << "something holds it, and the motor pushes on";
    EXPECT_FALSE(drives_itself_off(test::arm5e, moving(way * 0.05, way * -0.05, way * 10))) << "something pushes it back";
    EXPECT_FALSE(drives_itself_off(test::arm5e, moving(way * 0.05, way * 0.09, way * -10))) << "something pushes it ahead";
    EXPECT_FALSE(drives_itself_off(test::arm5e, moving(0, way * 0.01, way * 10))) << "no more than the observer's noise";
  }
}

TEST(DrivesItselfOff, IsAJointThatLeavesItsSetPointAtASpeedToWhichNothingPushesAScrew) {
  for (const double way : {-1.0, 1.0}) {
    EXPECT_TRUE(drives_itself_off(test::arm5e, moving(0, way * 0.3, way * -10)));
    EXPECT_FALSE(drives_itself_off(test::arm5e, moving(0, way * 0.08, way * -10)));
  }
}

// A guard that has met a contact with the elbow at 1.2 rad, on its way at `rad_s`. The motor goes on against a spring of `stiffness_nm_rad`, or stands
// where it was while its torque rises by `winds_nm_s`.
arm::GuardedMotion met(double rad_s, double stiffness_nm_rad, double winds_nm_s) {
  arm::GuardedMotion guard(free_motion_guard(test::arm5e, limits_of(25)));
  constexpr double period_s = 0.004, count_rad = 2.2e-4;
  arm::JointVector command_rad = arm::JointVector::Zero(), position_rad = command_rad, velocity_rad_s = command_rad,
                   torque_nm = command_rad;
  command_rad[2] = 1.2;
  double motor_rad = 1.2, t_s = 0;
  for (int i = 0; i < 2000 && !guard.touched(); ++i) {
    const bool seized = winds_nm_s > 0, met = i >= 50;
    command_rad[2] += rad_s * period_s;
    if (!met || !seized) motor_rad += rad_s * period_s;
    if (met) torque_nm[2] += seized ? winds_nm_s * period_s : stiffness_nm_rad * rad_s * period_s;
    position_rad[2] = count_rad * std::floor(motor_rad / count_rad);
    guard.update(Time::from_s(t_s += period_s), command_rad, position_rad, velocity_rad_s, torque_nm);
  }
  EXPECT_TRUE(guard.touched());
  return guard;
}

TEST(HasSeized, IsAMotorThatStandsWhileItsTorqueRises) {
  for (const double rad_s : {0.01, 0.05, 0.3}) {
    SCOPED_TRACE(rad_s);
    // A controller that asks for more speed winds up faster: at 0.06 rad/s to 30 N m in 50 ms.
    EXPECT_TRUE(has_seized(test::arm5e, met(rad_s, 0, 600 * rad_s / 0.06)));
    EXPECT_TRUE(does_not_follow(test::arm5e, met(rad_s, 0, 600 * rad_s / 0.06)));
    // One whose speed loop is slow lags by more than the guard allows before it has wound up: its torque is 5 N m then.
    if (rad_s == 0.3) {
      const arm::GuardedMotion slow = met(rad_s, 0, 50);
      ASSERT_EQ(slow.cause(), arm::GuardCause::following_error);
      ASSERT_FALSE(lags_without_load(test::arm5e, slow));
      EXPECT_TRUE(does_not_follow(test::arm5e, slow));
    }
    for (const double stiffness_nm_rad : {1500.0, 4000.0})
      EXPECT_FALSE(has_seized(test::arm5e, met(rad_s, stiffness_nm_rad, 0))) << stiffness_nm_rad;
  }
}

// A roll is told to go by one count, 3.1 mrad, and its torque rises at once: the count shows before a gear has wound itself up by so much.
TEST(HasSeized, IsARollThatShowsNotOneCountOfItsWay) {
  constexpr double count_rad = 3.14e-3;
  const auto met = [](int told_counts, int shown_counts, double nm) {
    arm::GuardedMotion guard(free_motion_guard(test::arm5e, limits_of(3)));
    double t_s = 0;
    arm::JointVector command_rad = arm::JointVector::Zero(), position_rad = command_rad, torque_nm = command_rad;
    for (int i = 0; i < 100 && !guard.touched(); ++i) {
      if (i >= 50) {
        command_rad[3] = told_counts * count_rad;
        position_rad[3] = shown_counts * count_rad;
        torque_nm[3] = nm;
      }
      guard.update(Time::from_s(t_s += 0.004), command_rad, position_rad, arm::JointVector::Zero(), torque_nm);
    }
    EXPECT_TRUE(guard.touched());
    return has_seized(test::arm5e, guard);
  };
  for (const int way : {-1, 1}) {
    EXPECT_TRUE(met(way, 0, way * 6));
    EXPECT_FALSE(met(way, 0, way * -6)) << "pushed on";
    EXPECT_FALSE(met(way, way, way * 6)) << "it went, and met something";
    EXPECT_FALSE(met(0, 0, way * 6)) << "it was to stay";
  }
}

// A guard begins while the shoulder's motor gives -28 N m. What comes later is a contact, and so is a load on a joint that stands where it is told to.
TEST(WasBehindBefore, IsAJointThatWasOverloadedAndDidNotFollow) {
  const auto met = [](double behind_rad, double from_nm, double nm) {
    arm::GuardedMotion guard(free_motion_guard(test::arm5e, limits_of(25)));
    double t_s = 0;
    arm::JointVector command_rad = arm::JointVector::Zero(), position_rad = command_rad, torque_nm = command_rad;
    command_rad[1] = position_rad[1] = 1.0;
    position_rad[1] -= behind_rad;
    for (int i = 0; i < 100 && !guard.touched(); ++i) {
      torque_nm[1] = i < 50 ? from_nm : nm;
      guard.update(Time::from_s(t_s += 0.004), command_rad, position_rad, arm::JointVector::Zero(), torque_nm);
    }
    EXPECT_TRUE(guard.touched());
    return was_behind_before(test::arm5e, guard);
  };
  EXPECT_TRUE(met(-0.0005, -28, -28));
  EXPECT_TRUE(met(0.0005, 28, 28));
  EXPECT_FALSE(met(0.0005, -28, -28)) << "pushed on towards its target";
  EXPECT_FALSE(met(-0.0001, -28, -28)) << "it stands where it is told to";
  EXPECT_FALSE(met(-0.0005, 0, -28)) << "it came later";
}

// Somebody leans on an arm that stands.
TEST(HasSeized, IsNoMotorThatHoldsWhatPushesAtIt) {
  arm::GuardedMotion guard(free_motion_guard(test::arm5e, limits_of(25)));
  double t_s = 0, nm = 0;
  ASSERT_FALSE(touches(guard, t_s, nm, 0, 1));
  ASSERT_TRUE(touches(guard, t_s, nm, 40, 1));
  EXPECT_FALSE(has_seized(test::arm5e, guard));
}

TEST(DrivesItselfOff, CountsAsAJointThatDoesNotFollow) { EXPECT_TRUE(does_not_follow(test::arm5e, moving(0.05, -0.05, -10))); }

}  // namespace
}  // namespace lf::mission
