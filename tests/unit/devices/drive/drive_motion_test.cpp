// CSP on a joint that stands still below its stiction speed; PP and PV beside it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

// Counts of an angle from the triangle, solved on its own: law of cosines.
double elbow_counts(double q) {
  const auto length = [](double angle) { return std::sqrt(0.26 * 0.26 + 0.06 * 0.06 - 2 * 0.26 * 0.06 * std::cos(angle + 0.2115)); };
  return 166667 * (length(q) - length(0));
}

TEST(DriveMotion, the_encoder_counts_the_screw_through_its_triangle) {
  for (const double q : {0.0, 0.3, 1.0, 1.7, 2.15}) {
    DriveRig rig(elbow(), q);
    EXPECT_EQ(rig.actual(), std::lround(elbow_counts(q))) << q;
  }
}

TEST(DriveMotion, counts_per_radian_are_the_slope_of_the_counts) {
  const Actuator actuator(elbow().actuator);
  for (double q = 0.05; q < 2.1; q += 0.05) {
    const double slope = (actuator.counts(q + 1e-6) - actuator.counts(q - 1e-6)) / 2e-6;
    EXPECT_NEAR(actuator.counts_per_rad(q), slope, 1e-3 * std::abs(slope));
  }
}

TEST(DriveMotion, an_encoder_offset_reads_too_much_by_itself) {
  DriveConfig config = elbow();
  config.encoder_offset_rad = 0.05 * 3.14159265358979 / 180;
  DriveRig rig(config, 1.0);
  EXPECT_EQ(rig.actual(), std::lround(elbow_counts(1.0 + config.encoder_offset_rad)));
}

// A share of the rated torque, a third more to break it away, and a load's share.
DriveConfig rubbing_elbow(double share = 0.05) {
  DriveConfig c = elbow();
  c.torque_noise_ratio = 0;
  c.friction = {share * c.rated_torque_nm, 0, 0.8, 0.75};
  c.friction.breakaway = 1.3;
  return c;
}

// Moves to targets all over the stroke, one SYNC at a time at 500 counts/s, and waits half a second.
TEST(DriveMotion, targets_are_reached_within_two_counts_despite_friction) {
  DriveRig rig(rubbing_elbow(0.3));
  rig.enable();
  for (const double q : {1.0005, 0.9, 1.5, 0.4, 1.97, 1.9703, 1.97}) {
    const auto target = static_cast<std::int32_t>(std::lround(elbow_counts(q)));
    for (int i = 0; i < 20000 && rig.target != target; ++i) {
      const double step = std::clamp<double>(target - rig.target, -2, 2);
      rig.target += static_cast<std::int32_t>(step);
      rig.run_ms(4);
    }
    rig.run_ms(500);
    ASSERT_EQ(rig.drive.state(), DriveState::operation_enabled) << q;
    EXPECT_LE(std::abs(rig.actual() - target), 2) << q;
    const double parked = rig.joint.q_rad;
    rig.run_ms(1000);
    EXPECT_EQ(rig.joint.q_rad, parked) << "it hunts at " << q;
    EXPECT_NE(rig.status() & 0x400, 0) << "target reached";
  }
}

// The sweep's speed, hardly above the stiction of 0.06 rad/s, where a count is 0.1 to 0.37 mrad.
TEST(DriveMotion, the_sweeps_speed_is_tracked_smoothly) {
  DriveRig rig(rubbing_elbow(), 2.05);
  rig.enable();
  const double speed = 0.065;
  double worst_error = 0, slowest = 1e9, fastest = 0;
  double window_start = rig.joint.q_rad;
  for (int ms = 0; ms < 12000; ms += 4) {
    const double q = 2.05 - speed * 1e-3 * ms;
    rig.target = static_cast<std::int32_t>(std::lround(elbow_counts(q)));
    rig.run_ms(4);
    if (ms < 1000) {
      window_start = rig.joint.q_rad;
      continue;
    }
    worst_error = std::max(worst_error, std::abs(rig.joint.q_rad - (q + speed * 0.002)));
    if (ms % 200 != 0) continue;
    const double mean = (window_start - rig.joint.q_rad) / (ms == 1000 ? 0.004 : 0.2);
    window_start = rig.joint.q_rad;
    if (ms == 1000) continue;
    slowest = std::min(slowest, mean);
    fastest = std::max(fastest, mean);
  }
  EXPECT_LT(worst_error, 1.2e-3);
  EXPECT_GT(slowest, 0.95 * speed);
  EXPECT_LT(fastest, 1.05 * speed);
}

