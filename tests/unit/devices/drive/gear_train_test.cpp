#include "host_sim/devices/drive/gear_train.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

constexpr double ratio = 700;
constexpr GearFriction screw{0.003, 1e-5, 0.8, 0.75};
constexpr GearFriction locking{0.003, 1e-5, 0.45, -0.1};

// The motor's torque once load and speed have lasted.
double settled(GearTrain& gear, double joint_nm, double motor_rad_s) {
  double motor_nm = 0;
  for (int i = 0; i < 500; ++i) motor_nm = gear.step(joint_nm, motor_rad_s, ratio, 1e-3);
  return motor_nm;
}

TEST(GearTrain, costs_more_to_raise_a_load_than_to_lower_it) {
  GearTrain gear(screw);
  EXPECT_NEAR(settled(gear, 20, 100), 20 / ratio / 0.8 + 0.003 + 1e-3, 1e-9);
  EXPECT_NEAR(settled(gear, 20, -100), 20 / ratio * 0.75 - 0.003 - 1e-3, 1e-9);
  EXPECT_NEAR(settled(gear, -20, -100), -20 / ratio / 0.8 - 0.003 - 1e-3, 1e-9);
  EXPECT_NEAR(settled(gear, 0, 100), 0.004, 1e-9);
  GearTrain ideal({});
  EXPECT_NEAR(settled(ideal, 20, 100), 20 / ratio, 1e-12);
}

// At rest the torque of the last motion stays, until the load raises the motor's torque or takes it away: a loop with two sides.
TEST(GearTrain, sticks_between_raising_and_lowering) {
  GearTrain gear(screw);
  const double raised = settled(gear, 20, 100) - 1e-3;
  EXPECT_NEAR(settled(gear, 20, 0), raised, 1e-6);
  EXPECT_NEAR(settled(gear, 25, 0), raised, 1e-6) << "a load that grows is held by friction";
  EXPECT_NEAR(settled(gear, 60, 0), 60 / ratio * 0.75 - 0.003, 1e-6) << "until it would push the motor back";
  EXPECT_NEAR(settled(gear, 30, 0), 30 / ratio / 0.8 + 0.003, 1e-6) << "and on its way back it is held by less";
  EXPECT_NEAR(settled(gear, 0, 0), 0.003, 1e-6);
}

TEST(GearTrain, that_locks_itself_feels_no_load_at_rest) {
  GearTrain gear(locking);
  settled(gear, 0, -100);
  const double before = settled(gear, 0, 0);
  for (const double load : {10.0, 100.0, 500.0}) EXPECT_NEAR(settled(gear, load, 0), before, 1e-3 + 0.1 * load / ratio) << load;
  EXPECT_LT(std::abs(settled(gear, 500, 0)), 0.08) << "an ideal screw would have 0.71";
  EXPECT_GT(settled(gear, -500, 100), 0.003) << "it takes torque to let a load down";
  EXPECT_EQ(gear.hold_nm(0.01, ratio), GearTrain::breaking_nm);
}

// What the joint gets at the limit is what the gear asks the motor for.
TEST(GearTrain, limits_agree_with_what_it_asks_of_the_motor) {
  std::mt19937_64 engine(6077);
  std::uniform_real_distribution<double> torque(0.005, 0.1);
  for (int i = 0; i < 200; ++i) {
    GearTrain gear(screw);
    const double motor_nm = torque(engine);
    EXPECT_NEAR(settled(gear, gear.push_nm(motor_nm, 80, ratio), 80), motor_nm, 1e-9);
    EXPECT_NEAR(settled(gear, gear.hold_nm(motor_nm, ratio), -80) + 8e-4, motor_nm, 1e-9);
  }
}

