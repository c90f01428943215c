// `lanternfishd --check` says what of a configuration this machine does not have.
#include "hal/vehicle/machine_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "tests/unit/temporary_folder.hpp"

namespace lf::hal {
namespace {

using testing::HasSubstr;

std::string said_of(const std::vector<Finding>& findings, const std::string& key) {
  const auto found = std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.key == key; });
  return found == findings.end() ? "nothing" : found->problem + "; " + found->remedy;
}

// Each of these was "sound".
TEST(MachineCheck, NamesWhatIsNotThere) {
  const test::TemporaryFolder folder;
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml",
                                                                "can: {interface: can99}\n"
                                                                "camera: {device: /dev/video77}\n"
                                                                "operator: {operators: [nobody-of-this-name, \"@no-such-group\"]}\n"
                                                                "estop: {input: /sys/class/gpio/no/value}\n"
                                                                "realtime: {cpu: 1000, vision_cpu: 0}\n"
                                                                "log: {folder: /proc/lanternfish}\n"
                                                                "lock_folder: /nowhere/lock\n"));
  const std::vector<Finding> found = check_machine(config);
  EXPECT_THAT(said_of(found, "can.interface"), HasSubstr("no interface can99"));
  EXPECT_THAT(said_of(found, "camera.device"), HasSubstr("/dev/video77"));
  EXPECT_THAT(said_of(found, "operator.operators"), HasSubstr("no user nobody-of-this-name"));
  EXPECT_THAT(said_of(found, "log.folder"), HasSubstr("nothing can be written"));
  EXPECT_EQ(said_of(found, "lock_folder"), "/nowhere/lock is not there; `mkdir /nowhere/lock`, or name another place");
  EXPECT_THAT(said_of(found, "homing.file"), HasSubstr("no file is named for the zeros of slew, shoulder, elbow, roll, jaw"));
  EXPECT_THAT(said_of(found, "estop.input"), HasSubstr("/sys/class/gpio/no/value: No such file"));
  EXPECT_THAT(said_of(found, "realtime.cpu"), HasSubstr("there is no processor 1000"));
  EXPECT_EQ(said_of(found, "realtime.vision_cpu"), "nothing");
  EXPECT_EQ(std::count_if(found.begin(), found.end(), [](const Finding& f) { return f.key == "operator.operators"; }), 2);
}

// A file that can be read and says nothing of the chain was taken for one that does.
TEST(MachineCheck, AnEstopInputThatReadsNeitherZeroNorOneIsTold) {
  const test::TemporaryFolder folder;
  const auto said = [&](const std::string& input) {
    return said_of(check_machine(load_vehicle_config(folder.write("v.yaml", "estop: {input: " + input + "}\n"))), "estop.input");
  };
  EXPECT_THAT(said(folder.path().string()), HasSubstr("is a folder"));
  EXPECT_THAT(said(folder.write("name", "lantern\n")), HasSubstr("reads neither 0 nor 1"));
  EXPECT_THAT(said(folder.write("empty", "")), HasSubstr("reads neither 0 nor 1"));
  EXPECT_EQ(said(folder.write("value", "1\n")), "nothing");
}

TEST(MachineCheck, SaysNothingOfWhatIsThere) {
  const test::TemporaryFolder folder;
  const std::string place = folder.path().string();
  const VehicleConfig config = load_vehicle_config(
      folder.write("v.yaml", "can: {interface: lo}\ncamera: {source: none}\noperator: {operators: [root, \"@root\"], socket: " + place +
                                 "/run/s}\nlog: {folder: " + place + "/log, file_mb: 1, keep: 2}\nlock_folder: " + place +
                                 "\nrealtime: {priority: 0, lock_memory: false}\nhoming: {file: homing/simulator.yaml}\n"));
  const std::vector<Finding> found = check_machine(config);
  // A kernel without CAN says so first.
  const bool has_can = access("/proc/net/can", F_OK) == 0;
  ASSERT_EQ(found.size(), has_can ? 1u : 2u);
  EXPECT_THAT(said_of(found, "can"), HasSubstr(has_can ? "nothing" : "gives no CAN socket"));
  EXPECT_THAT(said_of(found, "can.interface"), HasSubstr("lo is no CAN interface"));
}

}  // namespace
}  // namespace lf::hal
