// The docked mission with drives of other makes, in their own units, over the simulated bus. Sight is given.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "hal/config/share.hpp"
#include "host_sim/devices/drive/drive_dictionary.hpp"
#include "tests/hil/rig.hpp"

namespace lf::test {
namespace {

void expect_success(Rig& rig) {
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_TRUE(rig.outcome().success) << rig.story();
  EXPECT_NEAR(deg_from_rad(rig.world().valve_angle_rad()), 90, 3);
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
