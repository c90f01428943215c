#include "hal/vehicle/vehicle_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "firmware/arm/actuator.hpp"
#include "hal/config/homing_file.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/motor.hpp"
#include "shared/input_error.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tests/unit/vehicle/config_problems.hpp"

namespace lf::hal {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(VehicleConfig, TheShippedOnesAreValid) {
  const std::string folder = LANTERNFISH_SOURCE_DIR "/shared/vehicle/";
  EXPECT_THAT(problems_of(folder + "vcan.yaml"), IsEmpty());
  // The vehicle's zeros are in a file that its package makes; a machine that builds this has none.
  for (const std::string& problem : problems_of(folder + "vehicle.yaml"))
    EXPECT_THAT(problem, HasSubstr("there is no /var/lib/lanternfish/homing.yaml"));
}

TEST(VehicleConfig, AnEmptyFileIsTheDefault) {
  const TemporaryFolder folder;
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", ""));
  EXPECT_EQ(config.interface, "can0");
  EXPECT_EQ(config.core.controller.mission.tasks.size(), 4u);
  EXPECT_EQ(config.core.scan.match_window.ns(), 2'000'000);
}

TEST(VehicleConfig, EveryProblemIsListedWithItsLine) {
  const TemporaryFolder folder;
  const std::string file = folder.write("v.yaml",
                                        "can: {interfce: can0, transmit_deadline_ms: soon}\n"
                                        "camera:\n"
                                        "  source: rnig\n"
                                        "  gain: -4\n"
                                        "  gain: 3\n"
                                        "  ring_bytes: 5000\n"
                                        "  match_window_us: 20000\n"
                                        "tasks: [{turn_valve: {to_deg: 900}}]\n"
                                        "panel: {ahead_m: 0.7}\n"
                                        "arm: {urdf: no_such.urdf}\n"
                                        "safety: {limits: nothing.yaml}\n"
                                        "realtime: 7\n"
                                        "operator: {socket: \"\"}\n"
                                        "wheels: 4\n");
  EXPECT_THAT(
      problems_of(file),
      ElementsAre(EndsWith("v.yaml:1: unknown key 'can.interfce'; did you mean 'can.interface'?"),
                  HasSubstr("v.yaml:1: 'can.transmit_deadline_ms' takes a number, not 'soon'"),
                  HasSubstr("v.yaml:3: 'camera.source' has no 'rnig'; did you mean 'ring'?"), HasSubstr("v.yaml:4: 'camera.gain' is -4"),
                  HasSubstr("v.yaml:5: 'camera.gain' is given twice"), HasSubstr("v.yaml:8: 'tasks[0].turn_valve.to_deg' is 900"),
                  HasSubstr("v.yaml:12: 'realtime' takes a group of keys, not '7'"), HasSubstr("v.yaml:14: unknown key 'wheels'"),
                  HasSubstr("'camera.ring_bytes' is not a multiple of 4096"), HasSubstr("'operator.socket' takes a path"),
                  HasSubstr("'camera.match_window_us' is half the time"), HasSubstr("no_such.urdf"), HasSubstr("nothing.yaml"),
                  HasSubstr("out of the arm's reach")));
}

// One overrules the other in silence.
TEST(VehicleConfig, ACalibrationBesideWhatItOverrulesIsRefused) {
  const TemporaryFolder folder;
  const auto with = [&](const std::string& more) {
    return problems_of(folder.write("v.yaml", "camera: {calibration: none.yaml" + more + "}\n"));
  };
  EXPECT_THAT(with(""), ElementsAre(HasSubstr("none.yaml")));
  EXPECT_THAT(with(", focal_px: 700"), testing::Contains(HasSubstr("'camera.calibration' stands beside 'camera.focal_px'")));
  EXPECT_THAT(with(", distortion: [0, 0, 0, 0, 0]"),
              testing::Contains(HasSubstr("'camera.calibration' stands beside 'camera.distortion'")));
  // The printed file has the defaults of both beside the calibration.
  const std::string printed = print_vehicle_config(folder.write("v.yaml", "camera: {calibration: none.yaml}\n"));
  EXPECT_THAT(printed, HasSubstr("focal_px: "));
  EXPECT_THAT(problems_of(folder.write("again.yaml", printed)), ElementsAre(HasSubstr("none.yaml")));
}

TEST(VehicleConfig, FoldersThatNobodyNamesAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(problems_of(folder.write("v.yaml", "log: {folder: \"\"}\nlock_folder: \"\"\n")),
              ElementsAre(HasSubstr("'log.folder' names no folder"), HasSubstr("'lock_folder' names no folder")));
}

// CANopen's numbers are hexadecimal in every manual.
TEST(VehicleConfig, WholeNumbersMayBeHexadecimal) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& number) { return problems_of(folder.write("v.yaml", "outputs: {node: " + number + "}\n")); };
  EXPECT_EQ(load_vehicle_config(folder.write("v.yaml", "outputs: {node: 0x10}\n")).machine.drives.output_node, 16);
  EXPECT_EQ(load_vehicle_config(folder.write("v.yaml", "outputs: {node: 0X1f}\n")).machine.drives.output_node, 31);
  for (const char* beyond : {"0x80", "0xFFFFFFFF", "0x100000000000000010", "0x8000000000000010"})
    EXPECT_THAT(told(beyond), ElementsAre(HasSubstr("out of its range 1 to 126"))) << beyond;
  for (const char* wrong : {"0x", "0xG", "0x1.8", "-0x10", "0x-1", "\"0x10\""})
    EXPECT_THAT(told(wrong), ElementsAre(HasSubstr("takes a whole number"))) << wrong;
  EXPECT_THAT(problems_of(folder.write("v.yaml", "panel: {ahead_m: 0x1}\n")), ElementsAre(HasSubstr("takes a number, not '0x1'")));
}

