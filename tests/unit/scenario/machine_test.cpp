// What a scenario's robot is where `machine` names a file of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>

#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "host_sim/scenario/describe.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/input_error.hpp"
#include "tests/arm5e.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::scenario {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refusal(const std::string& scenario, const std::vector<std::string>& overrides = {}) {
  try {
    check_runnable(load_scenario(scenario, overrides));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Tasks, ThatAreNoneAreForAnOperatorAndNotForARun) {
  EXPECT_NO_THROW((void)load_scenario("default", {"tasks=[]"}));
  EXPECT_THAT(refusal("default", {"tasks=[]"}), HasSubstr("'tasks' is empty: there is nothing to do"));
}

// A robot of its own beside a scenario: an arm with a longer forearm, in a folder of its own.
class MachineKey : public testing::Test {
 protected:
  MachineKey() {
    std::string urdf = config::read_text_file(config::share_folder() / "arm" / "arm5e.urdf");
    const std::string tool = "xyz=\"0 0 0.1485\"";
    urdf.replace(urdf.find(tool), tool.size(), "xyz=\"0 0 0.1600\"");
    std::filesystem::create_directory(folder_ / "robot");
    folder_.write("robot/long.urdf", urdf);
    folder_.write("robot/limits.yaml", config::read_text_file(config::share_folder() / "safety" / "limits.yaml"));
    folder_.write("robot/machine.yaml",
                  "version: 1\narm: {urdf: long.urdf, park_rad: [0, 0.5, 1.9, 0]}\nsafety: {limits: limits.yaml}\ncamera: {down_deg: 42, "
                  "right_deg: 20}\n");
  }

  std::string with(const std::string& yaml) const { return folder_.write("mine.yaml", yaml).string(); }

  test::TemporaryFolder folder_;
};

TEST_F(MachineKey, SaysWhatTheRobotIs) {
  const Scenario s = load_scenario(with("machine: robot/machine.yaml\n"));
  EXPECT_EQ(s.arm.urdf, folder_ / "robot/long.urdf");
  EXPECT_EQ(s.camera.down_deg, 42);
  EXPECT_NEAR(s.told_arm.planar().d_m, test::arm5e.planar().d_m + 0.0115, 1e-12);
  const Nominal nominal = make_nominal(s, true);
  EXPECT_NEAR(nominal.controller.arm.planar().d_m, test::arm5e.planar().d_m + 0.0115, 1e-12);
  EXPECT_NEAR(nominal.scan.arm.planar().d_m, test::arm5e.planar().d_m + 0.0115, 1e-12) << "the cloud is made with the same arm";
  EXPECT_EQ(nominal.controller.mission.park_rad[1], 0.5);
  EXPECT_EQ(make_truth(s, draw(s, 1), nominal, 1).world.start_rad[1], 0.5) << "and there the real arm stands";
}

TEST_F(MachineKey, OfAMisspeltNameIsAnsweredWithTheNearest) {
  EXPECT_THAT(refusal("default", {"machine=ur6"}),
              HasSubstr("--set machine=ur6: 'machine': no shipped machine 'ur6'; did you mean 'ur5'?"));
  EXPECT_THAT(refusal(with("machine: oberon\n")),
              AllOf(HasSubstr("mine.yaml"), HasSubstr("no shipped machine 'oberon'"), HasSubstr("oberon7")));
  EXPECT_THAT(refusal("default", {"machine=nothing_like_it"}),
              HasSubstr("no shipped machine 'nothing_like_it'; there are arm5e, oberon7, predator, ur5, or give a file"));
}

