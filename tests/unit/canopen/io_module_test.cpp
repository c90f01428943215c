// The output node: switching, triggering, the laser's interlock, and which outputs a frame was exposed under.
#include <gtest/gtest.h>

#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::canopen {
namespace {

using can_map::output_lamps;
using can_map::output_laser;
using test::Bus;
using test::ScriptedNode;

class Io : public ::testing::Test {
 protected:
  void SetUp() override {
    node().trigger_counter = 200;
    ASSERT_TRUE(bus.boot());
  }
  IoModule& io() { return bus.network.io(); }
  ScriptedNode& node() { return bus.nodes[arm5e_joint::count]; }

  Bus bus{test::plain_config()};
};

TEST_F(Io, NothingIsSwitchedOrTriggeredUntilAsked) {
  bus.step(50);
  EXPECT_EQ(node().outputs, 0);
  EXPECT_EQ(node().exposures, 0);
  EXPECT_EQ(node().trigger_counter, 200);
  EXPECT_TRUE(io().estop_closed());
}

TEST_F(Io, OutputsFollowWithinTwoSyncsAndAreReported) {
  io().set_outputs(output_laser | output_lamps);
  bus.step(2);
  EXPECT_EQ(node().outputs, 3);
  bus.step(1);
  EXPECT_EQ(io().outputs(), 3);
  io().set_outputs(output_lamps);
  bus.step(3);
  EXPECT_EQ(io().outputs(), 2);
}

TEST_F(Io, EachTriggerIsOneExposureOfItsLength) {
  EXPECT_TRUE(io().trigger_camera(Duration::from_us(2000)));
  EXPECT_FALSE(io().trigger_camera(Duration::from_us(2000))) << "one a cycle";
  bus.step(5);
  EXPECT_EQ(node().exposures, 1);
  EXPECT_EQ(node().last_exposure_us, 2000);
  EXPECT_EQ(io().trigger_counter(), 201);
  EXPECT_EQ(io().last_trigger_counter(), 201);
  EXPECT_EQ(io().last_exposure(), Duration::from_us(2000));
  for (int i = 0; i < 300; ++i) {  // over the counter's wrap
    EXPECT_TRUE(io().trigger_camera(Duration::from_us(500)));
    bus.step();
  }
  bus.step(3);
  EXPECT_EQ(node().exposures, 301);
  EXPECT_EQ(io().stats().triggers, 301u);
  EXPECT_EQ(io().stats().triggers_refused, 1u);
}

TEST_F(Io, AnExposureThatDoesNotFitTheObjectIsRefused) {
  EXPECT_FALSE(io().trigger_camera(Duration::from_us(0)));
  EXPECT_FALSE(io().trigger_camera(Duration::from_us(65'536)));
  EXPECT_FALSE(io().trigger_camera(Duration::from_us(-5)));
  EXPECT_TRUE(io().trigger_camera(Duration::from_us(65'535)));
}

TEST_F(Io, AnOpenInterlockKeepsTheLaserOffUntilItIsAskedOffAndOnAgain) {
  io().set_outputs(output_laser | output_lamps);
  bus.step(5);
  ASSERT_EQ(node().outputs, 3);
  node().inputs = 1;
  bus.step(4);
  EXPECT_EQ(node().outputs, output_lamps);
  EXPECT_TRUE(io().laser_inhibited());
  node().inputs = 3;
  for (int i = 0; i < 10; ++i) {
    io().set_outputs(output_laser | output_lamps);
    bus.step();
  }
  EXPECT_EQ(node().outputs, output_lamps) << "closing the interlock is not a command";
  io().set_outputs(0);
  bus.step();
  io().set_outputs(output_laser);
  bus.step(3);
  EXPECT_EQ(node().outputs, output_laser);
  EXPECT_GT(io().stats().laser_inhibited, 10u);
}

TEST_F(Io, AStaleNodeIsNotAskedForTheLaser) {
  io().set_outputs(output_laser);
  bus.step(5);
  ASSERT_EQ(node().outputs, output_laser);
  node().mute_tpdo = true;
  bus.step(6);
  EXPECT_FALSE(io().fresh(bus.now));
  EXPECT_EQ(node().outputs, 0);
}

TEST_F(Io, KnowsTheOutputsOfAnIntervalAndThatOneStraddlesASwitch) {
  io().set_outputs(output_laser);
  bus.step(10);
  const Time on_from = io().actual_time() - Duration::from_ms(16);
  const Time on_to = io().actual_time();
  io().set_outputs(0);
  bus.step(10);
  const Time off_to = io().actual_time();
  EXPECT_EQ(io().outputs_during(on_from, on_to), std::optional<std::uint8_t>(output_laser));
  EXPECT_EQ(io().outputs_during(on_from + Duration::from_us(50), on_from + Duration::from_us(2050)),
            std::optional<std::uint8_t>(output_laser));
  EXPECT_EQ(io().outputs_during(off_to - Duration::from_ms(8), off_to), std::optional<std::uint8_t>(0));
  EXPECT_EQ(io().outputs_during(on_to, off_to), std::nullopt);
  EXPECT_EQ(io().outputs_during(off_to, off_to + Duration::from_ms(1)), std::nullopt) << "not reported yet";
  EXPECT_EQ(io().outputs_during(Time{}, on_to), std::nullopt) << "before it was heard";
}

TEST_F(Io, ALostReportMakesItsCyclesUnknown) {
  io().set_outputs(output_lamps);
  bus.step(6);
  const Time before = io().actual_time();
  node().mute_tpdo = true;
  bus.step(2);
  node().mute_tpdo = false;
  bus.step(3);
  EXPECT_EQ(io().outputs_during(before - Duration::from_ms(8), before), std::optional<std::uint8_t>(output_lamps));
  EXPECT_EQ(io().outputs_during(before, io().actual_time()), std::nullopt);
}

TEST_F(Io, ANodeThatIsNotStartedTriggersNothing) {
  Bus idle(test::plain_config());
  EXPECT_FALSE(idle.network.io().trigger_camera(Duration::from_us(100)));
  EXPECT_FALSE(idle.network.io().estop_closed());
  EXPECT_FALSE(idle.network.io().interlock_closed());
}

}  // namespace
}  // namespace lf::canopen