// Worked out by hand: at rest a third more, at Stribeck's speed 1/e of that, at ten times his speed none.
TEST(GearTrain, takes_more_to_break_away_than_to_keep_moving) {
  GearFriction friction{0.003, 0, 1, 1};
  friction.breakaway = 4.0 / 3;
  const auto moving = [&](double motor_rad_s) {
    GearTrain gear(friction);
    return settled(gear, 0, motor_rad_s);
  };
  EXPECT_NEAR(moving(0.6), 0.003 + 0.001 * std::exp(-0.0036), 1e-9);
  EXPECT_NEAR(moving(GearTrain::stribeck_rad_s), 0.003 + 0.001 / std::numbers::e, 1e-9);
  EXPECT_NEAR(moving(-10 * GearTrain::stribeck_rad_s), -0.003, 1e-9);
  GearTrain at_rest(friction);
  double motor_nm = 0;
  for (int i = 0; i < 500; ++i) motor_nm = at_rest.step(0, 0, ratio, 1e-3, 2e-5);
  EXPECT_NEAR(motor_nm, 0.004, 1e-9) << "what it winds up to before it moves";
  EXPECT_TRUE(at_rest.breaks_away(1, 0.0041));
  EXPECT_FALSE(at_rest.breaks_away(1, 0.0039)) << "the motor may not have that much";
  EXPECT_FALSE(at_rest.breaks_away(-1, 1));
  EXPECT_NEAR(at_rest.push_nm(0.014, 0, ratio), ratio * 0.010, 1e-9);
}

TEST(GearTrain, may_rub_more_one_way_than_the_other) {
  GearFriction friction{0.003, 0, 1, 1};
  friction.one_way = 0.2;
  GearTrain gear(friction);
  EXPECT_NEAR(settled(gear, 0, 100), 0.0036, 1e-9);
  EXPECT_NEAR(settled(gear, 0, -100), -0.0024, 1e-9);
  EXPECT_NEAR(gear.push_nm(0.0136, 100, ratio), ratio * 0.010, 1e-9);
  EXPECT_NEAR(gear.push_nm(0.0124, -100, ratio), ratio * 0.010, 1e-9);
  EXPECT_NEAR(gear.hold_nm(0.0076, ratio), ratio * 0.010, 1e-9) << "whichever way it is pushed";
}

TEST(DriveTorque, is_nothing_without_power_and_heats_nothing) {
  DriveRig rig;
  rig.joint.load_nm = 60;  // twice the rated torque, held by the gear
  rig.run_ms(5000);
  EXPECT_EQ(static_cast<std::int16_t>(rig.client.read(0x6077, 0)), 0);
  EXPECT_EQ(rig.client.read(0x2082, 0), 0u) << "of the over-current guard";
  EXPECT_EQ(rig.client.read(0x2081, 0), 120u) << "as cold as the water";
  rig.enable();
  rig.run_ms(300);
  EXPECT_NEAR(static_cast<std::int16_t>(rig.client.read(0x6077, 0)), 2000, 20);
  EXPECT_GT(rig.client.read(0x2082, 0), 0u);
  rig.controlword = 0;
  rig.run_ms(20);
  EXPECT_EQ(static_cast<std::int16_t>(rig.client.read(0x6077, 0)), 0);
}

TEST(DriveTorque, is_the_motors_through_the_screw) {
  DriveConfig config = elbow();
  config.torque_noise_ratio = 0;
  config.friction = {0.1 * config.rated_torque_nm, 0, 0.8, 0.75};
  DriveRig rig(config);
  rig.enable();
  rig.joint.load_nm = 12;  // 400 thousandths without friction
  const auto move = [&](int counts) {
    for (int i = 0; i < 150; ++i) {
      rig.target += counts;
      rig.run_ms(4);
    }
    const double here = Actuator(config.actuator).counts_per_rad(rig.joint.q_rad), there = Actuator(config.actuator).counts_per_rad(1);
    return there / here;  // of the lever
  };
  const double up = move(4);
  EXPECT_NEAR(static_cast<std::int16_t>(rig.client.read(0x6077, 0)), 400 / 0.8 * up + 100, 8);
  const double down = move(-4);
  EXPECT_NEAR(static_cast<std::int16_t>(rig.client.read(0x6077, 0)), 400 * 0.75 * down - 100, 8);
  EXPECT_NEAR(rig.output.torque_limit_nm, 0.8 * (90 - 3) / down, 0.5);
  EXPECT_NEAR(rig.output.holding_limit_nm, (90 + 3) / 0.75 / down, 0.5);
}

}  // namespace
}  // namespace lf::devices::test