// Two boxes and three rods, one of them around the camera and one around a lamp.
TEST_F(MachineKey, SaysWhatVehicleThereIs) {
  folder_.write("robot/other.yaml",
                "version: 1\nvehicle:\n  boxes_m: [[-0.6, 0, -0.3, 0.8, 0.5, 0.2]]\n  capsules_m: [[-0.5, 0.6, 0, -0.2, 0.6, 0, 0.1], "
                "[0.015, -0.245, 0.02, 0.015, -0.245, 0.08, 0.04], [0.1, 0.5, 0.1, 0.1, 0.5, 0.1, 0.05]]\n  lamps_m: [[0.1, 0.5, 0.1]]\n");
  const Scenario s = load_scenario(with("machine: robot/other.yaml\n"));
  const Nominal nominal = make_nominal(s, true);
  const auto truth = make_truth(s, draw(s, 1), nominal, 1);
  const std::vector<scene::Shape>& shapes = truth.world.scene[scene::OwnBodies::vehicle].shapes;
  ASSERT_GE(shapes.size(), 4u) << "those of the arm's base come first";
  const auto own = std::span(shapes).last(4);
  EXPECT_EQ(own[0].kind, scene::ShapeKind::box);
  EXPECT_EQ(own[0].size_m, Vec3(0.8, 0.5, 0.2));
  EXPECT_EQ(own[0].body_from_shape.translation(), Vec3(-0.6, 0, -0.3));
  EXPECT_EQ(own[1].kind, scene::ShapeKind::capsule);
  EXPECT_NEAR(own[1].size_m.z(), 0.3, 1e-12);
  EXPECT_NEAR((own[1].body_from_shape * Vec3(0, 0, 0.15) - Vec3(-0.2, 0.6, 0)).norm(), 0, 1e-12);
  EXPECT_TRUE(own[0].visible && own[1].visible);
  EXPECT_FALSE(own[2].visible) << "the camera looks out of it";
  EXPECT_FALSE(own[3].visible) << "and the lamp shines out of it";
  for (const scene::Shape& shape : own) EXPECT_TRUE(shape.collides);
  ASSERT_EQ(truth.optics.lamps.size(), 1u);
  EXPECT_EQ(truth.optics.lamps[0].body_from_lamp.translation(), Vec3(0.1, 0.5, 0.1));
}

TEST_F(MachineKey, WithoutAVehicleKeepsTheDefaultOne) {
  const auto vehicle_of = [](const Scenario& s) {
    return make_truth(s, draw(s, 1), make_nominal(s, true), 1).world.scene[scene::OwnBodies::vehicle].shapes.size();
  };
  EXPECT_EQ(vehicle_of(load_scenario(with("machine: robot/machine.yaml\n"))), vehicle_of(load_scenario("default")));
}

TEST_F(MachineKey, IsOverruledByTheScenariosOwnKeys) {
  const Scenario s = load_scenario(with("machine: robot/machine.yaml\ncamera: {down_deg: 44}\n"), {"arm.park_rad=[0.1, 0.6, 1.9, 0]"});
  EXPECT_EQ(s.camera.down_deg, 44);
  EXPECT_EQ(s.camera.right_deg, 20);
  EXPECT_THAT(s.arm.park_rad, testing::ElementsAre(0.1, 0.6, 1.9, 0));
}

TEST_F(MachineKey, MayBeGivenAsAnOverride) {
  const Scenario s = load_scenario("default", {"machine=" + (folder_ / "robot/machine.yaml")});
  EXPECT_EQ(s.camera.down_deg, 42);
  EXPECT_EQ(s.arm.urdf, folder_ / "robot/long.urdf");
}

// A scenario that spells out all of its keys would hide the machine.
TEST_F(MachineKey, OfAnOverrideOverrulesWhatTheScenarioSays) {
  const std::string spelled_out = scenario_yaml(load_scenario("default"));
  const Scenario s = load_scenario(
      with(spelled_out), {"camera.down_deg=40", "machine=\"" + (folder_ / "robot/machine.yaml") + "\"", "laser.fan_half_angle_deg=41"});
  EXPECT_EQ(s.arm.urdf, folder_ / "robot/long.urdf");
  EXPECT_EQ(s.camera.down_deg, 42) << "it comes after the first override";
  EXPECT_EQ(s.laser.fan_half_angle_deg, 41) << "and before the last";
  EXPECT_THAT(refusal("default", {"machine=nowhere.yaml"}),
              HasSubstr("--set machine=nowhere.yaml: 'machine': there is no nowhere.yaml here"));
  EXPECT_THAT(refusal("default", {"machine=" + folder_.path().string() + "/robot"}), HasSubstr("is a folder"));
}

TEST_F(MachineKey, OfTheShippedFileChangesNothing) {
  for (const char* name : {"arm5e", "machines/arm5e.yaml"}) {
    Scenario shipped = load_scenario("default", {std::string("machine=") + name});
    shipped.machine.clear();
    EXPECT_EQ(scenario_yaml(shipped), scenario_yaml(load_scenario("default")));
  }
}

TEST_F(MachineKey, IsRefusedWithItsOwnFilesAndLines) {
  EXPECT_THAT(refusal(with("machine: robot/machin.yaml\n")),
              AllOf(HasSubstr("mine.yaml: 'machine'"), HasSubstr("there is no robot/machin.yaml")));
  folder_.write("robot/bad.yaml", "version: 1\ncamera:\n  down: 42\n");
  EXPECT_THAT(refusal(with("machine: robot/bad.yaml\nwater: {attenuation: 1}\n")),
              AllOf(HasSubstr("robot/bad.yaml:3: "), HasSubstr("mine.yaml:2: ")))
      << "all problems of both files";
}

