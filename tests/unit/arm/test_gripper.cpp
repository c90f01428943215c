#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "firmware/arm/gripper.hpp"
#include "firmware/arm/kinematics.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::arm {
namespace {

// A jaw on a stiff position loop, and what stands between and outside of its pads.
struct Jaw {
  double q_rad = 0.5;
  double stop_closing_rad = -1;  // a bar between the pads: no further closing
  double stop_opening_rad = 9;
  double torque_limit_nm = 20;

  double step(double target_rad) {
    const double wanted = std::clamp(target_rad, stop_closing_rad, stop_opening_rad);
    q_rad += std::clamp(wanted - q_rad, -0.002, 0.002);  // 0.5 rad/s at 250 Hz
    const bool blocked = (q_rad == stop_closing_rad && target_rad < q_rad) || (q_rad == stop_opening_rad && target_rad > q_rad);
    return std::clamp(blocked ? 1000 * (target_rad - q_rad) : 0.0, -torque_limit_nm, torque_limit_nm);
  }
};

class GripperRun {
 public:
  Gripper gripper{test::jaw5e};
  Jaw jaw;
  double widest_lead_rad = 0;

  GripperState run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / 0.004); ++i) {
      t_ = t_ + Duration::from_ms(4);
      const double target = gripper.update(t_, jaw.q_rad, torque_);
      widest_lead_rad = std::max(widest_lead_rad, std::abs(target - jaw.q_rad));
      torque_ = jaw.step(target);
    }
    return gripper.state();
  }
  Time now() const { return t_; }

 private:
  Time t_;
  double torque_ = 0;
};

// The numbers of a jaw are shares of what it can: those of the default machine are the defaults.
TEST(GripperConfig, OfTheDefaultJawIsTheDefault) {
  const GripperConfig ours = gripper_config(test::arm5e.joint(arm5e_joint::jaw)), usual;
  EXPECT_NEAR(ours.grip_torque_nm, usual.grip_torque_nm, 1e-12);
  EXPECT_NEAR(ours.hold_torque_nm, usual.hold_torque_nm, 1e-12);
  EXPECT_NEAR(ours.closing_speed_rad_s, usual.closing_speed_rad_s, 1e-12);
  EXPECT_NEAR(ours.opening_speed_rad_s, usual.opening_speed_rad_s, 1e-12);
  EXPECT_NEAR(ours.ramp_rad_s2, usual.ramp_rad_s2, 1e-12);
  EXPECT_NEAR(ours.stall_rad, usual.stall_rad, 1e-12);
  EXPECT_EQ(ours.move_timeout, usual.move_timeout);
  EXPECT_NEAR(thinnest_bar_m(test::jaw5e), thinnest_bar_of_any_m, 1e-12);
}

TEST(GripperConfig, OfAnotherJawFollowsIt) {
  ArmModel::Joint slow = test::arm5e.joint(arm5e_joint::jaw);
  slow.effort_nm = 5;
  slow.velocity_rad_s = 0.1;
  slow.actuator.counts_per_rad = 200;
  const GripperConfig config = gripper_config(slow);
  EXPECT_LT(config.grip_torque_nm, slow.effort_nm) << "it can be believed to hold";
  EXPECT_LT(config.closing_speed_rad_s, slow.velocity_rad_s);
  EXPECT_GT(config.move_timeout.s(), (slow.upper_rad - slow.lower_rad) / config.closing_speed_rad_s) << "and has the time to close";
  EXPECT_GT(config.stall_rad, 3.0 / 200) << "a count is no motion";
  ArmModel::Jaw wide = test::jaw5e;
  wide.face_x_m -= 0.005;  // each pad 5 mm farther out: closed, they stand 10 mm apart
  EXPECT_GT(thinnest_bar_m(wide), gap_from_jaw(wide, wide.lower_rad) + GripperConfig().bar_tolerance_m);
}