// Towards smaller angles, with a load that helps, one that resists, and none. Single milliseconds at the stiction speed were 126 times the drive's acceleration.
TEST(DriveMotion, a_motor_that_stands_turns_when_its_torque_breaks_friction) {
  for (const double load_nm : {0.0, 12.0, -12.0}) {
    const DriveConfig config = rubbing_elbow();
    DriveRig rig(config, 1.6);
    rig.joint.load_nm = load_nm;
    rig.enable();
    rig.run_ms(300);
    const double here = Actuator(config.actuator).counts_per_rad(1.6), at_1_rad = Actuator(config.actuator).counts_per_rad(1);
    const double load = load_nm / 30 * at_1_rad / here;  // over the rated torque
    const double breaking = -0.05 * 1.3 + load * (load <= 0 ? 1 / 0.8 : 0.75);
    double last_rad_s = 0, hardest_rad_s2 = 0, torque = 0;
    bool moved = false;
    for (int ms = 0; ms < 4000; ++ms) {
      if (ms % 4 == 0) rig.target = static_cast<std::int32_t>(std::lround(elbow_counts(1.6 - 0.01 * 1e-3 * ms)));
      rig.run_ms(1);
      if (!moved && rig.output.velocity_rad_s != 0) {
        moved = true;
        torque = 1e-3 * static_cast<std::int16_t>(rig.client.read(0x6077, 0));
      }
      hardest_rad_s2 = std::max(hardest_rad_s2, std::abs(rig.output.velocity_rad_s - last_rad_s) / 1e-3);
      last_rad_s = rig.output.velocity_rad_s;
    }
    EXPECT_TRUE(moved) << load_nm;
    EXPECT_NEAR(torque, breaking, 0.012) << load_nm << ": the reading's filter is 2 ms";
    EXPECT_LE(hardest_rad_s2, 1.001 * config.max_acceleration_rad_s2) << load_nm;
  }
}

// From rest to 0.01 rad/s. The controller winds up by the speed that is asked: the target's, through its filter of 16 ms, and 20 /s of what the joint lags.
TEST(DriveMotion, a_gear_that_rubs_more_takes_longer_to_break_away) {
  constexpr double speed = 0.01, filter_s = 0.016, gain_per_s = 20;
  for (const double share : {0.05, 0.2, 0.4}) {
    const DriveConfig config = rubbing_elbow(share);
    const double wanted = 1.3 * share * 0.05 * config.stiction_rad_s;
    double due_s = 0;
    for (double wound = 0; wound < wanted; due_s += 1e-5) wound += 1e-5 * speed * (1 - std::exp(-due_s / filter_s) + gain_per_s * due_s);
    DriveRig rig(config, 1.6);
    rig.enable();
    rig.run_ms(300);
    int ms = 0;
    do {
      if (ms % 4 == 0) rig.target = static_cast<std::int32_t>(std::lround(elbow_counts(1.6 - speed * 1e-3 * ms)));
      rig.run_ms(1);
      ++ms;
    } while (rig.output.velocity_rad_s == 0 && ms < 1000);
    EXPECT_NEAR(1e-3 * ms, due_s, 0.012) << share << ": counts of 0.1 mrad, and a SYNC";
  }
}