TEST(VehicleConfig, ACapThatIsTooLowToPressIsRefused) {
  const TemporaryFolder folder;
  const std::string low = "panel: {button_height_m: 0.012}\n";
  const auto told = ::testing::Contains(HasSubstr("'panel.button_height_m' is 0.012: with 'panel.button_stroke_m' at 0.005"));
  EXPECT_THAT(problems_of(folder.write("press.yaml", low + "tasks: [{press_buttons: {order: [left]}}]\n")), told);
  EXPECT_THAT(problems_of(folder.write("turn.yaml", low + "tasks: [{turn_valve: {to_deg: 90}}]\n")), ::testing::Not(told));
}

TEST(VehicleConfig, APanelsFileIsWhatItsTasksName) {
  const TemporaryFolder folder;
  folder.write("mine.yaml",
               "version: 1\nvalves: [{name: V1, at_m: [0, 0]}, {name: V2, at_m: [0.13, 0]}]\nbuttons: [{name: B1, at_m: [-0.067, 0.141]}]\n"
               "markers: [{id: 7, at_m: [-0.17, 0.072]}, {id: 9, at_m: [0.27, 0.072]}]\n");
  const auto file = [&](const std::string& panel, const std::string& tasks) {
    return folder.write("v.yaml", "panel: {file: mine.yaml" + panel + "}\ntasks: [" + tasks + "]\n");
  };
  const VehicleConfig config =
      load_vehicle_config(file(", down_m: 0.6", "{press_buttons: {order: [B1]}}, {turn_valve: {valve: V2, to_deg: -45}}"));
  EXPECT_THAT(config.machine.survey.names.valves, ElementsAre("V1", "V2"));
  const mission::MissionConfig& mission = config.core.controller.mission;
  EXPECT_EQ(mission.layout.valves.size(), 2u);
  EXPECT_EQ(mission.layout.buttons.size(), 1u);
  EXPECT_EQ(mission.layout.nominal_z_m, 0.6);
  ASSERT_EQ(config.core.controller.markers.size(), 2u);
  EXPECT_EQ(config.core.controller.markers[1].id, 9);
  EXPECT_EQ(config.core.controller.markers[1].panel_from_tag.translation().x(), 0.27);
  ASSERT_EQ(mission.tasks.size(), 2u);
  EXPECT_EQ(mission.tasks[0].button, 0);
  EXPECT_EQ(mission.tasks[1].valve, 1);
  using ::testing::Contains;
  EXPECT_THAT(problems_of(file("", "{turn_valve: {to_deg: 45}}")),
              Contains(HasSubstr("'turn_valve.valve' is missing: the panel has V1, V2")));
  EXPECT_THAT(problems_of(file("", "{turn_valve: {valve: V3, to_deg: 45}}")),
              Contains(HasSubstr("'turn_valve.valve': the panel has no valve 'V3'")));
  EXPECT_THAT(problems_of(file("", "{press_buttons: {order: [left]}}")),
              Contains(HasSubstr("'press_buttons.order': the panel has no button 'left'; it has B1")));
  EXPECT_THAT(problems_of(file(", handle_length_m: 0.11", "{turn_valve: {valve: V1, to_deg: 45}}")),
              ElementsAre(HasSubstr("'panel.handle_length_m' is of the docked mission's panel")));
  EXPECT_THAT(problems_of(folder.write("v.yaml", "tasks: [{turn_valve: {valve: V1, to_deg: 45}}]\n")),
              Contains(HasSubstr("the panel has no valve 'V1'; it has valve")));
}