TEST(JawOpening, LeavesTheSameRoomBesideABarOfAnyThickness) {
  for (const double bar_m : {thinnest_bar_of_any_m, 0.0126, 0.022, 0.050}) {
    const double room_m = (jaw_opening_m(test::jaw5e, bar_m) - bar_m) / 2;
    EXPECT_NEAR(room_m, 0.024, 1e-12) << bar_m;
    EXPECT_NEAR(gap_from_jaw(test::jaw5e, jaw_from_gap(test::jaw5e, jaw_opening_m(test::jaw5e, bar_m))), jaw_opening_m(test::jaw5e, bar_m),
                1e-9)
        << "within the jaw's stroke";
  }
  EXPECT_NEAR(jaw_opening_m(test::jaw5e, thickest_bar_m(test::jaw5e)), gap_from_jaw(test::jaw5e, 1.3377), 1e-9);
  EXPECT_LE(jaw_opening_m(test::jaw5e, 1), gap_from_jaw(test::jaw5e, 1.3377)) << "no further than the jaw opens";
  EXPECT_GT(thinnest_bar_of_any_m, gap_from_jaw(test::jaw5e, -0.05816) + 0.004) << "told from a closed jaw";
}

// The pads of the URDF's fingers, corner by corner in the wrist's frame.
TEST(JawGeometry, GapIsTheDistanceBetweenThePadsOfTheUrdf) {
  for (const double q : {-0.05, 0.0, 0.1, 0.4, 0.9, 1.3}) {
    const LinkPoses links = test::arm5e.base_from_links(JointVector::Zero(), q);
    const Pose wrist_from_a = links[3].inverse() * links[4], wrist_from_b = links[3].inverse() * links[5];
    // Pad of 8 x 40 x 30 mm at (29.7, 0, 98.5) mm: its inner face.
    const double face_a = (wrist_from_a * Vec3(0.0337, 0, 0.0985)).x(), face_b = (wrist_from_b * Vec3(-0.0337, 0, 0.0985)).x();
    EXPECT_NEAR(gap_from_jaw(test::jaw5e, q), face_b - face_a, 1e-12);
    EXPECT_NEAR(jaw_from_gap(test::jaw5e, gap_from_jaw(test::jaw5e, q)), q, 1e-9);
    double tip = 0;
    for (const double x : {0.0, 0.0337}) tip = std::max(tip, (wrist_from_a * Vec3(x, 0, 0.1135)).z());
    EXPECT_NEAR(tip_beyond_tool_m(test::jaw5e, q), tip - 0.1485, 1e-12);
  }
}

TEST(JawGeometry, PadsAreParallelAndCentredOnABarOf12Point6Millimetres) {
  EXPECT_NEAR(gap_from_jaw(test::jaw5e, 0), 0.0126, 1e-12);
  EXPECT_NEAR(jaw_from_gap(test::jaw5e, 0.0126), 0, 1e-12);
  const LinkPoses links = test::arm5e.base_from_links(JointVector::Zero(), 0);
  EXPECT_LT((links[4].linear() - links[3].linear()).norm(), 1e-12);
  EXPECT_LT((links[5].linear() - links[3].linear()).norm(), 1e-12);
  EXPECT_GT(gap_from_jaw(test::jaw5e, jaw_from_gap(test::jaw5e, 0.10)), 0.0999);
}

// 3 N m at the handle need 3 N m / 40 mm = 75 N on each of two pads 40 mm wide, their pressure moved to the edges.
TEST(JawGeometry, PeakTorqueHoldsThreeNewtonMetres) {
  const double force = pad_force_n(test::jaw5e, test::arm5e.model().joints[4].effort_nm);
  EXPECT_GT(force * test::jaw5e.pad_width_m, 3.0 * 1.2);
}

TEST(Gripper, HoldsABar) {
  GripperRun run;
  run.jaw.stop_closing_rad = 0.0;
  run.gripper.close();
  EXPECT_EQ(run.run(1), GripperState::closing);
  EXPECT_EQ(run.run(3), GripperState::held);
  EXPECT_NEAR(run.gripper.grip_gap_m(), 0.0126, 1e-6);
  EXPECT_EQ(run.run(20), GripperState::held);
  EXPECT_LT(run.gripper.target_rad(), run.jaw.q_rad) << "it squeezes";
  EXPECT_LE(run.widest_lead_rad, GripperConfig().lead_rad + 1e-9) << "within the drive's following-error window";
}

TEST(Gripper, FindsNothingBetweenThePads) {
  GripperRun run;
  run.gripper.close();
  EXPECT_EQ(run.run(5), GripperState::empty);
  GripperRun tips;  // the tips touch before the limit
  tips.jaw.stop_closing_rad = -0.0555;
  tips.gripper.close();
  EXPECT_EQ(tips.run(5), GripperState::empty);
}