TEST(DriveMotion, a_gear_that_rubs_more_than_6072_allows_stands) {
  for (const int thousandths : {60, 70}) {
    DriveRig rig(rubbing_elbow(), 1.6);
    rig.client.write(0x6065, 0, 0xFFFFFFFF, 4);
    rig.client.write(0x6072, 0, thousandths, 2);
    rig.enable();
    rig.target -= 50;
    rig.run_ms(2000);
    EXPECT_EQ(rig.joint.q_rad == 1.6, thousandths < 65) << thousandths << " of the rated torque, where 65 break it away";
  }
}

TEST(DriveMotion, a_speed_below_the_stiction_is_kept_in_the_mean) {
  DriveRig rig(rubbing_elbow(), 1.6);
  rig.enable();
  const double begin = rig.joint.q_rad;
  for (int ms = 0; ms < 10000; ms += 4) {
    rig.target = static_cast<std::int32_t>(std::lround(elbow_counts(1.6 - 0.01 * 1e-3 * ms)));
    rig.run_ms(4);
  }
  EXPECT_NEAR(begin - rig.joint.q_rad, 0.1, 1e-3);
}

TEST(DriveMotion, the_command_is_interpolated_over_60c2) {
  DriveRig rig;
  rig.enable();
  rig.cyclic = false;
  const std::int32_t from = rig.target;
  rig.target = from + 40;
  rig.send_set_point();
  rig.client.sync();
  std::vector<int> demand;
  for (int i = 0; i < 6; ++i) {
    rig.run_ms(1);
    demand.push_back(static_cast<std::int32_t>(rig.client.read(0x6062, 0)) - from);
  }
  EXPECT_EQ(demand, (std::vector<int>{10, 20, 30, 40, 40, 40}));
}

TEST(DriveMotion, a_target_outside_607d_is_held_at_the_limit) {
  DriveRig rig;
  ASSERT_EQ(rig.client.write(0x607D, 2, rig.actual() + 30, 4), 0u);
  const std::int32_t limit = rig.actual() + 30;
  rig.enable();
  for (int i = 0; i < 60; ++i) {
    rig.target += 2;
    rig.run_ms(4);
  }
  rig.run_ms(400);
  EXPECT_NEAR(rig.actual(), limit, 2);
  EXPECT_NE(rig.status() & 0x800, 0) << "internal limit active";
}

TEST(DriveMotion, top_speed_and_acceleration_are_kept) {
  DriveRig rig(elbow(), 0.5);
  rig.client.write(0x6065, 0, 0xFFFFFFFF, 4);
  rig.enable();
  rig.target += 4000;
  double last = 0, fastest = 0, hardest = 0;
  for (int ms = 0; ms < 3000; ++ms) {
    rig.run_ms(1);
    const double v = rig.output.velocity_rad_s;
    fastest = std::max(fastest, v);
    if (std::abs(v) > 0.1 && std::abs(last) > 0.1) hardest = std::max(hardest, std::abs(v - last) / 1e-3);
    last = v;
  }
  EXPECT_LE(fastest, 0.35 + 1e-12);
  EXPECT_GT(fastest, 0.3);
  EXPECT_LE(hardest, 0.8 + 1e-9);
  EXPECT_NEAR(rig.actual(), rig.target, 2);
}

TEST(DriveMotion, without_power_the_joint_is_left_to_its_gear) {
  DriveRig rig;
  EXPECT_TRUE(rig.output.released);
  rig.enable();
  EXPECT_FALSE(rig.output.released);
  EXPECT_NEAR(rig.output.torque_limit_nm, 90, 0.05);
  rig.client.write(0x6072, 0, 500, 2);
  rig.run_ms(1);
  EXPECT_NEAR(rig.output.torque_limit_nm, 15, 0.05);
  rig.controlword = 0;
  rig.run_ms(8);
  EXPECT_TRUE(rig.output.released);
}

TEST(DriveMotion, the_torque_reading_is_in_thousandths_of_the_rated_torque) {
  DriveRig rig;
  rig.enable();
  rig.joint.load_nm = 12;
  rig.run_ms(150);
  double mean = 0;
  for (int i = 0; i < 200; ++i) {
    rig.run_ms(1);
    mean += static_cast<std::int16_t>(rig.client.read(0x6077, 0)) / 200.0;
  }
  EXPECT_NEAR(mean, 400, 2);
}

