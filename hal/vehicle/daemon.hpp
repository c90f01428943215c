// lanternfishd at work: the threads, what ties them together, and their orderly end.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "hal/vehicle/control_loop.hpp"
#include "hal/vehicle/estop_input.hpp"
#include "hal/vehicle/instance_lock.hpp"
#include "hal/vehicle/log_writer.hpp"
#include "hal/vehicle/operator_server.hpp"
#include "hal/vehicle/service_manager.hpp"
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
  // `config` outlives the daemon. Takes the lock, listens for other masters, opens bus, camera, log and operator socket. Throws EnvironmentLacks.
  explicit Daemon(const VehicleConfig& config);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  // Runs until `signals` (a signalfd) is readable, or, with `one_job`, until the job that it starts itself has ended; then stops the arm, powers it off, and
  // writes what is left of the log. True when the last job ended well or there was none.
  bool run(int signals, bool one_job);

  // After run(): what was counted and how late things were, for people.
  std::string summary() const;
  Json status() const;

 private:
  std::string answer(const std::string& line, Role role);
  Json carry_out(const std::string& request, const Json& arguments);
  Json give_order(const mission::Order& order);
  bool order_of(const std::string& request, const Json& arguments, mission::Order& order, std::string& why) const;
  void send_order(const mission::Order& order);
  void watch_estop();
  void feed_watchdog();
  void stop_threads();
  void run_control();
  void run_vision();
  void fill(ControlReport& report) const;
  Json latencies() const;

  const VehicleConfig& config_;
  InstanceLock lock_;
  LogRings log_rings_;
  LoopRings loop_rings_;
  VehiclePlatform platform_;
  ControlLoop<VehiclePlatform> control_;
  VisionLoop<VehiclePlatform> vision_;
  LogWriter writer_;
  EstopInput estop_;
  OperatorServer server_;

  std::vector<std::string> lost_;  // of real time, in words
  std::atomic<bool> realtime_{false};
  std::atomic<bool> control_runs_{false};
  std::atomic<bool> control_gives_up_{false};
  std::atomic<bool> vision_stops_{false};
  std::atomic<std::uint64_t> beats_{0};  // of the control thread, for the watchdog
  long first_page_faults_ = 0;           // the control thread's, when its first tick began
  std::uint64_t first_heap_calls_ = 0;
  std::thread control_thread_, vision_thread_;

  bool estop_open_ = false;
  std::uint64_t orders_sent_ = 0;
  Time next_estop_, next_feed_;
  std::uint64_t last_beats_ = 0;
};

}  // namespace lf::hal