TEST(Gripper, IsJammedBySomethingThickerThanTheBar) {
  GripperRun run;
  run.jaw.stop_closing_rad = jaw_from_gap(test::jaw5e, 0.030);
  run.gripper.close();
  EXPECT_EQ(run.run(5), GripperState::jammed);
}

// A hose of 20 mm in a jaw for bars of 40 mm, a cord of 5 mm in one for 12.6 mm: something is there, and the arm would drag it along.
TEST(Gripper, IsJammedBySomethingThinnerThanTheBar) {
  for (const auto& [bar_m, thing_m] : {std::pair(0.040, 0.020), std::pair(0.0126, 0.005), std::pair(0.022, 0.005)}) {
    GripperConfig config;
    config.bar_m = bar_m;
    GripperRun run;
    run.gripper = Gripper(test::jaw5e, config);
    run.jaw.stop_closing_rad = jaw_from_gap(test::jaw5e, thing_m);
    run.gripper.close();
    EXPECT_EQ(run.run(5), GripperState::jammed) << bar_m;
    EXPECT_TRUE(run.gripper.may_hold(run.jaw.q_rad));
  }
}

// An angle beyond either stop is one of a false zero.
TEST(Gripper, MayHoldAnythingWhereItsAngleCannotBe) {
  const Gripper gripper(test::jaw5e);
  for (const double rad : {test::arm5e.model().joints[4].lower_rad - 0.02, test::arm5e.model().joints[4].upper_rad + 0.02})
    EXPECT_TRUE(gripper.may_hold(rad));
}

// Told to open by a hair it ends as open, and has let go of nothing.
TEST(Gripper, StaysInDoubtWhenItsNextOrderMovesItByAHair) {
  GripperRun run;
  run.jaw.stop_closing_rad = jaw_from_gap(test::jaw5e, 0.030);
  run.gripper.close();
  ASSERT_EQ(run.run(5), GripperState::jammed);
  run.gripper.turn_to(run.jaw.q_rad + 0.001);
  ASSERT_EQ(run.run(2), GripperState::open);
  EXPECT_TRUE(run.gripper.doubted());
  run.gripper.turn_to(run.jaw.q_rad + 0.06);
  ASSERT_EQ(run.run(2), GripperState::open);
  EXPECT_FALSE(run.gripper.doubted());
}

// Closed is closed, however thick the bar: a hose of 20 mm in a jaw for bars of 40 mm is something that is held.
TEST(Gripper, MayHoldWhatFitsBetweenClosedAndOpen) {
  const double stop_rad = test::arm5e.model().joints[4].lower_rad;
  for (const double bar_m : {thinnest_bar_of_any_m, 0.0126, 0.040, thickest_bar_m(test::jaw5e)}) {
    GripperConfig config;
    config.bar_m = bar_m;
    const Gripper gripper(test::jaw5e, config);
    EXPECT_FALSE(gripper.may_hold(stop_rad)) << "closed to its stop";
    EXPECT_FALSE(gripper.may_hold(stop_rad + 2 * config.stall_rad)) << "as far as it counts as empty";
    for (const double gap_m : {0.004, 0.005, 0.020, bar_m - 0.004, bar_m, bar_m + 0.040})
      EXPECT_TRUE(gripper.may_hold(jaw_from_gap(test::jaw5e, gap_m))) << bar_m << ", " << gap_m;
    EXPECT_FALSE(gripper.may_hold(jaw_from_gap(test::jaw5e, jaw_opening_m(test::jaw5e, bar_m)))) << bar_m;
    EXPECT_TRUE(gripper.may_hold(std::nan("")));
  }
}

TEST(Gripper, MayHoldWhatItsLastOrderEndedAt) {
  const double open_rad = jaw_from_gap(test::jaw5e, jaw_opening_m(test::jaw5e, GripperConfig().bar_m));
  GripperRun jammed;
  jammed.jaw.stop_closing_rad = jaw_from_gap(test::jaw5e, 0.030);
  jammed.gripper.close();
  ASSERT_EQ(jammed.run(5), GripperState::jammed);
  EXPECT_TRUE(jammed.gripper.may_hold(open_rad)) << "wherever it is said to stand";
  GripperRun dropped;
  dropped.jaw.stop_closing_rad = 0;
  dropped.gripper.close();
  ASSERT_EQ(dropped.run(4), GripperState::held);
  EXPECT_TRUE(dropped.gripper.may_hold(open_rad));
  dropped.jaw.stop_closing_rad = -0.0555;
  ASSERT_EQ(dropped.run(0.5), GripperState::dropped);
  EXPECT_TRUE(dropped.gripper.may_hold(open_rad));
}

