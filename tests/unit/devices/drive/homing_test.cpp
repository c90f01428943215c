#include "host_sim/devices/drive/homing.hpp"

#include <gtest/gtest.h>

#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

void start_homing(DriveRig& rig, int method, int offset) {
  rig.client.write(0x607C, 0, offset, 4);
  rig.client.write(0x6098, 0, method, 1);
  rig.enable(6);
  rig.controlword = 0x1F;
  rig.run_ms(12);
}

TEST(Homing, methods_35_and_37_name_the_present_place) {
  for (const int method : {35, 37}) {
    DriveRig rig;
    const double q = rig.joint.q_rad;
    start_homing(rig, method, 1234);
    rig.run_ms(20);
    EXPECT_EQ(rig.actual(), 1234);
    EXPECT_EQ(rig.status() & 0x3400, 0x1400) << "attained, target reached, no error";
    EXPECT_EQ(rig.joint.q_rad, q) << "nothing moves";
  }
}

TEST(Homing, a_hard_stop_is_found_by_torque_in_either_direction) {
  for (const int method : {-1, -2}) {
    DriveRig rig(elbow(), 1.9);
    if (method == -1) rig.joint.q_rad = 0.25;
    rig.run_ms(2);
    start_homing(rig, method, -77);
    EXPECT_EQ(rig.status() & 0x3400, 0x0000) << "running";
    rig.run_ms(4000);
    EXPECT_EQ(rig.status() & 0x3400, 0x1400);
    EXPECT_NEAR(rig.joint.q_rad, method == -1 ? 0.0 : 2.15294, 1e-9);
    EXPECT_NEAR(rig.actual(), -77, 2);
    EXPECT_EQ(rig.drive.state(), DriveState::operation_enabled);
    EXPECT_EQ(rig.output.velocity_rad_s, 0) << "it does not press on";
  }
}

TEST(Homing, a_light_touch_below_the_threshold_is_no_stop) {
  DriveRig rig(elbow(), 1.0);
  rig.client.write(0x2080, 0, 400, 2);
  rig.joint.load_nm = -8;  // against the motion, 27 % of rated
  start_homing(rig, -1, 0);
  rig.run_ms(500);
  EXPECT_EQ(rig.status() & 0x1000, 0);
  EXPECT_LT(rig.joint.q_rad, 1.0);
}

TEST(Homing, a_run_without_a_stop_fails) {
  DriveConfig config = elbow();
  config.actuator = {0, 0, 0, 0, 5000};
  config.upper_rad = 0.5;
  DriveRig rig(config, 0.2);
  rig.joint.lower_rad = -100;
  rig.client.write(0x6065, 0, 0xFFFFFFFF, 4);
  start_homing(rig, -1, 0);
  rig.run_ms(9000);
  EXPECT_EQ(rig.status() & 0x3000, 0x2000);
  EXPECT_EQ(rig.joint.moved_rad_s, 0);
}

TEST(Homing, an_incremental_encoder_starts_at_zero_and_an_absolute_one_does_not) {
  DriveConfig config = elbow();
  config.absolute_encoder = false;
  DriveRig incremental(config, 1.0), absolute(elbow(), 1.0);
  EXPECT_EQ(incremental.actual(), 0);
  EXPECT_GT(absolute.actual(), 1000);
}

TEST(Homing, a_new_method_waits_for_the_run_to_end) {
  DriveRig rig(elbow(), 1.0);
  start_homing(rig, -1, 0);
  EXPECT_EQ(rig.client.write(0x6098, 0, 35, 1), 0x08000022u);
}

}  // namespace
}  // namespace lf::devices::test