TEST(DriveMotion, a_quick_stop_brakes_at_6085_and_holds_with_option_6) {
  DriveRig rig(elbow(), 1.5);
  rig.client.write(0x605A, 0, 6, 2);
  rig.enable();
  for (int i = 0; i < 250; ++i) {
    rig.target -= 6;  // 1,500 counts/s
    rig.run_ms(4);
  }
  const double speed = std::abs(rig.joint.moved_rad_s);
  ASSERT_GT(speed, 0.15);
  const double begin = rig.joint.q_rad;
  rig.controlword = 0x02;
  rig.run_ms(2000);
  EXPECT_EQ(rig.drive.state(), DriveState::quick_stop_active);
  EXPECT_EQ(rig.joint.moved_rad_s, 0);
  EXPECT_FALSE(rig.output.released) << "it holds";
  const double distance = begin - rig.joint.q_rad;
  EXPECT_GT(distance, 0.5 * speed * speed / (2 * 0.8));
  EXPECT_LT(distance, 3.0 * speed * speed / (2 * 0.8));
  rig.target = rig.actual();
  rig.controlword = 0x0F;
  rig.run_ms(8);
  EXPECT_EQ(rig.drive.state(), DriveState::operation_enabled);
}

TEST(DriveMotion, a_quick_stop_ends_disabled_with_option_2) {
  DriveRig rig(elbow(), 1.5);
  rig.enable();
  for (int i = 0; i < 250; ++i) {
    rig.target -= 6;
    rig.run_ms(4);
  }
  rig.controlword = 0x02;
  rig.run_ms(8);
  EXPECT_EQ(rig.drive.state(), DriveState::quick_stop_active);
  rig.run_ms(1000);
  EXPECT_EQ(rig.drive.state(), DriveState::switch_on_disabled);
  EXPECT_TRUE(rig.output.released);
}

// A joint that has run off by 0.1 rad brakes from the speed that it has, and stays where that ends. What no maker's document says: a stop whose ramp is the
// demand's takes it back to its set-point.
TEST(DriveMotion, a_quick_stop_of_a_joint_that_is_off_its_set_point) {
  for (const bool from_demand : {false, true}) {
    DriveConfig config = elbow();
    config.switches.ramps_from_demand = from_demand;
    DriveRig rig(config, 1.0);
    rig.client.write(0x605A, 0, 2, 2);
    rig.client.write(0x6065, 0, 0xFFFFFFFF, 4);
    rig.enable();
    const double set_point_rad = rig.joint.q_rad, speed = 0.25, deceleration = 0.8;
    rig.joint.runs_off_rad_s = speed;
    rig.run_ms(400);
    const double begin_rad = rig.joint.q_rad;
    ASSERT_NEAR(begin_rad - set_point_rad, 0.4 * speed, 1e-3);
    rig.controlword = 0x02;
    while (rig.drive.state() == DriveState::operation_enabled) rig.step();
    rig.joint.runs_off_rad_s = 0;
    int powered_ms = 0;
    double farthest_rad = begin_rad;
    for (; powered_ms < 3000 && rig.drive.state() == DriveState::quick_stop_active; ++powered_ms) {
      rig.step();
      farthest_rad = std::max(farthest_rad, rig.joint.q_rad);
    }
    if (from_demand) {
      EXPECT_LT(farthest_rad - begin_rad, 0.005) << "it turns back at once";
      continue;
    }
    EXPECT_NEAR(1e-3 * powered_ms, speed / deceleration, 0.05) << "its power stays on while it brakes";
    EXPECT_NEAR(rig.joint.q_rad - begin_rad, 0.5 * speed * speed / deceleration, 0.02);
  }
}

