#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/devices/drive/winding.hpp"
#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

TEST(DriveFault, a_command_that_runs_away_trips_8611_after_its_time) {
  DriveRig rig;
  rig.client.write(0x6065, 0, 100, 4);
  rig.client.write(0x6066, 0, 80, 2);
  rig.enable();
  rig.drive.faults().jammed = true;
  rig.target += 300;
  rig.sent.clear();
  rig.run_ms(75);
  EXPECT_NE(rig.status() & 0x2000, 0) << "following error is shown before it trips";
  EXPECT_EQ(rig.drive.state(), DriveState::operation_enabled);
  rig.run_ms(20);
  EXPECT_EQ(emergency(rig.sent, 3), 0x8611);
  EXPECT_EQ(rig.client.read(0x603F, 0), 0x8611u);
  rig.run_ms(500);  // its demand goes down its ramp first
  EXPECT_EQ(rig.drive.state(), DriveState::fault);
}

TEST(DriveFault, an_unseeded_target_is_a_jump_that_trips_8611) {
  DriveRig rig;
  rig.configure();
  rig.client.write(0x6060, 0, 8, 1);
  rig.client.write(0x6065, 0, 200, 4);
  for (const int word : {0x06, 0x07, 0x0F}) {
    rig.controlword = static_cast<std::uint16_t>(word);
    rig.run_ms(12);
  }
  rig.run_ms(300);
  EXPECT_EQ(emergency(rig.sent, 3), 0x8611);
}

TEST(DriveFault, a_stuck_encoder_shows_as_a_following_error) {
  DriveRig rig;
  rig.client.write(0x6065, 0, 100, 4);
  rig.enable();
  rig.drive.faults().stuck_encoder = true;
  for (int i = 0; i < 200; ++i) {
    rig.target -= 2;
    rig.run_ms(4);
  }
  EXPECT_EQ(emergency(rig.sent, 3), 0x8611);
}

TEST(DriveFault, half_as_much_again_as_rated_trips_2310_after_1_5_s) {
  DriveRig rig;
  rig.enable();
  rig.joint.load_nm = 45;
  rig.sent.clear();
  rig.run_ms(1450);
  EXPECT_EQ(emergency(rig.sent, 3), -1);
  EXPECT_NE(rig.status() & 0x80, 0) << "warned";
  rig.run_ms(200);
  EXPECT_EQ(emergency(rig.sent, 3), 0x2310);
  EXPECT_EQ(rig.client.read(0x1001, 0), 0x03u);
}

TEST(DriveFault, the_rated_torque_can_be_held_for_ever) {
  Winding winding(12, 30);
  for (int i = 0; i < 3'000'000; ++i) winding.step(1.0, 1e-3);
  EXPECT_FALSE(winding.overloaded());
  EXPECT_NEAR(winding.celsius(), 42, 0.1);
}

TEST(DriveFault, the_winding_warms_with_the_square_of_the_load_over_its_time_constant) {
  Winding winding(12, 30);
  for (int i = 0; i < 300'000; ++i) winding.step(0.5, 1e-3);
  EXPECT_NEAR(winding.celsius(), 12 + 7.5 * (1 - std::exp(-1.0)), 0.05);
}

TEST(DriveFault, a_hot_winding_trips_4210_and_can_be_reset_when_cool) {
  DriveRig rig;
  rig.enable();
  rig.drive.faults().hot = true;
  rig.run_ms(10);
  EXPECT_EQ(emergency(rig.sent, 3), 0x4210);
  EXPECT_GT(rig.client.read(0x2081, 0), 850u);
  rig.controlword = 0x80;
  rig.run_ms(10);
  EXPECT_EQ(rig.drive.state(), DriveState::fault);
  rig.drive.faults().hot = false;
  rig.controlword = 0x00;
  rig.run_ms(10);
  rig.controlword = 0x80;
  rig.run_ms(10);
  EXPECT_EQ(rig.drive.state(), DriveState::switch_on_disabled);
  EXPECT_EQ(emergency(rig.sent, 3), 0);
}

TEST(DriveFault, the_brake_holds_after_a_fault_unless_605e_lets_go) {
  for (const int option : {0, 1, 2}) {
    DriveRig rig;
    rig.client.write(0x605E, 0, option, 2);
    rig.enable();
    rig.drive.faults().overcurrent = true;
    rig.run_ms(20);
    ASSERT_EQ(rig.drive.state(), DriveState::fault);
    EXPECT_EQ(rig.output.released, option == 0) << option;
    EXPECT_EQ(rig.output.velocity_rad_s, 0);
  }
}

TEST(DriveFault, a_moving_drive_shows_its_fault_reaction_while_it_brakes) {
  DriveRig rig(elbow(), 1.5);
  rig.enable();
  for (int i = 0; i < 250; ++i) {
    rig.target -= 6;
    rig.run_ms(4);
  }
  rig.drive.faults().hot = true;
  rig.run_ms(2);
  EXPECT_EQ(rig.status() & 0x4F, 0x0F);
  EXPECT_NE(rig.joint.moved_rad_s, 0);
  rig.run_ms(1000);
  EXPECT_EQ(rig.status() & 0x4F, 0x08);
  EXPECT_EQ(rig.joint.moved_rad_s, 0);
}

TEST(DriveFault, nmt_stop_of_an_enabled_drive_is_6007s_case) {
  DriveRig rig;
  rig.enable();
  rig.client.nmt(2);
  EXPECT_NE(rig.drive.state(), DriveState::operation_enabled);
  rig.run_ms(5);
  EXPECT_EQ(rig.drive.state(), DriveState::fault);
}

}  // namespace
}  // namespace lf::devices::test