// What its maker says that a valve takes is held against the hand, though the simulated one takes less.
TEST(VehicleConfig, AValveThatTakesMoreThanTheArmGivesIsRefused) {
  const TemporaryFolder folder;
  const auto told = [&](const char* torque_nm) {
    folder.write("mine.yaml", std::string("version: 1\nvalves: [{name: V1, at_m: [0, 0], torque_nm: ") + torque_nm +
                                  "}, {name: V2, at_m: [0.13, 0], torque_nm: 100000}]\nmarkers: [{id: 7, at_m: [-0.17, 0.072]}]\n");
    return problems_of(folder.write("v.yaml", "panel: {file: mine.yaml}\ntasks: [{turn_valve: {valve: V1, to_deg: 45}}]\n"));
  };
  EXPECT_THAT(told("3"), IsEmpty()) << "V2 is not to be turned";
  EXPECT_THAT(told("400"),
              ElementsAre(::testing::AllOf(HasSubstr("valve V1 needs 400 N m, the arm gives "), HasSubstr("See 'valves.V1.torque_nm'"))));
}

TEST(VehicleConfig, TheCoreIsToldTheFilesArm) {
  const TemporaryFolder folder;
  std::ifstream shipped(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  std::string urdf{std::istreambuf_iterator<char>(shipped), std::istreambuf_iterator<char>()};
  const std::string counts = "166667";
  ASSERT_NE(urdf.find(counts), std::string::npos);
  folder.write("mine.urdf", urdf.replace(urdf.find(counts), counts.size(), "250000"));
  std::ifstream limits(LANTERNFISH_SOURCE_DIR "/shared/safety/limits.yaml");
  folder.write("limits.yaml", std::string{std::istreambuf_iterator<char>(limits), std::istreambuf_iterator<char>()});
  folder.write("machine.yaml",
               "version: 1\narm: {urdf: mine.urdf, park_rad: [0, 0.55, 1.9, 0]}\nsafety: {limits: limits.yaml}\ncamera: {down_deg: 43}\n");
  for (const char* told : {"arm: {urdf: mine.urdf, park_rad: [0, 0.55, 1.9, 0]}\ncamera: {down_deg: 43}\n", "machine: machine.yaml\n",
                           "machine: machine.yaml\ncamera: {down_deg: 43}\n"}) {
    std::vector<std::string> problems;
    const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", told), problems);
    EXPECT_THAT(problems, IsEmpty()) << told;
    EXPECT_EQ(config.core.controller.arm.joint(arm5e_joint::elbow).actuator.counts_per_m, 250000);
    EXPECT_EQ(config.core.scan.arm.joint(arm5e_joint::elbow).actuator.counts_per_m, 250000);
    EXPECT_EQ(config.core.controller.mission.park_rad[1], 0.55);
    EXPECT_EQ(config.machine.camera.down_deg, 43);
    // And the drive's own limits are that arm's counts.
    const double upper_rad = config.core.controller.limits.joints[2].max_rad;
    EXPECT_EQ(config.core.controller.network.drives[2].max_counts,
              arm::counts_from_rad(config.core.controller.arm.joint(arm5e_joint::elbow), upper_rad));
  }
}

// A line left over from before the machine's file would move another arm.
TEST(VehicleConfig, AKeyThatContradictsTheMachinesFileIsRefused) {
  const TemporaryFolder folder;
  folder.write("machine.yaml", "version: 1\ncamera: {down_deg: 43}\n");
  EXPECT_THAT(
      problems_of(folder.write("v.yaml", "machine: machine.yaml\ncamera: {down_deg: 44}\n")),
      ElementsAre(::testing::AllOf(HasSubstr("'camera.down_deg' is 44 here and 43 in "), HasSubstr("leave it out in one of them"))));
  EXPECT_TRUE(stop_socket(folder.write("w.yaml", "machine: gone.yaml\n")).told) << "a stop reads no other file";
}

TEST(VehicleConfig, AMachinesFileIsRefusedWithItsOwnName) {
  const TemporaryFolder folder;
  folder.write("machine.yaml", "version: 1\ncamera: {down: 43}\n");
  EXPECT_THAT(problems_of(folder.write("v.yaml", "machine: machine.yaml\n")), ::testing::Contains(HasSubstr("machine.yaml:2: ")));
  EXPECT_THAT(problems_of(folder.write("w.yaml", "machine: gone.yaml\n")),
              ::testing::Contains(HasSubstr("'machine': there is no gone.yaml")));
}

// What is missing hides nothing else.
TEST(VehicleConfig, AMissingFileOfTheMissionsLimitsHidesNoOtherProblem) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      problems_of(folder.write("v.yaml", "safety: {mission_limits: gone.yaml}\npanel: {ahead_m: 0.7}\n")),
      ::testing::AllOf(::testing::Contains(HasSubstr("there is no gone.yaml")), ::testing::Contains(HasSubstr("out of the arm's reach"))));
}

