// lanternfishd, all of it but main(), on a bus of the test's making: its threads, its socket, its log, and the served drives in real time on the other end.
// Every order is given over the socket. No kernel's CAN, no rights and no real time are needed, so that it runs under the sanitizers as well.
//
// Time passes four times slower than the clock, for a machine that has other work; LANTERNFISH_SLOWDOWN=N has it pass N times slower, for a sanitizer.
#include "hal/vehicle/daemon.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "firmware/arm/actuator.hpp"
#include "hal/config/homing_file.hpp"
#include "hal/vehicle/end_signals.hpp"
#include "hal/vehicle/operator_client.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/serve/serve_loop.hpp"
#include "tests/hil/pair_linux.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::test {
namespace {

using hal::Json;
using testing::HasSubstr;

// The drives' end of the bus.
class PairLink : public serve::CanLink {
 public:
  explicit PairLink(hal::LinuxCalls& calls) : can_(hal::SocketCan::Config{}, calls) { (void)can_.open(); }
  Time now() override { return hal::monotonic_now(); }
  bool wait(Time until) override { return can_.wait_readable(until); }
  void sleep(Time until) override { hal::sleep_until(until); }
  hal::PortStatus receive(hal::ReceivedFrame& received) override {
    hal::PortStatus status = can_.receive(received);
    while (master_off_ && status == hal::port_ok) status = can_.receive(received);  // none of its frames reached the bus
    return status;
  }
  hal::PortStatus send(std::span<const CanFrame> frames) override { return master_off_ ? hal::port_ok : can_.send(frames); }

  // As the master's controller reports it: an error frame, and silence until it is back.
  void set_master_off(bool off) {
    CanFrame frame;
    frame.id = CanFrame::error_flag | (off ? CAN_ERR_BUSOFF : CAN_ERR_RESTARTED);
    frame.length = 8;
    master_off_ = off;
    (void)can_.send({&frame, 1});
  }

 private:
  hal::SocketCan can_;
  bool master_off_ = false;
};

hal::SimConfig make_sea() {
  const scenario::Scenario scenario = scenario::load_scenario("default", {});
  const scenario::Sample sample = scenario::draw(scenario, 1);
  const scenario::Nominal nominal = scenario::make_nominal(scenario, sample.lamps_lit);
  hal::SimConfig sea = scenario::make_truth(scenario, sample, nominal, 1);
  sea.world.base_from_panel.translation().x() += 2;  // nothing within reach
  for (std::size_t i = 0; i < joint_count; ++i) sea.devices.drives[i].encoder_offset_rad = 0;
  return sea;
}

// World and drives on a thread of their own.
class Sea {
 public:
  explicit Sea(int fd) : linux_(fd), link_(linux_), loop_(make_sea(), serve::NodeSet::all(), link_, nullptr, {}) {
    thread_ = std::thread([this] {
      while (!stops_) {
        loop_.turn();
        const JointDrives& drives = loop_.rack().drives();
        any_powered_ = std::any_of(drives.begin(), drives.end(), [](const JointDrive& drive) { return !drive.released; });
        for (std::size_t i = 0; i < joint_count; ++i) actual_rad_[i] = loop_.world().readings()[i].position_rad;
        if (bus_off_.exchange(false)) link_.set_master_off(true);
        if (restarted_.exchange(false)) link_.set_master_off(false);
      }
    });
  }
  ~Sea() {
    stops_ = true;
    thread_.join();
  }
  // Power as the drives have it, not as the master is told.
  bool any_powered() const { return any_powered_; }
  double actual_rad(std::size_t joint) const { return actual_rad_[joint]; }
  void go_bus_off() { bus_off_ = true; }
  void come_back() { restarted_ = true; }

 private:
  PairLinux linux_;
  PairLink link_;
  serve::ServeLoop loop_;
  std::atomic<bool> stops_{false}, any_powered_{false}, bus_off_{false}, restarted_{false};
  std::array<std::atomic<double>, joint_count> actual_rad_{};
  std::thread thread_;
};

class AssembledDaemon : public testing::Test {
 protected:
  AssembledDaemon() {
    hal::slow_time_down(slowdown());
    pthread_sigmask(SIG_SETMASK, nullptr, &signals_before);
    signals = hal::take_end_signals();
    int ends[2] = {-1, -1};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    sea = std::make_unique<Sea>(ends[0]);
    bus = std::make_unique<PairLinux>(ends[1]);
    folder.write("estop", "1\n");
    folder.write("homing.yaml", config_text("homing/simulator.yaml"));
  }
  ~AssembledDaemon() override {
    end();
    close(signals);
    pthread_sigmask(SIG_SETMASK, &signals_before, nullptr);
    hal::slow_time_down(1);
  }