// A jaw's squeeze is let go of in one step, and the stop comes a SYNC later: the set-point has jumped, and the joint stood.
TEST(DriveMotion, a_quick_stop_takes_no_jump_of_the_set_point_for_a_speed) {
  DriveRig rig(elbow(), 1.0);
  rig.client.write(0x605A, 0, 2, 2);
  rig.client.write(0x6065, 0, 0xFFFFFFFF, 4);
  rig.joint.lower_rad = rig.joint.upper_rad = 1.0;
  rig.enable();
  const std::int32_t held = rig.target;
  rig.target = held - 150;
  rig.run_ms(60);
  rig.target = held;
  rig.run_ms(8);
  rig.joint.lower_rad = 0, rig.joint.upper_rad = 2;
  rig.controlword = 0x02;
  double farthest_rad = 0;
  for (int i = 0; i < 1000; ++i) {
    rig.step();
    farthest_rad = std::max(farthest_rad, std::abs(rig.joint.q_rad - 1.0));
  }
  EXPECT_EQ(rig.drive.state(), DriveState::switch_on_disabled);
  EXPECT_LT(farthest_rad, 0.005);
}

// A drive that has run off goes faster than its limit allows: its ramp begins at the limit.
TEST(DriveMotion, a_quick_stop_from_above_the_top_speed_ends_as_one_from_it) {
  DriveConfig config = elbow();
  DriveRig rig(config, 0.8);
  rig.client.write(0x605A, 0, 2, 2);
  rig.client.write(0x6065, 0, 0xFFFFFFFF, 4);
  rig.enable();
  const double top_counts_s = static_cast<double>(rig.client.read(0x607F, 0));
  rig.joint.runs_off_rad_s = 1.5 * config.max_velocity_rad_s;
  rig.run_ms(300);
  const std::int32_t before = rig.actual();
  rig.run_ms(4);
  ASSERT_GT(rig.actual() - before, 4e-3 * top_counts_s) << "faster than its limit";
  rig.controlword = 0x02;
  while (rig.drive.state() == DriveState::operation_enabled) rig.step();
  rig.joint.runs_off_rad_s = 0;
  int powered_ms = 0;
  for (; powered_ms < 3000 && rig.drive.state() == DriveState::quick_stop_active; ++powered_ms) rig.step();
  EXPECT_LT(1e-3 * powered_ms, config.max_velocity_rad_s / config.max_acceleration_rad_s2 + 0.15);
}

// 605A = 6: it stays where its ramp ends, and does not come back to it.
TEST(DriveMotion, a_quick_stop_under_power_does_not_overshoot) {
  for (const double share_of_top : {0.5, 1.0, 1.5}) {
    SCOPED_TRACE(share_of_top);
    DriveConfig config = elbow();
    DriveRig rig(config, 0.8);
    rig.client.write(0x605A, 0, 6, 2);
    rig.client.write(0x6065, 0, 0xFFFFFFFF, 4);
    rig.enable();
    rig.joint.runs_off_rad_s = share_of_top * config.max_velocity_rad_s;
    rig.run_ms(300);
    rig.controlword = 0x02;
    while (rig.drive.state() == DriveState::operation_enabled) rig.step();
    rig.joint.runs_off_rad_s = 0;
    double farthest_rad = rig.joint.q_rad;
    for (int i = 0; i < 1500; ++i) {
      rig.step();
      farthest_rad = std::max(farthest_rad, rig.joint.q_rad);
    }
    EXPECT_EQ(rig.drive.state(), DriveState::quick_stop_active);
    EXPECT_LT(farthest_rad - rig.joint.q_rad, 0.004);
  }
}

// The encoder is off by a tenth of a radian from one millisecond to the next, as by a slipped coupling: that is no speed to brake from.
TEST(DriveMotion, a_quick_stop_takes_no_jump_of_the_encoder_for_a_speed) {
  DriveRig rig(elbow(), 1.0);
  rig.client.write(0x6065, 0, 0xFFFFFFFF, 4);
  rig.enable();
  rig.joint.q_rad += 0.1;
  const double begin_rad = rig.joint.q_rad;
  rig.controlword = 0x02;
  rig.run_ms(1000);
  EXPECT_EQ(rig.drive.state(), DriveState::switch_on_disabled);
  EXPECT_NEAR(rig.joint.q_rad, begin_rad, 0.02);
}