TEST(VehicleConfig, TextThatIsNoYamlIsToldWithItsLine) {
  const TemporaryFolder folder;
  EXPECT_THAT(problems_of(folder.write("v.yaml", "can: [\n")), ElementsAre(HasSubstr("v.yaml:2: not YAML")));
  EXPECT_THAT(problems_of(folder.write("w.yaml", "- a\n- b\n")),
              ElementsAre(HasSubstr("w.yaml:1: a vehicle's configuration is a group of keys")));
  EXPECT_THAT(problems_of(folder / "none.yaml"), ElementsAre(HasSubstr("none.yaml: No such file")));
}

TEST(VehicleConfig, AProfileOfAllJointsThatIsNotThereIsToldOnce) {
  const TemporaryFolder folder;
  EXPECT_THAT(problems_of(folder.write("v.yaml", "drives: {profile: epos5, jaw: {profile: elmo_glod}}\n")),
              ElementsAre(HasSubstr("drives.profile: no drive profile 'epos5'; did you mean 'epos4'"),
                          HasSubstr("drives.jaw.profile: no drive profile 'elmo_glod'; did you mean 'elmo_gold'")));
}

// A motor's rated current is written to the drive: nobody's motor is that of a default.
// A motor of 919 A at a drive whose 16 bits end at 20 A: a grip of 252 N was not felt.
TEST(VehicleConfig, AMotorWhoseTorqueTheDriveCannotReportIsRefused) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& drives) { return problems_of(folder.write("v.yaml", "drives: {" + drives + "}\n")); };
  struct Range {
    std::string make;
    double least_a, most_a;  // 100 and 32767 / 1.1 over the make's units an ampere
  };
  for (const Range& range : {Range{"ipos", 0.1221, 36.37}, Range{"ipos4808", 0.06105, 18.18}}) {
    const auto with = [&](double rated_a) { return told("profile: " + range.make + ", rated_current_a: " + std::to_string(rated_a)); };
    for (const double rated_a : {1.01 * range.least_a, 4.2, 0.999 * range.most_a})
      EXPECT_THAT(with(rated_a), testing::Not(testing::Contains(HasSubstr("rated_current_a")))) << range.make << " " << rated_a;
    for (const double rated_a : {0.5 * range.least_a, 1.01 * range.most_a, 919.5})
      EXPECT_THAT(with(rated_a), testing::Contains(HasSubstr("reads torque for motors of"))) << range.make << " " << rated_a;
  }
  EXPECT_THAT(told("rated_current_a: 919.5"), testing::Not(testing::Contains(HasSubstr("rated_current_a"))))
      << "drives that report shares of the rating";
}