// After a reset the gripper is a new one.
TEST(Gripper, IsInDoubtUntilItsJawIsSeenToMove) {
  GripperRun run;
  run.gripper.doubt();
  EXPECT_EQ(run.run(0.1), GripperState::idle);
  EXPECT_TRUE(run.gripper.may_hold(jaw_from_gap(test::jaw5e, jaw_opening_m(test::jaw5e, GripperConfig().bar_m))));
  run.gripper.turn_to(run.jaw.q_rad + 0.04);
  run.run(2);
  EXPECT_TRUE(run.gripper.doubted());
  run.gripper.turn_to(run.jaw.q_rad + 0.02);
  run.run(2);
  EXPECT_FALSE(run.gripper.doubted());
}

// A stop comes while it closes on a pipe, before the stall is told.
TEST(Gripper, IsInDoubtWhereItsClosingWasNotLedToAnEnd) {
  GripperRun run;
  run.gripper.close();
  ASSERT_EQ(run.run(0.3), GripperState::closing);
  EXPECT_TRUE(run.gripper.doubted());
  run.gripper.stay();
  ASSERT_EQ(run.run(0.1), GripperState::idle);
  EXPECT_TRUE(run.gripper.may_hold(run.jaw.q_rad));
  run.gripper.turn_to(run.jaw.q_rad + 0.1);
  run.run(2);
  EXPECT_FALSE(run.gripper.doubted());
  run.gripper.close();
  ASSERT_EQ(run.run(8), GripperState::empty) << "closed to its stop, nothing is between the pads";
  EXPECT_FALSE(run.gripper.doubted());
}

TEST(Gripper, NoticesThatTheBarSlippedOut) {
  GripperRun run;
  run.jaw.stop_closing_rad = 0.0;
  run.gripper.close();
  ASSERT_EQ(run.run(4), GripperState::held);
  run.jaw.stop_closing_rad = -0.0555;
  EXPECT_EQ(run.run(0.5), GripperState::dropped);
}

// Pads that snap shut over a bar that has gone would wedge it away with all the jaw's torque.
TEST(Gripper, LetsGoOfASnapAtOnce) {
  GripperRun run;
  run.jaw.stop_closing_rad = 0.0;
  run.gripper.close();
  ASSERT_EQ(run.run(4), GripperState::held);
  run.jaw.stop_closing_rad = -0.0555;
  while (run.gripper.state() == GripperState::held && run.jaw.q_rad > -0.055) run.run(0.004);
  EXPECT_EQ(run.gripper.state(), GripperState::dropped);
  EXPECT_GT(run.jaw.q_rad, -0.016);
  EXPECT_NEAR(run.gripper.target_rad(), run.jaw.q_rad, 0.0021) << "it still squeezes";
}

// A bar that turns between the pads lets them creep on.
TEST(Gripper, FollowsTheCreepOfItsPads) {
  GripperRun run;
  run.jaw.stop_closing_rad = 0.0;
  run.gripper.close();
  ASSERT_EQ(run.run(4), GripperState::held);
  for (int i = 0; i < 250; ++i) {
    run.jaw.stop_closing_rad -= 0.02 / 250;
    ASSERT_EQ(run.run(0.004), GripperState::held) << run.jaw.q_rad;
  }
}

TEST(Gripper, NoticesThatTheSqueezeIsGone) {
  GripperRun run;
  run.jaw.stop_closing_rad = 0.0;
  run.gripper.close();
  ASSERT_EQ(run.run(4), GripperState::held);
  run.jaw.torque_limit_nm = 0.5;
  EXPECT_EQ(run.run(0.05), GripperState::held) << "a moment without torque is turning, not dropping";
  EXPECT_EQ(run.run(0.2), GripperState::dropped);
}

TEST(Gripper, OpensToAGapAndIsJammedWhenItCannot) {
  GripperRun run;
  run.jaw.q_rad = 0;
  run.gripper.open_to(0.09);
  EXPECT_EQ(run.run(4), GripperState::open);
  EXPECT_NEAR(gap_from_jaw(test::jaw5e, run.jaw.q_rad), 0.09, 0.001);
  run.jaw.stop_closing_rad = 0.0;
  run.gripper.close();
  ASSERT_EQ(run.run(4), GripperState::held);
  run.jaw.stop_opening_rad = run.jaw.q_rad + 0.01;
  run.gripper.open_to(0.09);
  EXPECT_EQ(run.run(2), GripperState::jammed) << "with a load at once, without one after the time-out";
}

