// lanternfishd at work: the threads, what ties them together, and their orderly end.
//
//   control    SCHED_FIFO: the core's tick, every 4 ms
//   vision     images, and the core's scan pipeline
//   main       reads the emergency-stop input, feeds the watchdog, collects how things stand: nothing on it blocks
//   operator   serves the socket; what may block of that (users' names, the kernel's answers) is on workers
//   writer     the log
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "hal/vehicle/can_restart.hpp"
#include "hal/vehicle/commissioner.hpp"
#include "hal/vehicle/control_loop.hpp"
#include "hal/vehicle/estop_input.hpp"
#include "hal/vehicle/instance_lock.hpp"
#include "hal/vehicle/log_writer.hpp"
#include "hal/vehicle/operator_server.hpp"
#include "hal/vehicle/order_desk.hpp"
#include "hal/vehicle/service_manager.hpp"
#include "hal/vehicle/status_board.hpp"
#include "hal/vehicle/timing_probe.hpp"
#include "hal/vehicle/vehicle_config.hpp"
#include "hal/vehicle/vehicle_platform.hpp"

namespace lf::hal {

// This machine lacks something: one line that says what, and what to do. Exit status 3.
class EnvironmentLacks : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Daemon {
 public:
  // What it stands on. A test gives others than the machine's own.
  struct Surroundings {
    LinuxCalls* calls = &linux_calls();
    std::function<int(const std::string& interface)> restart_can = hal::restart_can;
    std::function<User(unsigned user)> look_up;  // empty: this machine's users, with the roles of the configuration
  };

  // `config` outlives the daemon. Takes the lock, listens for other masters, opens bus, camera, log and operator socket. Throws EnvironmentLacks.
  // A camera that is not there is no reason: it is looked for while the daemon runs.
  explicit Daemon(const VehicleConfig& config) : Daemon(config, Surroundings()) {}
  Daemon(const VehicleConfig& config, const Surroundings& surroundings);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  // Runs until `signals` (a signalfd, or -1) is readable, or, with `one_job`, until the job that it starts itself has ended; then stops the arm, powers it
  // off, and writes what is left of the log. True when the last job ended well or there was none; with `one_job` only when that job ended well.
  bool run(int signals, bool one_job);

  // After run(): what was counted and how late things were, for people.
  std::string summary() const;
  Json status() const;

 private:
  OrderDesk::Ways ways(const Surroundings& surroundings);
  void give_own(Command command);
  void look_after();
  void watch_estop(Time now);
  void feed_watchdog(Time now);
  bool start_refused();
  void start_threads();
  void stop_threads();
  void take_power();
  void run_control();
  void run_vision();
  void run_operator();
  void fill(ControlReport& report) const;
  Json latencies() const;

  const VehicleConfig& config_;
  InstanceLock lock_;
  LogRings log_rings_;
  LoopRings loop_rings_;
  EstopInput estop_;
  EstopLine estop_line_;
  VehiclePlatform platform_;
  ControlLoop<VehiclePlatform, TimingProbe> control_;
  VisionLoop<VehiclePlatform, TimingProbe> vision_;
  StatusBoard board_;
  LogWriter writer_;
  Commissioner commissioner_;
  OrderDesk desk_;
  OperatorServer server_;

  std::string camera_lacks_;       // at the start, in words; empty: nothing
  std::vector<std::string> lost_;  // of real time, in words
  std::atomic<bool> realtime_{false};
  std::atomic<bool> control_runs_{false};
  std::atomic<bool> control_gives_up_{false};
  std::atomic<bool> vision_stops_{false};
  std::atomic<bool> operator_stops_{false};
  std::atomic<std::uint64_t> beats_{0};  // of the control thread, for the watchdog
  long first_page_faults_ = 0;           // the control thread's, when its first tick began
  std::uint64_t first_heap_calls_ = 0;
  std::thread control_thread_, vision_thread_, operator_thread_;

  bool estop_open_ = false;
  Time next_feed_;
  std::uint64_t last_beats_ = 0;
};

}  // namespace lf::hal