TEST(VehicleConfig, ADriveThatCountsInCurrentAsksForItsMotors) {
  const TemporaryFolder folder;
  for (const std::string make : {"elmo_gold", "ipos"}) {
    EXPECT_THAT(problems_of(folder.write("v.yaml", "drives: {profile: " + make + "}\n")), testing::Contains(HasSubstr("rated_current_a")))
        << make;
    EXPECT_THAT(problems_of(folder.write("v.yaml", "drives: {profile: " + make + ", rated_current_a: 4.2}\n")),
                testing::Not(testing::Contains(HasSubstr("rated_current_a"))))
        << make;
  }
}

// The shipped arm's elbow is rated at 26.9 N m, through a screw with a ratio of some hundred: a joint's figure in a motor's place is a hundred times off.
TEST(VehicleConfig, ARatingThatIsTheJointsAndNotTheMotorsIsRefusedWithBothNumbers) {
  const TemporaryFolder folder;
  const ArmDescription arm = load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  const ArmJoint& elbow = arm.joints[2];
  const double motor_nm = motor_of(elbow, 64).rated_torque_nm;
  ASSERT_GT(elbow.rated_torque_nm / motor_nm, 10);
  const auto with = [&](double nm) {
    return problems_of(folder.write("v.yaml", "drives: {elbow: {rated_torque_nm: " + std::to_string(nm) + "}}\n"));
  };
  EXPECT_THAT(with(elbow.rated_torque_nm),
              ElementsAre(testing::AllOf(HasSubstr("drives.elbow: 'rated_torque_nm' is "), HasSubstr("rates the joint at "),
                                         HasSubstr("State the motor's own rated torque"))));
  EXPECT_THAT(with(3.1 * motor_nm), testing::SizeIs(1));
  EXPECT_THAT(with(motor_nm / 3.1), testing::SizeIs(1));
  for (const double share : {0.4, 1.0, 2.9}) EXPECT_THAT(with(share * motor_nm), IsEmpty()) << share;
}

