// What `lanternfishd --check` and `doctor` say of folders, users and files that a configuration names, on this very machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "hal/vehicle/doctor/examination.hpp"
#include "hal/vehicle/instance_lock.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::hal::doctor {
namespace {

using testing::HasSubstr;

Examinations bad_of(const VehicleConfig& config) {
  Examinations all = examine(config);
  std::erase_if(all, [](const Examination& one) { return one.grade != Grade::bad; });
  return all;
}

std::string said_of(const Examinations& findings, const std::string& key) {
  const auto found = std::find_if(findings.begin(), findings.end(), [&](const Examination& one) { return one.key == key; });
  return found == findings.end() ? "nothing" : found->found + "; " + found->remedy;
}

// Each of these was "sound".
TEST(Doctor, NamesWhatIsNotThere) {
  const test::TemporaryFolder folder;
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml",
                                                                "can: {interface: can99}\n"
                                                                "camera: {device: /dev/video77}\n"
                                                                "operator: {operators: [nobody-of-this-name, \"@no-such-group\"]}\n"
                                                                "estop: {input: /sys/class/gpio/no/value}\n"
                                                                "realtime: {cpu: 1000, vision_cpu: 0}\n"
                                                                "log: {folder: /proc/lanternfish}\n"
                                                                "lock_folder: /nowhere/lock\n"));
  const Examinations found = bad_of(config);
  EXPECT_THAT(said_of(found, "can.interface"), HasSubstr("no interface can99"));
  EXPECT_THAT(said_of(found, "camera.device"), HasSubstr("/dev/video77"));
  EXPECT_THAT(said_of(found, "operator.operators"), HasSubstr("no user nobody-of-this-name"));
  EXPECT_THAT(said_of(found, "log.folder"), HasSubstr("nothing can be written"));
  EXPECT_EQ(said_of(found, "lock_folder"), "/nowhere/lock is not there; `mkdir /nowhere/lock`, or name another place");
  EXPECT_THAT(said_of(found, "homing.file"), HasSubstr("no file is named for the zeros of slew, shoulder, elbow, roll, jaw"));
  EXPECT_THAT(said_of(found, "estop.input"), HasSubstr("/sys/class/gpio/no/value: No such file"));
  EXPECT_THAT(said_of(found, "realtime.cpu"), HasSubstr("there is no processor 1000"));
  EXPECT_EQ(said_of(found, "realtime.vision_cpu"), "nothing");
  EXPECT_EQ(std::count_if(found.begin(), found.end(), [](const Examination& one) { return one.key == "operator.operators"; }), 2);
}

TEST(Doctor, ALockFolderThatCannotBeMadeIsNotToBeMade) {
  const test::TemporaryFolder folder;
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", "lock_folder: /proc/x\n"));
  EXPECT_EQ(said_of(bad_of(config), "lock_folder"), "/proc/x is not there; name another place");
}

// A file that can be read and says nothing of the chain was taken for one that does.
TEST(Doctor, AnEstopInputThatReadsNeitherZeroNorOneIsTold) {
  const test::TemporaryFolder folder;
  const auto said = [&](const std::string& input) {
    return said_of(bad_of(load_vehicle_config(folder.write("v.yaml", "estop: {input: " + input + "}\n"))), "estop.input");
  };
  EXPECT_THAT(said(folder.path().string()), HasSubstr("is a folder"));
  EXPECT_THAT(said(folder.write("name", "lantern\n")), HasSubstr("reads neither 0 nor 1"));
  EXPECT_THAT(said(folder.write("empty", "")), HasSubstr("reads neither 0 nor 1"));
  // An analogue channel's value, and two inputs in one file.
  for (const char* text : {"1023\n", "12", "11", "01", "1\n\n"})
    EXPECT_THAT(said(folder.write("more", text)), HasSubstr("reads neither 0 nor 1")) << text;
  for (const char* text : {"1\n", "1", "0\n", "0"}) EXPECT_EQ(said(folder.write("value", text)), "nothing") << text;
}