// By hand, the other way: whatever is between the fingers is not squeezed until the time-out.
TEST(Gripper, TurnedOntoSomethingStopsThere) {
  GripperRun run;
  run.jaw.q_rad = 0.8;
  run.jaw.stop_closing_rad = 0.4;
  run.gripper.turn_to(0.1);
  ASSERT_EQ(run.run(3), GripperState::jammed);
  EXPECT_NEAR(run.jaw.q_rad, 0.4, 0.01);
  EXPECT_NEAR(run.gripper.target_rad(), run.jaw.q_rad, 1e-9) << "it presses on nothing";
}

TEST(Gripper, TurnsToAnAngleEitherWay) {
  GripperRun run;
  run.gripper.turn_to(0.9);
  EXPECT_EQ(run.run(3), GripperState::open);
  EXPECT_NEAR(run.jaw.q_rad, 0.9, 0.004);
  run.gripper.turn_to(0.2);
  EXPECT_EQ(run.run(3), GripperState::open);
  EXPECT_NEAR(run.jaw.q_rad, 0.2, 0.004);
  run.gripper.turn_to(std::numeric_limits<double>::infinity());
  EXPECT_EQ(run.gripper.state(), GripperState::open);
}

// Whoever orders and asks in the same tick must not take the last movement's end for that of the one to come.
TEST(Gripper, MovesFromTheOrderOn) {
  GripperRun run;
  run.gripper.turn_to(0.6);
  ASSERT_EQ(run.run(3), GripperState::open);
  run.gripper.open_to(0.09);
  EXPECT_EQ(run.gripper.state(), GripperState::opening);
  run.gripper.close();
  EXPECT_EQ(run.gripper.state(), GripperState::closing);
}

TEST(Gripper, DoesNotPressOnWhenItIsJammed) {
  GripperRun run;
  run.jaw.q_rad = 0.3;
  run.jaw.stop_opening_rad = 0.31;
  run.gripper.turn_to(0.9);
  ASSERT_EQ(run.run(10), GripperState::jammed);
  EXPECT_NEAR(run.gripper.target_rad(), run.jaw.q_rad, 1e-9);
}

TEST(Gripper, DoesNotTakeAStallWithLittleTorqueForAGrip) {
  GripperRun run;
  run.jaw.stop_closing_rad = 0.0;
  run.jaw.torque_limit_nm = 3;
  run.gripper.close();
  EXPECT_EQ(run.run(5), GripperState::closing);
  EXPECT_EQ(run.run(5), GripperState::jammed);
}

// The jaw moves, and says that it does not: no torque holds it.
TEST(Gripper, IsLostWhenItReportsTheSameAngleWithoutALoad) {
  for (const bool closing : {true, false}) {
    Gripper gripper{test::jaw5e};
    Time t;
    const auto run = [&](double seconds, double jaw_rad) {
      double target = 0;
      for (const Time end = t + Duration::from_s(seconds); t < end;) {
        t = t + Duration::from_ms(4);
        target = gripper.update(t, jaw_rad, closing ? -0.5 : 0.5);
      }
      return target;
    };
    run(0.1, 0.5);
    closing ? gripper.close() : gripper.open_to(0.1);
    run(0.25, 0.5);
    EXPECT_EQ(gripper.state(), closing ? GripperState::closing : GripperState::opening) << "the target has to run ahead first";
    EXPECT_NEAR(run(0.15, 0.5), 0.5, 1e-12) << "it is not driven on";
    EXPECT_EQ(gripper.state(), GripperState::lost);
    gripper.turn_to(0.6);
    run(0.02, 0.5);
    EXPECT_EQ(gripper.state(), GripperState::opening) << "an order begins anew";
  }
}