// An encoder's resolution in place of the arm's counts: the motor would turn slower than its joint.
// It was taken from the arm's description in silence.
TEST(VehicleConfig, ARatingThatNobodyStatesIsNoted) {
  const TemporaryFolder folder;
  const auto notes = [&](const std::string& drives) {
    return load_vehicle_config(folder.write("v.yaml", "drives: {" + drives + "}\n")).core.notes;
  };
  EXPECT_THAT(notes("profile: epos4"), IsEmpty());
  const Motor elbow = motor_of(load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf").joints[2], 64);
  EXPECT_THAT(notes("elbow: {profile: lmdrive, rated_torque_nm: " + std::to_string(elbow.rated_torque_nm) + "}"), IsEmpty());
  char assumed[64];
  std::snprintf(assumed, sizeof assumed, "description: elbow %.3g N m. ", elbow.rated_torque_nm);
  for (const char* profile : {"lmdrive", "eyou", "c5e", "ingenia", "cia402_rated"})
    EXPECT_THAT(notes(std::string("elbow: {profile: ") + profile + "}"), ElementsAre(HasSubstr(assumed))) << profile;
}

TEST(VehicleConfig, CountsThatLeaveNoGearAreRefusedWithTheReason) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      problems_of(folder.write("v.yaml", "drives: {elbow: {counts_per_rev: 1000000}}\n")),
      ElementsAre(AllOf(HasSubstr("drives.elbow: 'counts_per_rev' is 1e+06: the motor would turn 0.0"), HasSubstr("and at most "))));
  EXPECT_THAT(problems_of(folder.write("v.yaml", "drives: {elbow: {counts_per_rev: 128}}\n")), IsEmpty());
  EXPECT_THAT(problems_of(folder.write("v.yaml", "drives: {elbow: {counts_per_rev: 1.5}}\n")),
              ElementsAre(HasSubstr("At least 3 counts are needed")));
}

// 32 bits hold no such positions; without the refusal they would be held at their end, and the joint would stop short.
TEST(VehicleConfig, PositionsThatDoNotFitADrivesCountAreRefused) {
  const TemporaryFolder folder;
  folder.write("fine.yaml", "title: fine\nlike: lanternfish\nposition: {units_per_count: 1000000}\n");
  EXPECT_THAT(problems_of(folder.write("v.yaml", "drives: {elbow: {profile: fine.yaml}}\n")),
              testing::Contains(HasSubstr("drives.elbow: its profile makes 1e+06 of the drive's units of one of the arm's counts")));
}

// Of the slew 2777 counts are a radian where its screw has the least lever, of the roll 318: a count of the roll is coarser than 1 mrad.
TEST(VehicleConfig, APositionUnitTooCoarseToTellALagIsRefused) {
  const TemporaryFolder folder;
  const auto problems = [&](const std::string& joint, const std::string& scale) {
    folder.write("coarse.yaml", "title: coarse\nlike: lanternfish\nposition: {" + scale + "}\n");
    return problems_of(folder.write("v.yaml", "drives: {" + joint + ": {profile: coarse.yaml}}\n"));
  };
  EXPECT_THAT(problems("slew", "units_per_rev: 24"), IsEmpty());
  EXPECT_THAT(
      problems("slew", "units_per_rev: 23"),
      ElementsAre(AllOf(HasSubstr("drives.slew: one unit of the drive's positions is 2.78261 of the arm's counts, which is 1.002 mrad"),
                        HasSubstr("position.units_per_rev of 23.04"), HasSubstr("or more at a 'counts_per_rev' of 64"))));
  EXPECT_THAT(problems("slew", "units_per_count: 0.3"), ElementsAre(HasSubstr("position.units_per_count of 0.36")));
  for (const std::string key : {"units_per_rev", "units_per_count"}) {
    const std::string refused = problems("slew", key + ": 0.2").front(), before = "position." + key + " of ";
    const std::string advised = refused.substr(refused.find(before) + before.size(), 7);
    EXPECT_THAT(problems("slew", key + ": " + advised.substr(0, advised.find(' '))), IsEmpty()) << "what is advised is taken: " << refused;
  }
  EXPECT_THAT(problems("roll", "units_per_rev: 64"), IsEmpty());
  EXPECT_THAT(problems("roll", "units_per_rev: 63"), ElementsAre(HasSubstr("or one count where that is more")));
}

TEST(VehicleConfig, ANodeNumberUsedTwiceNamesBothThatHaveIt) {
  const TemporaryFolder folder;
  EXPECT_THAT(problems_of(folder.write("v.yaml", "drives: {jaw: {node: 3}}\n")),
              ElementsAre(HasSubstr("drives.elbow and drives.jaw have the same node number, 3")));
  EXPECT_THAT(problems_of(folder.write("v.yaml", "outputs: {node: 2}\n")),
              ElementsAre(HasSubstr("drives.shoulder and outputs have the same node number, 2")));
}