  static std::string config_text(const std::string& shared) {
    std::ifstream file(std::string(LANTERNFISH_SOURCE_DIR "/shared/") + shared);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  void begin(bool one_job = false, const std::string& camera = "{source: none}") {
    const std::string text = "can: {interface: pair0}\ncamera: " + camera +
                             "\nrealtime: {priority: 0, lock_memory: false}\noperator: {socket: " + (folder / "operator.sock") +
                             "}\nlog: {folder: " + (folder / "log") + "}\nlock_folder: " + folder.path().string() +
                             "\nestop: {input: " + (folder / "estop") + "}\nhoming: {file: homing.yaml}\n";
    config = std::make_unique<hal::VehicleConfig>(hal::load_vehicle_config(folder.write("vehicle.yaml", text)));
    hal::Daemon::Surroundings surroundings;
    surroundings.calls = bus.get();
    surroundings.restart_can = [this](const std::string&) {
      sea->come_back();
      return 0;
    };
    daemon = std::make_unique<hal::Daemon>(*config, surroundings);
    thread = std::thread([this, one_job] { well = daemon->run(signals, one_job); });
    wait_until("the operator interface", [this] {
      try {
        return ask("status")["ok"] == true;
      } catch (const std::exception&) {
        return false;
      }
    });
  }
  void end(int signal = SIGTERM) {
    if (!thread.joinable()) return;
    EXPECT_EQ(kill(getpid(), signal), 0);
    thread.join();
  }

  Json ask(const Json& request) const { return hal::ask_daemon(folder / "operator.sock", request); }
  Json ask(const char* request) const { return ask(Json{{"do", request}}); }
  void order(const Json& request) const {
    const Json reply = ask(request);
    EXPECT_EQ(reply["ok"], true) << request << ": " << reply;
  }
  void order(const char* request) const { order(Json{{"do", request}}); }
  void expect_refused(const Json& request, const std::string& why) const {
    const Json reply = ask(request);
    EXPECT_EQ(reply["ok"], false) << request;
    EXPECT_THAT(reply.value("why", ""), HasSubstr(why)) << request;
  }
  void expect_refused(const char* request, const std::string& why) const { expect_refused(Json{{"do", request}}, why); }
  bool wait_until(const std::string& what, const std::function<bool()>& condition, double limit_s = 60) const {
    const Time limit = hal::monotonic_now() + Duration::from_s(limit_s);
    while (!condition()) {
      if (hal::monotonic_now() > limit) {
        ADD_FAILURE() << what << ": not within " << limit_s << " s; " << ask("status").dump();
        return false;
      }
      hal::sleep_until(hal::monotonic_now() + Duration::from_ms(10));
    }
    return true;
  }
  bool wait_standing(const std::string& standing, double limit_s = 60) const {
    return wait_until(
        standing, [&] { return ask("status")["standing"] == standing; }, limit_s);
  }
  bool wait_unpowered(double limit_s) const {
    return wait_until(
        "no power", [&] { return !sea->any_powered(); }, limit_s);
  }
  std::string events() const { return folder.read("log/log.jsonl"); }

  TemporaryFolder folder;
  std::unique_ptr<Sea> sea;
  std::unique_ptr<PairLinux> bus;
  int signals = -1;
  sigset_t signals_before{};
  std::unique_ptr<hal::VehicleConfig> config;
  std::unique_ptr<hal::Daemon> daemon;
  std::thread thread;
  std::atomic<bool> well{false};
};

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
  ASSERT_TRUE(wait_unpowered(5));
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

TEST_F(AssembledDaemon, GivesNoPowerToAJointThatWasNeverCommissioned) {
  folder.write("homing.yaml", "slew: {zero_counts: 0}\n");
  begin();
  for (const char* request : {"start", "home"}) expect_refused(request, "shoulder, elbow, roll, jaw");
  EXPECT_FALSE(sea->any_powered());
  EXPECT_EQ(ask("status")["without a zero"], "shoulder, elbow, roll, jaw");
}

TEST_F(AssembledDaemon, CommissionsAJointAndUsesItsZero) {
  config::HomingOffsets offsets = config::read_homing_file(folder / "homing.yaml");
  offsets.known[4] = false;
  config::write_homing_file(folder / "homing.yaml", offsets);
  begin();
  expect_refused("home", "jaw");
  expect_refused(unclear, "clear its reach");
  order(commission_jaw);
  ASSERT_TRUE(wait_standing("commissioning", 5));
  expect_refused("home", "jaw");
  expect_refused("reset", "commissioned");
  const auto ended = [&] { return ask("status")["standing"] != "commissioning" && ask("status")["commissioning"]["state"] != "under way"; };
  ASSERT_TRUE(wait_until("the commissioning's end", ended, 120));
  // It takes some ten seconds, in which a machine that stands still for three SYNCs ends it: rightly, and it is asked again.
  const auto stood_still = [&] {
    const std::string why = ask("status")["commissioning"].value("why", "");
    return why.find("no process data") != std::string::npos || why.find("the emergency-stop chain cannot be read") != std::string::npos;
  };
  for (int again = 0; again < 3 && stood_still(); ++again) {
    EXPECT_FALSE(sea->any_powered());
    order(commission_jaw);
    ASSERT_TRUE(wait_standing("commissioning", 5));
    ASSERT_TRUE(wait_until("the commissioning's end", ended, 120));
  }
  const Json done = ask("status")["commissioning"];
  EXPECT_EQ(done["state"], "done") << ask("status").dump();
  EXPECT_GT(done["friction"]["jaw"].value("coulomb_mnm", 0.0), 0) << done.dump();
  EXPECT_TRUE(done["friction"]["jaw"].contains("rms_mnm")) << done.dump();
  EXPECT_FALSE(sea->any_powered());
  offsets = config::read_homing_file(folder / "homing.yaml");
  EXPECT_TRUE(offsets.known[4]);
  const double off_rad = std::abs(offsets.zero_counts[4]) * arm::rad_per_count(Joint::jaw, sea->actual_rad(4));
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
  ASSERT_TRUE(wait_standing("idle", 5));
  const Json last = ask("status")["commissioning"];
  EXPECT_EQ(last["state"], "failed");
  EXPECT_EQ(last["without_power"], true);
  EXPECT_THAT(last["why"].get<std::string>(), HasSubstr("emergency stop"));
  EXPECT_EQ(folder.read("homing.yaml"), before);

  // The vehicle's own input ends it as well.
  ASSERT_TRUE(wait_until("its begin", begun, 5));
  ASSERT_TRUE(wait_until(
      "power", [&] { return sea->any_powered(); }, 10));
  folder.write("estop", "0\n");
  ASSERT_TRUE(wait_unpowered(2));
}

}  // namespace
}  // namespace lf::test