TEST(Doctor, SaysNothingOfWhatIsThere) {
  const test::TemporaryFolder folder;
  const std::string place = folder.path().string();
  const VehicleConfig config = load_vehicle_config(
      folder.write("v.yaml", "can: {interface: lo}\ncamera: {source: none}\noperator: {operators: [root, \"@root\"], socket: " + place +
                                 "/run/s}\nlog: {folder: " + place + "/log, file_mb: 1, keep: 2}\nlock_folder: " + place +
                                 "\nrealtime: {priority: 0, lock_memory: false}\nhoming: {file: homing/simulator.yaml}\n"));
  const Examinations found = bad_of(config);
  // A kernel without CAN says so first.
  const bool has_can = access("/proc/net/can", F_OK) == 0;
  ASSERT_EQ(found.size(), has_can ? 1u : 2u);
  EXPECT_THAT(said_of(found, "can"), HasSubstr(has_can ? "nothing" : "gives no CAN socket"));
  EXPECT_THAT(said_of(found, "can.interface"), HasSubstr("lo is no CAN interface"));
}

TEST(Doctor, TellsWhereTheLockOfAnEarlierDaemonIsInTheWay) {
  const test::TemporaryFolder folder;
  VehicleConfig config;
  config.lock_folder = folder.path().string();
  config.interface = "can7";
  const auto lock = [&] {
    Examinations found;
    examine_places(config, {}, found);
    return said_of(found, "lock_folder");
  };
  EXPECT_THAT(lock(), HasSubstr(" can be written"));
  std::filesystem::create_directory(InstanceLock::file_of(config.lock_folder, "can7"));  // nobody opens that as a file, not even root
  EXPECT_THAT(lock(), HasSubstr("is no file"));
}

TEST(Doctor, TellsAFileThatStandsWhereTheOperatorsSocketBelongs) {
  const test::TemporaryFolder folder;
  VehicleConfig config;
  config.operator_socket = folder.write("operator.sock", "notes").string();
  Examinations found;
  examine_places(config, {}, found);
  EXPECT_THAT(said_of(found, "operator.socket"), HasSubstr("something else than a socket"));
  config.operator_socket = folder / "another.sock";
  found.clear();
  examine_places(config, {}, found);
  EXPECT_THAT(said_of(found, "operator.socket"), HasSubstr(" can be written"));
}

// Each of them ended the doctor: "filesystem error: cannot make absolute path".
TEST(Doctor, APlaceWithoutAFolderEndsNothing) {
  const test::TemporaryFolder folder;
  for (const char* text : {"operator: {socket: op.sock}", "operator: {socket: \"\"}", "log: {folder: \"\"}", "lock_folder: \"\""}) {
    std::vector<std::string> problems;
    const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", text), problems);
    EXPECT_NO_THROW(examine(config)) << text;
  }
  VehicleConfig config;
  config.operator_socket = "op.sock";
  Examinations found;
  EXPECT_NO_THROW(examine_places(config, {}, found));
}

// It was told twice, and the second remedy was the first's opposite.
TEST(Doctor, AHomingFileThatIsNotThereIsToldOnce) {
  const test::TemporaryFolder folder;
  std::vector<std::string> problems;
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml", "homing: {file: nope.yaml}\n"), problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0], HasSubstr("there is no nope.yaml"));
  EXPECT_EQ(said_of(bad_of(config), "homing.file"), "nothing");
}

TEST(Doctor, HoldsTheLogsAgainstTheDisk) {
  const test::TemporaryFolder folder;
  VehicleConfig config;
  config.log_folder = folder.path().string();
  config.log_file_mb = 100'000;
  config.log_keep = 1000;
  config.log_pack = false;
  Examinations found;
  examine_places(config, {}, found);
  EXPECT_THAT(said_of(found, "log.keep"), HasSubstr("the logs take up to 100200000 MB, and "));
}

TEST(Doctor, AnOpenEmergencyStopChainIsAState) {
  const test::TemporaryFolder folder;
  VehicleConfig config;
  config.estop_input = folder.write("value", "0\n").string();
  Examinations found;
  examine_arm(config, {}, found);
  EXPECT_EQ(found.at(0).grade, Grade::note);
  EXPECT_THAT(found.at(0).found, HasSubstr("the chain is open"));
}

TEST(Doctor, PrintsALineEachAndWhatToDoUnderWhatIsNotGood) {
  EXPECT_EQ(text_of({{"interface", "can.interface", Grade::good, "can0 is up", ""},
                     {"bit rate", "can.interface", Grade::bad, "can0 has none", "`ip link`"},
                     {"kernel", "", Grade::note, "slow", "faster"}}),
            "interface  good  can0 is up\n"
            "bit rate   BAD   can0 has none\n"
            "                 to do: `ip link`\n"
            "kernel     note  slow\n"
            "                 to do: faster\n");
}

}  // namespace
}  // namespace lf::hal::doctor