// A count of the wrist is 3 mrad: in one SYNC the target moves by one count or by none, which is 0.8 rad/s or nothing.
TEST(DriveMotion, a_quick_stop_brakes_from_the_speed_of_the_joint_however_coarse_the_counts) {
  DriveConfig wrist = elbow();
  wrist.actuator = {0, 0, 0, 0, 318.3};
  wrist.lower_rad = -3;
  wrist.upper_rad = 3;
  wrist.max_velocity_rad_s = 0.7;
  wrist.max_acceleration_rad_s2 = 2;
  wrist.stiction_rad_s = 0.2;
  constexpr double speed_rad_s = 0.35, filter_s = 0.016, ripple = 1.3;  // of a filter that sees a count each 9 ms
  for (int stopped_at = 250; stopped_at < 262; ++stopped_at) {
    DriveRig rig(wrist, 0);
    rig.joint.lower_rad = -3;
    rig.joint.upper_rad = 3;
    rig.enable();
    for (int i = 1; i <= stopped_at; ++i) {
      rig.target = static_cast<std::int32_t>(std::lround(318.3 * speed_rad_s * 0.004 * i));
      rig.run_ms(4);
    }
    rig.controlword = 0x02;
    const double begin_rad = rig.joint.q_rad;
    double fastest_rad_s = 0;
    int moving_ms = 0;
    for (int ms = 1; ms <= 1000; ++ms) {
      rig.step();
      fastest_rad_s = std::max(fastest_rad_s, std::abs(rig.joint.moved_rad_s));
      if (std::abs(rig.joint.moved_rad_s) > 0.02) moving_ms = ms;
    }
    EXPECT_LT(fastest_rad_s, ripple * speed_rad_s) << stopped_at;
    EXPECT_LT(moving_ms, 1000 * ripple * speed_rad_s / 2 + 50) << stopped_at;
    EXPECT_LT(rig.joint.q_rad - begin_rad, 0.5 * std::pow(ripple * speed_rad_s, 2) / 2 + 2 * filter_s * speed_rad_s) << stopped_at;
  }
}

TEST(DriveMotion, profile_position_runs_to_its_set_point_with_a_handshake) {
  DriveRig rig;
  rig.enable(1);
  const std::int32_t target = rig.actual() + 700;
  rig.target = target;
  rig.controlword = 0x1F;
  rig.run_ms(12);
  EXPECT_NE(rig.status() & 0x1000, 0) << "set-point acknowledged";
  rig.controlword = 0x0F;
  rig.run_ms(12);
  EXPECT_EQ(rig.status() & 0x1000, 0);
  EXPECT_EQ(rig.status() & 0x400, 0);
  rig.run_ms(4000);
  EXPECT_NEAR(rig.actual(), target, 2);
  EXPECT_NE(rig.status() & 0x400, 0);
}

TEST(DriveMotion, profile_velocity_runs_at_its_speed_and_halts) {
  DriveRig rig(elbow(), 0.5);
  rig.enable(3);
  ASSERT_EQ(rig.client.write(0x60FF, 0, 1200, 4), 0u);
  rig.run_ms(1000);
  const std::int32_t begin = rig.actual();
  rig.run_ms(1000);
  EXPECT_NEAR(rig.actual() - begin, 1200, 15);
  EXPECT_NEAR(static_cast<std::int32_t>(rig.client.read(0x606C, 0)), 1200, 200);
  rig.controlword = 0x10F;
  rig.run_ms(1500);
  const std::int32_t stopped = rig.actual();
  rig.run_ms(500);
  EXPECT_EQ(rig.actual(), stopped);
}

}  // namespace
}  // namespace lf::devices::test
