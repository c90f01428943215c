// A vehicle's file of an arm whose joints are not the default machine's: what is wrong with it is told of the arm's own joints, before anything moves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/key_listing.hpp"
#include "hal/config/key_text.hpp"
#include "hal/config/machine_file.hpp"
#include "hal/config/text_file.hpp"
#include "hal/vehicle/vehicle_config.hpp"
#include "shared/arm/arm_description.hpp"
#include "tests/unit/changed_text.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tests/unit/vehicle/config_problems.hpp"

namespace lf::hal {
namespace {

using test::TemporaryFolder;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string arms = LANTERNFISH_TEST_DATA "/arms/six_joints/";

// A robot's folder: the arm, its limits, its machine file and a vehicle's file that names it.
class AnyArmsVehicle : public testing::Test {
 protected:
  void change(const std::string& file, const std::string& what, const std::string& by) {
    std::string text = config::read_text_file(folder / file);
    test::change(text, what, by);
    folder.write(file, text);
  }

  std::vector<std::string> problems(const std::string& more = "") {
    return problems_of(folder.write("vehicle.yaml", "machine: ./six_joints.yaml\ntasks: []\n" + more));
  }

  TemporaryFolder folder;

  void SetUp() override {
    for (const char* file : {"six_joints.urdf", "limits.yaml", "six_joints.yaml"}) folder.write(file, config::read_text_file(arms + file));
  }
};

TEST_F(AnyArmsVehicle, IsAsGoodAsAnother) {
  EXPECT_THAT(problems(), IsEmpty());
  const VehicleConfig read = load_vehicle_config(folder / "vehicle.yaml");
  EXPECT_EQ(read.core.controller.network.drives.size(), 7u);
  EXPECT_EQ(read.core.controller.limits.joints.size(), 7u);
  for (const canopen::DriveSetup& drive : read.core.controller.network.drives) EXPECT_FALSE(drive.zero_known) << "nobody commissioned it";
}

TEST_F(AnyArmsVehicle, HasItsDrivesByItsJointsNames) {
  const std::string machine = config::read_text_file(folder / "six_joints.yaml");
  folder.write("six_joints.yaml", machine + "drives: {twist: {node: 21}}\n");
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_EQ(load_vehicle_config(folder / "vehicle.yaml").core.controller.network.drives[3].node, 21);
  folder.write("six_joints.yaml", machine + "drives: {elbow: {node: 21}}\n");
  EXPECT_THAT(problems(), Contains(HasSubstr("unknown key 'drives.elbow'")));
  folder.write("six_joints.yaml", machine + "drives: {twist: {node: 9}, pitch: {node: 9}}\n");
  EXPECT_THAT(problems(), Contains(HasSubstr("twist and drives.pitch have the same node number, 9")));
}

TEST_F(AnyArmsVehicle, WithoutAFoldedPoseIsRefused) {
  change("six_joints.yaml", "  park_rad: [0, 0.6, -1.3, 0, 0.4, 0]\n", "");
  EXPECT_THAT(problems(), Contains(HasSubstr("'arm.park_rad' is missing")));
}

TEST_F(AnyArmsVehicle, FoldedWhereSomethingIsIsRefused) {
  const std::string machine = config::read_text_file(folder / "six_joints.yaml");
  const auto folded = [&](const char* pose) {
    folder.write("six_joints.yaml", machine);
    change("six_joints.yaml", "[0, 0.6, -1.3, 0, 0.4, 0]", pose);
    return problems();
  };
  EXPECT_THAT(folded("[0, -0.25, -1.9, 0, -1.4, 0]"),
              Contains(AllOf(HasSubstr("'arm.park_rad': folded up"), HasSubstr("vehicle.capsules_m"))));
  EXPECT_THAT(folded("[0, 1.0, -0.2, 0, 0.8, 0]"), Contains(AllOf(HasSubstr("'arm.park_rad': folded up"), HasSubstr("the panel's"))));
}

TEST_F(AnyArmsVehicle, GivenAJobOutOfItsReachIsRefused) {
  EXPECT_THAT(problems(), IsEmpty());
  std::string text = config::read_text_file(folder / "vehicle.yaml");
  test::change(text, "tasks: []\n", "");
  EXPECT_THAT(problems_of(folder.write("jobs.yaml", text)),
              Contains(HasSubstr("the valve is out of the arm's reach at its nominal place")));
}

TEST_F(AnyArmsVehicle, WithLimitsOfAnotherArmIsToldSo) {
  change("six_joints.yaml", "limits: limits.yaml", "limits: safety/limits.yaml");
  EXPECT_THAT(problems(), Contains(AllOf(HasSubstr("these limits are of another arm"), HasSubstr("azimuth, lift"))));
}

TEST_F(AnyArmsVehicle, WithZerosOfAnotherArmIsToldSo) {
  folder.write("zeros.yaml", config::read_text_file(LANTERNFISH_SOURCE_DIR "/shared/homing/simulator.yaml"));
  EXPECT_THAT(problems("homing: {file: zeros.yaml}\n"), Contains(HasSubstr("these zeros are of another arm")));
}

// One sentence for the arm, and none of the joints that nobody knows then.
TEST_F(AnyArmsVehicle, WhoseUrdfCannotBeReadIsToldWhyAndNothingElse) {
  change("six_joints.urdf", "<joint name=\"lift\" type=\"revolute\">", "<joint name=\"lift\" type=\"prismatic\">");
  folder.write("six_joints.yaml", config::read_text_file(folder / "six_joints.yaml") + "drives: {twist: {node: 21}}\n");
  EXPECT_THAT(problems(), ElementsAre(AllOf(HasSubstr("six_joints.urdf:"), HasSubstr("joint 'lift' must be of type revolute"))));
}

struct BadArm {
  const char *what, *by, *says;
};

TEST_F(AnyArmsVehicle, OfAFormThatTheCoreCannotKeepClearIsRefused) {
  const std::vector<BadArm> bad{
      {"<collision><origin xyz=\"0 0 0.02\"/><geometry><cylinder radius=\"0.045\"",
       "<collision><origin xyz=\"0.12 0 0.02\"/><geometry><cylinder radius=\"0.045\"", "may reach 150 mm"},
      {"<collision><origin xyz=\"0.025 0 0\"/><geometry><box size=\"0.06 0.05 0.05\"/></geometry></collision>", "", "has no <collision>"},
  };
  for (const BadArm& arm : bad) {
    SCOPED_TRACE(arm.says);
    SetUp();
    change("six_joints.urdf", arm.what, arm.by);
    EXPECT_THAT(problems(), Contains(HasSubstr(arm.says)));
  }
}

// Its first joint's name says of which form an arm is, and no other joint's does.
TEST_F(AnyArmsVehicle, MayCallAJointSlewButForTheFirst) {
  const auto renamed = [&](const std::string& joint) {
    SetUp();
    for (const char* file : {"six_joints.urdf", "limits.yaml"}) {
      std::string text = config::read_text_file(folder / file);
      for (const std::string& quoted : {"\"" + joint + "\"", joint + ":"}) {
        for (std::size_t at = text.find(quoted); at != std::string::npos; at = text.find(quoted))
          text.replace(at, quoted.size(), quoted.front() == '"' ? "\"slew\"" : "slew:");
      }
      folder.write(file, text);
    }
    return problems();
  };
  EXPECT_THAT(renamed("twist"), IsEmpty());
  EXPECT_THAT(renamed("azimuth"), Contains(HasSubstr("no <joint> named 'shoulder': after a first joint of the name 'slew' come")));
}

// Names that stand beside a joint's in limits, drives or faults, or that no key could be.
TEST_F(AnyArmsVehicle, WithJointsThatCannotBeKeysIsRefused) {
  for (const std::string name : {"io", "all", "profile", "1st", "a b", "x.y", ""}) {
    SCOPED_TRACE(name);
    SetUp();
    std::string text = config::read_text_file(folder / "six_joints.urdf");
    for (std::size_t at = text.find("\"twist\""); at != std::string::npos; at = text.find("\"twist\"", at))
      text.replace(at, 7, "\"" + name + "\"");
    folder.write("six_joints.urdf", text);
    EXPECT_THAT(problems(), Contains(HasSubstr("a joint's name is a letter")));
  }
}

// `lanternfishd config` and `lanternfish new` write it out: the keys of seven drives beside the defaults of five.
TEST_F(AnyArmsVehicle, IsWrittenOutAndReadAgain) {
  config::Machine machine, usual;
  std::vector<std::string> problems;
  config::read_machine_file(folder / "six_joints.yaml", machine, problems);
  EXPECT_THAT(problems, IsEmpty());
  const std::string text = config::key_listing(config::machine_keys(machine), config::machine_keys(usual));
  EXPECT_THAT(text, AllOf(HasSubstr("twist:"), Not(HasSubstr("elbow:"))));
  config::Machine again;
  config::read_machine_file(folder.write("again.yaml", "version: 1\n" + text), again, problems);
  EXPECT_THAT(problems, IsEmpty());
  EXPECT_EQ(again.joints, machine.joints);
  EXPECT_EQ(again.park_rad, machine.park_rad);
}

}  // namespace
}  // namespace lf::hal