TEST(VehicleConfig, AHomingFilesFrictionIsHeldAgainstTheArms) {
  const TemporaryFolder folder;
  const Motor motor = motor_of(load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf").joints[2], 64);
  // The daemon starts all the same: commissioning the joint again is an order of the running daemon.
  const auto with = [&](const std::string& coulomb, const std::string& viscous) {
    folder.write("h.yaml",
                 "slew: {zero_counts: 3}\nelbow: {zero_counts: 7, coulomb_mnm: " + coulomb + ", viscous_mnm_s: " + viscous + "}\n");
    const config::Core core = load_vehicle_config(folder.write("v.yaml", "homing: {file: h.yaml}\n")).core;
    const auto& drives = core.controller.network.drives;
    EXPECT_TRUE(drives[0].may_have_power());
    EXPECT_EQ(drives[2].may_have_power(), core.notes.empty());
    return core.notes;
  };
  const double coulomb = 1e3 * motor.coulomb_nm, viscous = 1e3 * motor.viscous_nm_s;
  ASSERT_GT(coulomb, 0);
  const auto text = [](double value) { return std::to_string(value); };
  for (const double share : {0.0, 1.0, 3.0}) EXPECT_THAT(with(text(share * coulomb), text(share * viscous)), IsEmpty()) << share;
  for (const std::string& bad : {text(3.5 * coulomb), text(100 * coulomb)}) {
    EXPECT_THAT(with(bad, text(viscous)), ElementsAre(testing::AllOf(HasSubstr("h.yaml"), HasSubstr("'elbow.coulomb_mnm'")))) << bad;
  }
  for (const std::string bad : {"-1", ".nan"}) EXPECT_THROW((void)with(bad, text(viscous)), InputError) << bad;
  EXPECT_THAT(with(text(coulomb), text(100 * viscous)),
              ElementsAre(testing::AllOf(HasSubstr("h.yaml"), HasSubstr("'elbow.viscous_mnm_s'"))));
}

// It was missed among the shipped files, where nobody had put it.
TEST(VehicleConfig, AFileThatIsNowhereIsMissedBesideTheConfiguration) {
  const TemporaryFolder folder;
  EXPECT_THAT(problems_of(folder.write("v.yaml", "safety: {limits: mylimits.yaml}\n")),
              ElementsAre(testing::AllOf(HasSubstr("v.yaml: 'safety.limits': there is no mylimits.yaml in " + folder.path().string()),
                                         HasSubstr(" nor in "))));
}

// Named without a folder, as in `lanternfishd --config vehicle.yaml`: the folder of nothing ended the program.
TEST(VehicleConfig, AFileThatIsNowhereIsMissedBesideAConfigurationNamedWithoutAFolder) {
  const TemporaryFolder folder;
  folder.write("v.yaml", "safety: {limits: mylimits.yaml}\n");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const auto problems = problems_of("v.yaml");
  std::filesystem::current_path(before);
  EXPECT_THAT(problems, ElementsAre(HasSubstr("v.yaml: 'safety.limits': there is no mylimits.yaml in ")));
}

// Limits that were missing hid what was wrong with the profiles, and a profile's problem was told once a joint.
TEST(VehicleConfig, OneProblemHidesNoOtherAndIsToldOnce) {
  const TemporaryFolder folder;
  folder.write("mine.yaml", "title: mine\nlike: cia402\nabsent: [{object: \"1018:01\", by: vendor_limit}]\n");
  EXPECT_THAT(problems_of(folder.write("v.yaml", "drives: {profile: mine.yaml}\n")), ElementsAre(HasSubstr("'absent' names 1018:01")));
  EXPECT_THAT(problems_of(folder.write("w.yaml", "safety: {limits: gone.yaml}\ndrives: {jaw: {profile: epos5}}\n")),
              ElementsAre(HasSubstr("there is no gone.yaml"), HasSubstr("did you mean 'epos4'")));
}

TEST(VehicleConfig, LimitsWithAnotherChecksumAreRefused) {
  const TemporaryFolder folder;
  std::ifstream shipped(LANTERNFISH_SOURCE_DIR "/shared/safety/limits.yaml");
  std::string text{std::istreambuf_iterator<char>(shipped), {}};
  text.replace(text.find("max_torque_nm: 26"), 17, "max_torque_nm: 27");
  folder.write("limits.yaml", text);
  EXPECT_THAT(problems_of(folder.write("v.yaml", "safety: {limits: limits.yaml}\n")), ElementsAre(HasSubstr("checksum")));
}

TEST(VehicleConfig, TheHomingFileReachesTheDrives) {
  const TemporaryFolder folder;
  config::HomingOffsets offsets;
  offsets.zero_counts = {10, -20, 30, 0, 123456};
  offsets.known = {true, true, true, true, true};
  config::write_homing_file(folder / "homing.yaml", offsets);
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", "homing: {file: homing.yaml}\n"));
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    EXPECT_EQ(config.core.controller.network.drives[i].encoder_zero_counts, offsets.zero_counts[i]);
    EXPECT_TRUE(config.core.controller.network.drives[i].zero_known);
  }
}

