// The docked mission with drives of other makes, in their own units, over the simulated bus. Sight is given.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "firmware/arm/actuator.hpp"
#include "hal/config/event_json.hpp"
#include "hal/config/share.hpp"
#include "hal/vehicle/status_json.hpp"
#include "host_sim/devices/drive/drive_dictionary.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/operator.hpp"
#include "tests/hil/rig.hpp"

namespace lf::test {
namespace {

void expect_success(Rig& rig) {
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_TRUE(rig.outcome().success) << rig.story();
  EXPECT_NEAR(deg_from_rad(rig.world().valve_angle_rad(0)), 90, 3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(rig.world().button(i).presses, 1u) << i;
}

class MakeOfDrive : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, MakeOfDrive,
                         testing::Values("epos4", "epos4_configured", "elmo_gold", "elmo_gold_configured", "ipos", "c5e", "ingenia",
                                         "lmdrive", "eyou", "copley"),
                         [](const auto& make) { return std::string(make.param); });

TEST_P(MakeOfDrive, FliesTheDockedMission) {
  Rig rig({std::string("drives.profile=") + GetParam()});
  expect_success(rig);
}

TEST(MixedDrives, FlyWithNodeNumbersAndPolaritiesOfTheirOwn) {
  Rig rig({"drives.slew.profile=epos4", "drives.slew.node=11", "drives.shoulder.profile=c5e", "drives.shoulder.polarity=reversed",
           "drives.elbow.profile=ipos", "drives.elbow.node=1", "drives.roll.polarity=reversed", "drives.jaw.profile=elmo_gold",
           "drives.jaw.node=40", "outputs.node=90"});
  expect_success(rig);
}

// A drive without an absolute encoder counts from 0 wherever the joint stands, until it homes. Its homing changes its zero by 1.9 rad; what the mission held
// before, or aimed at, is of the old one.
class ADriveThatHomesByItsOwnMethod : public testing::Test {
 protected:
  Rig elbow_that_homes_here(const std::vector<std::string>& overrides = {}) const {
    const auto here_is_home = [this](ControllerConfig& core) {
      canopen::DriveSetup& elbow = core.network.drives[2];
      elbow.homing_method = 35;
      elbow.home_offset_counts = arm::counts_from_rad(test::arm5e.joint(arm5e_joint::elbow), start_rad_[2]);
    };
    const auto forgetful = [](hal::SimConfig& truth) { truth.devices.drives[2].absolute_encoder = false; };
    return Rig(overrides, 1, here_is_home, forgetful);
  }
  const PerJoint<double> start_rad_ = angles_rad(Rig());
};

TEST_F(ADriveThatHomesByItsOwnMethod, MovesNoJointBeyondItsHoming) {
  {
    Rig rig = elbow_that_homes_here();
    ASSERT_TRUE(home(rig)) << rig.story();
    for (int i = 0; i < 250; ++i) {
      EXPECT_LT(farthest_apart(angles_rad(rig), start_rad_), 0.005) << "at " << i;
      rig.step();
    }
  }
  Rig rig = elbow_that_homes_here();
  rig.start();
  ASSERT_TRUE(rig.run_to(mission::Step::home)) << rig.story();
  while (rig.step_now() == mission::Step::home) {
    ASSERT_LT(farthest_apart(angles_rad(rig), start_rad_), 0.005) << rig.story();
    rig.step();
  }
  // A motion begins with a bounded jerk; a leap of the target would take the elbow along at its top speed.
  rig.run_for(0.1);
  EXPECT_LT(farthest_apart(angles_rad(rig), start_rad_), 0.005) << rig.story();
  EXPECT_EQ(rig.count(safety::Fault::following_error), 0u) << rig.story();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_TRUE(rig.outcome().success) << rig.story();
  EXPECT_NEAR(deg_from_rad(rig.world().valve_angle_rad(0)), 90, 3);
}

TEST_F(ADriveThatHomesByItsOwnMethod, IsNamedWhereItFailsAtIt) {
  Rig rehearsal = elbow_that_homes_here();
  rehearsal.start();
  ASSERT_TRUE(rehearsal.run_to(mission::Step::home)) << rehearsal.story();
  Rig rig = elbow_that_homes_here({"faults=[{at_s: " + std::to_string(rehearsal.now().s() + 0.02) + ", kind: overcurrent, node: elbow}]"});
  rig.start();
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.outcome().fault, safety::Fault::drive_fault) << rig.story();
  EXPECT_EQ(rig.outcome().code, 2);
  EXPECT_EQ(rig.outcome().step, mission::Step::home) << rig.story();
  EXPECT_LT(farthest_apart(angles_rad(rig), start_rad_), 0.005);
}

// The standard has 8A88 as "monitoring" and FF20 as "device specific". The makers' own words say that the power was taken from outside.
TEST(MixedDrives, TellTheirErrorsInTheirMakersWords) {
  const std::vector<std::string> makes{"drives.elbow.profile=epos4", "drives.roll.profile=elmo_gold", "drives.roll.node=40"};
  const scenario::Scenario scenario = scenario::load_scenario("default", makes);
  const config::ErrorTexts texts = scenario::make_nominal(scenario, false).error_texts;
  struct Case {
    std::uint8_t node;
    std::uint16_t code;
    const char* event;
    const char* reason;
  };
  for (const Case& c : {Case{3, 0x8A88, "safe torque off", "drive fault: elbow, EMCY 0x8A88 (safe torque off)"},
                        Case{40, 0xFF20, "safe torque off", "drive fault: roll, EMCY 0xFF20 (safe torque off)"},
                        Case{2, 0x8A88, "monitoring", "drive fault: shoulder, EMCY 0x8A88 (monitoring)"}}) {
    SCOPED_TRACE(c.reason);
    Rig rig(makes);
    ASSERT_TRUE(home(rig)) << rig.story();
    CanFrame emcy;
    emcy.id = 0x080u + c.node;
    emcy.length = 8;
    emcy.data[0] = static_cast<std::uint8_t>(c.code & 0xFF);
    emcy.data[1] = static_cast<std::uint8_t>(c.code >> 8);
    emcy.data[2] = 0x81;
    rig.controller().on_can(0, emcy, rig.now());
    ASSERT_TRUE(rig.run_to_end(10)) << rig.story();
    std::string told;
    for (const Event& event : rig.events()) {
      if (event.kind == Event::Kind::emcy && event.emcy == c.code) told = config::event_json(event, texts, {})["text"];
    }
    EXPECT_EQ(told, c.event);
    hal::ControlReport report;
    report.outcome = rig.outcome();
    EXPECT_EQ(hal::status_json(report, {}, texts, {})["failure"]["text"], c.reason);
  }
}

// What cannot fly never has power.
TEST(UnfitDrives, EndTheBootWithoutPower) {
  for (const char* make : {"faulhaber", "epos2"}) {
    const auto unfit = [make](hal::SimConfig& truth) {
      truth.devices.drives[2].habit = devices::find_habit(make);
      truth.devices.drives[2].dictionary =
          devices::read_dictionary(config::share_folder() / "drives" / "objects.csv", truth.devices.drives[2].habit->dictionary);
    };
    Rig rig({"drives.elbow.profile=cia402_rated"}, 1, {}, unfit);
    rig.start();
    ASSERT_TRUE(rig.run_to_end(30)) << rig.story();
    EXPECT_EQ(rig.outcome().fault, safety::Fault::boot_failed);
    for (const JointDrive& drive : rig.devices().drives()) EXPECT_TRUE(drive.released);
  }
}

}  // namespace
}  // namespace lf::test