// Its drive hears no target any more: told to open, it goes on squeezing.
TEST(Gripper, IsLostWhenItGoesOnPushingTheOtherWay) {
  for (const double squeezing_nm : {-8.0, -2.5}) {
    Gripper gripper{test::jaw5e};
    Time t;
    const auto run = [&](double seconds) {
      for (const Time end = t + Duration::from_s(seconds); t < end;) {
        t = t + Duration::from_ms(4);
        (void)gripper.update(t, 0.1, squeezing_nm);
      }
    };
    run(0.1);
    gripper.open_to(0.1);
    run(1.1);
    EXPECT_EQ(gripper.state(), GripperState::opening) << "a screw that has clamped gets time";
    run(0.3);
    EXPECT_EQ(gripper.state(), GripperState::lost) << squeezing_nm;
  }
}

// Told to open it closes, or the other way round: with fingers in between, before it has gone far.
TEST(Gripper, IsLostWhenItGoesTheOtherWay) {
  for (const double way : {-1.0, 1.0}) {
    Gripper gripper{test::jaw5e};
    Time t;
    double jaw_rad = 0.5;
    (void)gripper.update(t, jaw_rad, 0.0);
    way < 0 ? gripper.turn_to(1.0) : gripper.close();
    int steps = 0;
    for (; steps < 500 && gripper.state() != GripperState::lost; ++steps) {
      t = t + Duration::from_ms(4);
      (void)gripper.update(t, jaw_rad += way * 0.001, 0.0);
    }
    EXPECT_EQ(gripper.state(), GripperState::lost);
    EXPECT_NEAR(jaw_rad, 0.5 + way * 0.05, 0.003);
    EXPECT_NEAR(gripper.target_rad(), jaw_rad, 1e-12);
  }
}

// Its encoder stands still: the drive creeps on, and the fingers come to press on their stop.
TEST(Gripper, IsLostWhenItPressesThoughItIsOpen) {
  for (const double pressing_nm : {-8.0, 8.0}) {
    Gripper gripper{test::jaw5e};
    Time t;
    const auto run = [&](double seconds, double torque_nm) {
      for (const Time end = t + Duration::from_s(seconds); t < end;) {
        t = t + Duration::from_ms(4);
        (void)gripper.update(t, 0.5, torque_nm);
      }
    };
    run(0.1, 0);
    gripper.turn_to(0.5);
    run(0.1, 0);
    ASSERT_EQ(gripper.state(), GripperState::open);
    run(0.25, pressing_nm);
    run(0.05, 0);
    run(0.25, pressing_nm);
    EXPECT_EQ(gripper.state(), GripperState::open) << "a brush of the bar is shorter";
    run(0.1, pressing_nm);
    EXPECT_EQ(gripper.state(), GripperState::lost);
  }
}

TEST(Gripper, StaysWhereItIsUntilOrderedAndRefusesNonsense) {
  GripperRun run;
  run.jaw.q_rad = 0.3;
  EXPECT_EQ(run.run(1), GripperState::idle);
  EXPECT_NEAR(run.gripper.target_rad(), 0.3, 1e-12);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  run.gripper.open_to(nan);
  EXPECT_EQ(run.run(1), GripperState::idle);
  EXPECT_NEAR(run.gripper.update(run.now() + Duration::from_ms(4), nan, 0), 0.3, 1e-12);
  EXPECT_NEAR(run.gripper.update(run.now(), 0.9, 0), 0.3, 1e-12) << "stale";
  EXPECT_EQ(run.gripper.refused(), 2u);
}

TEST(Gripper, BelievesAGripThatTheTorqueSurelyHasAndALossThatItSurelyIs) {
  const GripperConfig config;
  const auto after = [&](const TorqueEstimate& closing, const TorqueEstimate& holding) {
    Gripper gripper(test::jaw5e, config);
    gripper.close();
    Time t;
    for (int i = 0; i < 200; ++i) gripper.update(t = t + Duration::from_ms(4), 0, closing);  // stands at the bar's thickness
    for (int i = 0; i < 50; ++i) gripper.update(t = t + Duration::from_ms(4), 0, holding);
    return gripper.state();
  };
  const TorqueEstimate firm{-10, -12, -8}, doubtful{-10, -16, -4}, lost{-1, -1.5, 0}, perhaps{-1, -4, 0};
  EXPECT_EQ(after(firm, firm), GripperState::held);
  EXPECT_EQ(after(doubtful, doubtful), GripperState::closing);
  EXPECT_EQ(after(firm, lost), GripperState::dropped);
  EXPECT_EQ(after(firm, perhaps), GripperState::held);
}

}  // namespace
}  // namespace lf::arm