// A misspelt name was taken for "the drives count from the arm's own zero".
TEST(VehicleConfig, AHomingFileThatIsNotThereIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(problems_of(folder.write("v.yaml", "homing: {file: hoaming.yaml}\n")), ElementsAre(HasSubstr("there is no hoaming.yaml")));
}

TEST(VehicleConfig, AFolderInAFilesPlaceIsNamedWithItsKey) {
  const TemporaryFolder folder;
  const std::string place = std::filesystem::canonical(folder.path()).string();
  for (const std::string key : {"arm.urdf", "safety.limits", "homing.file"})
    EXPECT_THAT(problems_of(folder.write("v.yaml", key + ": " + place + "\n")),
                ElementsAre(HasSubstr("v.yaml: '" + key + "': " + place + " is a folder, not a file")));
}

// The C++ library throws where the name of a file is too long to be one.
TEST(VehicleConfig, AHomingFileWhoseNameIsNoneIsRefused) {
  const TemporaryFolder folder;
  const std::string name(300, 'x');
  EXPECT_THAT(problems_of(folder.write("v.yaml", "homing: {file: " + name + "}\n")), ElementsAre(HasSubstr("there is no " + name)));
}

TEST(VehicleConfig, WithoutAHomingFileNoJointTakesPower) {
  const TemporaryFolder folder;
  folder.write("empty.yaml", "");
  for (const char* text : {"", "homing: {file: empty.yaml}\n"}) {
    const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", text));
    for (const canopen::DriveSetup& drive : config.core.controller.network.drives) EXPECT_FALSE(drive.may_have_power()) << text;
  }
}

TEST(VehicleConfig, AFileWithSomeJointsGivesPowerToThose) {
  const TemporaryFolder folder;
  folder.write("h.yaml", "elbow: {zero_counts: 7}\n");
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", "homing: {file: h.yaml}\n"));
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(config.core.controller.network.drives[i].may_have_power(), i == 2) << i;
}

TEST(VehicleConfig, AJointWhoseZeroIsDoubtfulTakesNoPowerAndIsNamed) {
  const TemporaryFolder folder;
  folder.write("h.yaml", "elbow: {zero_counts: 7, zero_doubtful: true}\nroll: {zero_counts: 7}\n");
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", "homing: {file: h.yaml}\n"));
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(config.core.controller.network.drives[i].may_have_power(), i == 3) << i;
  EXPECT_THAT(config.core.notes, testing::Contains(HasSubstr("the elbow's zero is doubtful")));
}

}  // namespace
}  // namespace lf::hal
