// lanternfishd, all of it but main(), on a bus of the test's making: its threads, its socket, its log, and the served drives in real time on the other end.
// No kernel's CAN, no rights and no real time are needed, so that it runs under the sanitizers as well.
//
// Time passes half as fast as the clock, for a machine that has other work; LANTERNFISH_SLOWDOWN=N has it pass N times slower, for a sanitizer. Where the
// whole machine stands still, as a shared one does, so does this time, and it waits for the control thread and for the drives: one that gets no processor for
// 100 ms is no three SYNCs without an answer.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "hal/vehicle/daemon.hpp"
#include "hal/vehicle/end_signals.hpp"
#include "hal/vehicle/operator_client.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/serve/serve_loop.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/pair_linux.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::test {

using hal::Json;
using testing::HasSubstr;

// The drives' end of the bus.
class PairLink : public serve::CanLink {
 public:
  explicit PairLink(hal::LinuxCalls& calls) : can_(hal::SocketCan::Config{}, calls) { (void)can_.open(); }
  Time now() override { return hal::monotonic_now(); }
  bool wait(Time until) override {
    hal::hold_time_for_me(until);
    bool readable = can_.wait_readable(until);
    while (!readable && now() < until) readable = can_.wait_readable(until);  // time was held up for another thread
    return readable;
  }
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

inline hal::SimConfig make_sea() {
  const scenario::Scenario scenario = scenario::load_scenario("default", {});
  const scenario::Sample sample = scenario::draw(scenario, 1);
  const scenario::Nominal nominal = scenario::make_nominal(scenario, sample.lamps_lit);
  hal::SimConfig sea = scenario::make_truth(scenario, sample, nominal, 1);
  sea.world.base_from_panel.translation().x() += 2;                          // nothing within reach
  sea.world.start_rad[4] = test::arm5e.model().joints[4].lower_rad + 0.004;  // closed: the arm may be commissioned without it
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) sea.devices.drives[i].encoder_offset_rad = 0;
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
        for (std::size_t i = 0; i < arm5e_joint::count; ++i) actual_rad_[i] = loop_.world().readings()[i].position_rad;
        if (bus_off_.exchange(false)) link_.set_master_off(true);
        if (restarted_.exchange(false)) link_.set_master_off(false);
        if (const std::uint32_t told = emcy_.exchange(0); told != 0) send_emcy(static_cast<std::uint8_t>(told >> 16), told & 0xFFFF);
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
  // The drive reports an error (CiA 301, EMCY), and does nothing else.
  void report_error(std::size_t joint, std::uint16_t code) { emcy_ = std::uint32_t{can_map::drive_nodes[joint]} << 16 | code; }

 private:
  void send_emcy(std::uint8_t node, std::uint32_t code) {
    CanFrame frame;
    frame.id = 0x80u + node;
    frame.length = 8;
    frame.data = {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8), 1};
    (void)link_.send({&frame, 1});
  }

  PairLinux linux_;
  PairLink link_;
  serve::ServeLoop loop_;
  std::atomic<bool> stops_{false}, any_powered_{false}, bus_off_{false}, restarted_{false};
  std::atomic<std::uint32_t> emcy_{0};  // node and code; 0: none
  PerJoint<std::atomic<double>> actual_rad_{};
  std::thread thread_;
};

class AssembledDaemon : public testing::Test {
 protected:
  AssembledDaemon() {
    hal::slow_time_down(slowdown(), Duration::from_ms(10));
    pthread_sigmask(SIG_SETMASK, nullptr, &signals_before);
    signals = hal::take_end_signals();
    put_to_sea();
  }
  ~AssembledDaemon() override {
    end();
    close(signals);
    pthread_sigmask(SIG_SETMASK, &signals_before, nullptr);
    sea.reset();  // its thread reads the clock
    hal::slow_time_down(1);
  }

  static std::string config_text(const std::string& shared) {
    std::ifstream file(std::string(LANTERNFISH_SOURCE_DIR "/shared/") + shared);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  // An arm and a bus as new, with every zero known; without a daemon.
  void put_to_sea() {
    end();
    daemon.reset();
    bus.reset();
    sea.reset();
    int ends[2] = {-1, -1};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    sea = std::make_unique<Sea>(ends[0]);
    bus = std::make_unique<PairLinux>(ends[1]);
    folder.write("estop", "1\n");
    folder.write("homing.yaml", config_text("homing/simulator.yaml"));
  }

  // A ring that nobody writes into: the camera is there, and no image comes.
  std::string silent_camera() const {
    const std::string ring = folder.write("ring", "");
    std::filesystem::resize_file(ring, static_cast<std::uintmax_t>(hal::VehicleConfig().ring_bytes));
    return "{source: ring, ring: " + ring + "}";
  }

  void begin(bool one_job = false) { begin(one_job, silent_camera()); }
  void begin(bool one_job, const std::string& camera, const std::string& more = "") {
    assemble(camera, more);
    thread = std::thread([this, one_job] { well = daemon->run(signals, one_job); });
    wait_until("the operator interface", [this] {
      try {
        return ask("status")["ok"] == true;
      } catch (const std::exception&) {
        return false;
      }
    });
  }
  // `more` are further sections of its configuration.
  void assemble(const std::string& camera, const std::string& more = "") {
    const std::string text = "can: {interface: pair0}\ncamera: " + camera +
                             "\nrealtime: {priority: 0, lock_memory: false}\noperator: {socket: " + (folder / "operator.sock") +
                             "}\nlog: {folder: " + (folder / "log") + "}\nlock_folder: " + folder.path().string() +
                             "\nestop: {input: " + (folder / "estop") + "}\nhoming: {file: homing.yaml}\n" + more;
    config = std::make_unique<hal::VehicleConfig>(hal::load_vehicle_config(folder.write("vehicle.yaml", text)));
    hal::Daemon::Surroundings surroundings;
    surroundings.calls = bus.get();
    surroundings.restart_can = [this](const std::string&) {
      sea->come_back();
      return 0;
    };
    daemon = std::make_unique<hal::Daemon>(*config, surroundings);
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

}  // namespace lf::test
