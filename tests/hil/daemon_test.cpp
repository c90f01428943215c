// Every order is given to the assembled daemon over its socket.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>

#include "firmware/arm/actuator.hpp"
#include "hal/config/homing_file.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/assembled_daemon.hpp"

namespace lf::test {
namespace {

const Json turn_to_45 = Json::parse(R"({"do":"task","tasks":[{"turn_valve":{"to_deg":45}}]})");
const Json turn_without_angle = Json::parse(R"({"do":"task","tasks":[{"turn_valve":90}]})");
const Json commission_jaw = Json::parse(R"({"do":"commission","joints":["jaw"],"clear":true})");
const Json commission_elbow = Json::parse(R"({"do":"commission","joints":["elbow"],"clear":true})");
const Json unclear = Json::parse(R"({"do":"commission","joints":["jaw"]})");

TEST_F(AssembledDaemon, TakesEveryOrderOfAMissionOverItsSocket) {
  begin();
  EXPECT_EQ(ask("status")["standing"], "idle");
  EXPECT_FALSE(sea->any_powered());
  expect_refused("hold", "not while the mission is idle");
  expect_refused(turn_without_angle, "turn_valve takes");
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
  EXPECT_TRUE(sea->any_powered());
  const double before_rad = sea->actual_rad(3);
  order({{"do", "jog"}, {"joint", "roll"}, {"by_deg", 10}});
  ASSERT_TRUE(wait_standing("jogging"));
  ASSERT_TRUE(wait_standing("ready"));
  EXPECT_NEAR(sea->actual_rad(3), before_rad + 10 * pi / 180, 0.02);
  order(turn_to_45);
  wait_until(
      "the new job", [&] { return std::abs(ask("status")["tasks"][0]["target_deg"].get<double>() - 45) < 1e-9; }, 5);
  order("start");
  ASSERT_TRUE(wait_standing("working"));
  order("hold");
  ASSERT_TRUE(wait_standing("on hold"));
  order("resume");
  ASSERT_TRUE(wait_standing("working"));
  order("abort");
  ASSERT_TRUE(wait_standing("ended"));
  order("reset");
  ASSERT_TRUE(wait_standing("idle"));
  ASSERT_TRUE(wait_unpowered(5));
  wait_until(
      "the log", [&] { return events().find("\"role\":\"engineer\"") != std::string::npos; }, 5);
}

TEST_F(AssembledDaemon, StopsByAnOrderAndByTheInput) {
  begin();
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
  order("estop");
  ASSERT_TRUE(wait_standing("ended", 5));
  order("reset");
  ASSERT_TRUE(wait_unpowered(5));
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
  folder.write("estop", "0\n");
  ASSERT_TRUE(wait_standing("ended", 5));
  order("reset");
  ASSERT_TRUE(wait_standing("idle", 5));
  order("home");  // taken, and stopped within 100 ms: before anything has power
  ASSERT_TRUE(wait_standing("ended", 5));
  EXPECT_FALSE(sea->any_powered());
  folder.write("estop", "1\n");
  hal::sleep_until(hal::monotonic_now() + Duration::from_ms(200));
  order("reset");
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
}

TEST_F(AssembledDaemon, ComesBackFromBusOffWhenItIsTold) {
  begin();
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
  sea->go_bus_off();
  ASSERT_TRUE(wait_standing("ended", 5));
  order("restart-bus");
  wait_until(
      "the restart", [&] { return ask("status")["counters"]["can"].value("controller restarted", 0) == 1; }, 5);
  order("reset");
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
}

// SIGHUP: the terminal that it was started from is gone. The arm is not left to itself.
class DaemonEndedBy : public AssembledDaemon, public testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(Signals, DaemonEndedBy, testing::Values(SIGTERM, SIGINT, SIGHUP),
                         [](const auto& signal) { return std::string(sigabbrev_np(signal.param)); });

TEST_P(DaemonEndedBy, ASignalInMidMotionTakesThePower) {
  begin();
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
  order({{"do", "jog"}, {"joint", "slew"}, {"by_deg", 15}});
  ASSERT_TRUE(wait_standing("jogging"));
  end(GetParam());
  EXPECT_FALSE(sea->any_powered());
}

TEST_F(AssembledDaemon, AnInterruptedJobHasNotEndedWell) {
  begin(true);
  ASSERT_TRUE(wait_standing("working"));
  end();
  EXPECT_FALSE(well);
  EXPECT_FALSE(sea->any_powered());
}

// An arm that is out must be led home and stowed without its camera; only what has to see is refused.
TEST_F(AssembledDaemon, WithoutItsCameraItHomesAndStowsAndRefusesAJob) {
  begin(false, "{source: device, device: " + (folder / "video9") + "}");
  expect_refused("start", "a job needs the camera: " + (folder / "video9") + ": there is no camera");
  EXPECT_FALSE(sea->any_powered());
  const double park_rad = config->core.controller.mission.park_rad[0];
  std::string reason;
  // A machine that stands still for three SYNCs stops the arm: rightly, and it is asked again.
  for (int again = 0; again < 3 && reason != "aborted"; ++again) {
    order("home");
    ASSERT_TRUE(wait_standing("ready"));
    EXPECT_TRUE(sea->any_powered());
    expect_refused("start", "a job needs the camera");
    const double before_rad = sea->actual_rad(0);
    order({{"do", "jog"}, {"joint", "slew"}, {"by_deg", 5}});
    ASSERT_TRUE(wait_standing("jogging"));
    ASSERT_TRUE(wait_standing("ready"));
    EXPECT_NEAR(sea->actual_rad(0), before_rad + 5 * pi / 180, 0.02);
    order("abort");
    ASSERT_TRUE(wait_standing("ended"));
    reason = ask("status")["failure"]["reason"];
    order("reset");
    ASSERT_TRUE(wait_unpowered(5));
  }
  EXPECT_EQ(reason, "aborted");
  EXPECT_NEAR(sea->actual_rad(0), park_rad, 0.02) << "stowed";
}

// Such a job set the arm moving, and ended at the first look.
TEST_F(AssembledDaemon, ThatIsToldThatThereIsNoCameraRefusesAJobToo) {
  begin(false, "{source: none}");
  expect_refused("start", "a job needs the camera: camera.source is none");
  wait_until(
      "the log", [&] { return events().find("\"camera\":\"none\"") != std::string::npos; }, 5);
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
}

TEST_F(AssembledDaemon, OneJobWithoutACameraIsNotBegun) {
  assemble("{source: none}");
  EXPECT_FALSE(daemon->run(signals, true));
  EXPECT_FALSE(sea->any_powered());
}

TEST_F(AssembledDaemon, GivesNoPowerToAJointThatWasNeverCommissioned) {
  folder.write("homing.yaml", "slew: {zero_counts: 0}\n");
  begin();
  for (const char* request : {"start", "home"}) expect_refused(request, "shoulder, elbow, roll, jaw");
  EXPECT_FALSE(sea->any_powered());
  EXPECT_EQ(ask("status")["without a zero"], "shoulder, elbow, roll, jaw");
}

// Its drive says that it has lost its position. It needs a zero again, and neither a reset nor a new job does without one.
TEST_F(AssembledDaemon, TakesTheZeroOfADriveThatLostItsPosition) {
  folder.write("mine.yaml", "title: mine\nlike: lanternfish\nposition_lost: [\"7320\"]\n");
  begin(false, silent_camera(), "drives: {jaw: {profile: " + (folder / "mine.yaml") + "}}\n");
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
  EXPECT_FALSE(ask("status").contains("without a zero"));
  sea->report_error(4, 0x7320);
  ASSERT_TRUE(wait_standing("ended", 10));
  ASSERT_TRUE(wait_unpowered(5));
  order("reset");
  ASSERT_TRUE(wait_standing("idle", 10));
  wait_until(
      "the lost zero", [&] { return ask("status").value("without a zero", "") == "jaw"; }, 5);
  for (const char* request : {"start", "home"}) expect_refused(request, "jaw");
  EXPECT_FALSE(sea->any_powered());
  // Nor does a daemon that is started anew.
  wait_until(
      "the file", [&] { return !config::read_homing_file(folder / "homing.yaml", {}).known[4]; }, 5);
  EXPECT_TRUE(config::read_homing_file(folder / "homing.yaml", {}).known[3]);
  wait_until(
      "the log", [&] { return events().find("\"kind\":\"zeros_lost\"") != std::string::npos; }, 5);
}

TEST_F(AssembledDaemon, TakesTheZeroOfADriveThatLostItsPositionWhileAnotherWasCommissioned) {
  folder.write("mine.yaml", "title: mine\nlike: lanternfish\nposition_lost: [\"7320\"]\n");
  begin(false, silent_camera(), "drives: {jaw: {profile: " + (folder / "mine.yaml") + "}}\n");
  order(commission_elbow);
  ASSERT_TRUE(wait_until(
      "power", [&] { return sea->any_powered(); }, 10));
  sea->report_error(4, 0x7320);
  ASSERT_TRUE(wait_standing("idle", 10));
  EXPECT_EQ(ask("status")["commissioning"]["state"], "failed");
  wait_until(
      "the lost zero", [&] { return ask("status").value("without a zero", "") == "jaw"; }, 5);
  for (const char* request : {"start", "home"}) expect_refused(request, "jaw");
  EXPECT_FALSE(sea->any_powered());
}

TEST_F(AssembledDaemon, CommissionsAJointAndUsesItsZero) {
  config::HomingOffsets offsets;
  const auto ended = [&] { return ask("status")["standing"] != "commissioning" && ask("status")["commissioning"]["state"] != "under way"; };
  const auto stood_still = [&] {
    const std::string why = ask("status")["commissioning"].value("why", "");
    return why.find("no process data") != std::string::npos || why.find("the emergency-stop chain cannot be read") != std::string::npos;
  };
  // It takes some ten seconds, in which a thread that gets no processor for three SYNCs ends it: rightly. Then it is begun anew, with an arm as new: one that stands
  // at its stop has no stretch left on which its friction could be found.
  for (int attempt = 0; attempt < 4 && (attempt == 0 || stood_still()); ++attempt) {
    if (attempt > 0) {
      EXPECT_FALSE(sea->any_powered());
      put_to_sea();
    }
    offsets = config::read_homing_file(folder / "homing.yaml", {});
    offsets.known[4] = false;
    config::write_homing_file(folder / "homing.yaml", offsets);
    begin();
    expect_refused("home", "jaw");
    expect_refused(unclear, "clear its reach");
    order(commission_jaw);
    ASSERT_TRUE(wait_standing("commissioning", 5));
    expect_refused("home", "jaw");
    expect_refused("reset", "commissioned");
    ASSERT_TRUE(wait_until("the commissioning's end", ended, 120));
  }
  const Json done = ask("status")["commissioning"];
  ASSERT_EQ(done["state"], "done") << ask("status").dump();
  ASSERT_TRUE(done.contains("friction") && done["friction"].contains("jaw")) << done.dump();
  EXPECT_GT(done["friction"]["jaw"].value("coulomb_mnm", 0.0), 0) << done.dump();
  EXPECT_TRUE(done["friction"]["jaw"].contains("rms_mnm")) << done.dump();
  EXPECT_FALSE(sea->any_powered());
  offsets = config::read_homing_file(folder / "homing.yaml", {});
  EXPECT_TRUE(offsets.known[4]);
  const double off_rad = std::abs(offsets.zero_counts[4]) * arm::rad_per_count(test::arm5e.joint(arm5e_joint::jaw), sea->actual_rad(4));
  EXPECT_LT(off_rad, 0.003);  // the simulated encoder counts 0 at 0
  EXPECT_EQ(offsets.zero_counts[0], 0);
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
}

TEST_F(AssembledDaemon, AnEmergencyStopEndsACommissioningWithoutPower) {
  begin();
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
  expect_refused(commission_elbow, "not at rest");
  order("abort");
  ASSERT_TRUE(wait_standing("ended"));
  order("reset");
  ASSERT_TRUE(wait_unpowered(5));
  const std::string before = folder.read("homing.yaml");
  // The master hears some ticks later than the drives that they are without power.
  const auto begun = [&] { return ask(commission_elbow)["ok"] == true; };
  ASSERT_TRUE(wait_until("its begin", begun, 5));
  ASSERT_TRUE(wait_until(
      "power", [&] { return sea->any_powered(); }, 10));
  hal::sleep_until(hal::monotonic_now() + Duration::from_ms(500));
  order("estop");
  ASSERT_TRUE(wait_unpowered(2));
  ASSERT_TRUE(wait_standing("ended", 5));
  const Json last = ask("status")["commissioning"];
  EXPECT_EQ(last["state"], "failed");
  EXPECT_EQ(last["without_power"], true);
  EXPECT_THAT(last["why"].get<std::string>(), HasSubstr("emergency stop"));
  EXPECT_EQ(folder.read("homing.yaml"), before);

  // It is latched: nothing begins before a reset.
  expect_refused("home", "the mission is ended");
  expect_refused(commission_elbow, "reset");
  order("reset");

  // The vehicle's own input ends it as well.
  ASSERT_TRUE(wait_until("its begin", begun, 5));
  ASSERT_TRUE(wait_until(
      "power", [&] { return sea->any_powered(); }, 10));
  folder.write("estop", "0\n");
  ASSERT_TRUE(wait_unpowered(2));
}

}  // namespace
}  // namespace lf::test