TEST_F(MachineKey, OfAnArmThatDoesNotFitIsRefusedBeforeItMoves) {
  EXPECT_THAT(refusal(with("arm: {park_rad: [0, 0.6, 1.9]}\n")), HasSubstr("'arm.park_rad' takes 4 numbers"));
  EXPECT_THAT(refusal(with("arm: {park_rad: [0, 0.6, 2.5, 0]}\n")), HasSubstr("'arm.park_rad' has 2.5 for the elbow"));
  folder_.write("robot/folded.yaml", "version: 1\narm: {park_rad: [0, 0.6, 2.5, 0]}\n");
  EXPECT_THAT(refusal(with("machine: robot/folded.yaml\n")),
              AllOf(HasSubstr("with machine robot/folded.yaml"), HasSubstr("2.5 for the elbow")));
  EXPECT_THAT(refusal(with("arm: {urdf: nowhere.urdf}\n")), HasSubstr("'arm.urdf': there is no nowhere.urdf"));
}

// The shipped arm with one text of its URDF replaced, under the ARM 5E's limits.
TEST_F(MachineKey, OfAnArmThatItsLimitsDoNotFitIsRefused) {
  const std::string shipped = config::read_text_file(config::share_folder() / "arm" / "arm5e.urdf");
  const auto told = [&](const std::string& was, const std::string& is) {
    std::string urdf = shipped;
    EXPECT_NE(urdf.find(was), std::string::npos) << was;
    folder_.write("other.urdf", urdf.replace(urdf.find(was), was.size(), is));
    return refusal(with("arm: {urdf: other.urdf}\n"));
  };
  EXPECT_EQ(told("lower=\"0\"", "lower=\"0.0\""), "");
  EXPECT_THAT(told("rated_torque_nm=\"20\"", "rated_torque_nm=\"19\""), "");
  EXPECT_THAT(told("lower=\"-1.5708\"", "lower=\"-0.7\""), HasSubstr("the arm's own stroke is -0.7 to"));
  EXPECT_THAT(told("effort=\"80\" velocity=\"0.36\"", "effort=\"80\" velocity=\"0.1\""),
              HasSubstr("'joints.slew.max_speed_rad_s' is 0.42"));
  EXPECT_THAT(told("acceleration_rad_s2=\"0.5\"", "acceleration_rad_s2=\"0.05\""), HasSubstr("its shoulder takes 3.6 s to stop"));
  EXPECT_THAT(told("lower=\"-3.141592653589793\" upper=\"3.141592653589793\"", "lower=\"-0.5\" upper=\"0.5\""),
              AllOf(HasSubstr("cannot be turned toward 90"), HasSubstr("the wrist's roll goes from -29 to 29 deg")));
  std::string strong = shipped;
  const std::string jaw = "effort=\"20\"";
  for (std::size_t at = strong.find(jaw); at != std::string::npos; at = strong.find(jaw)) strong.replace(at, jaw.size(), "effort=\"30\"");
  folder_.write("other.urdf", strong);
  EXPECT_THAT(refusal(with("arm: {urdf: other.urdf}\n")), HasSubstr("the jaw grips with its drive's peak torque, 30 N m"));
}

// The elbow's angle after the drives have been without power for so long, the arm stretched level before the vehicle.
double elbow_moves_rad(const std::string& holding) {
  const Scenario s = load_scenario("default", {"drives.elbow.holding=" + holding});
  hal::SimConfig truth = make_truth(s, draw(s, 1), make_nominal(s, true), 1);
  truth.world.start_rad[1] = 0.1, truth.world.start_rad[2] = 0.1;
  truth.world.base_from_panel.translation().x() += 2;  // out of its way
  world::World world(truth.world);
  JointDrives drives;
  for (auto& drive : drives) drive.released = true;
  world.set_drives(drives);
  for (int step = 0; step < 2000; ++step) world.step();
  return std::abs(world.readings()[2].position_rad - 0.1);
}

TEST(Holding, TheSimulatedArmSinksWhereNothingHoldsIt) {
  EXPECT_LT(elbow_moves_rad("gear"), 0.005);
  EXPECT_GT(elbow_moves_rad("nothing"), 0.05);
}

TEST(Holding, ABrakeThatTheDriveHasNotIsRefused) {
  EXPECT_THAT(refusal("default", {"drives.elbow.holding=brake"}),
              AllOf(HasSubstr("drives.elbow.holding is brake, and the profile 'lanternfish' has none"), HasSubstr("like: lanternfish")));
  EXPECT_EQ(refusal("default", {"drives.elbow.holding=brake", "drives.elbow.profile=epos4"}), "");
}

}  // namespace
}  // namespace lf::scenario
