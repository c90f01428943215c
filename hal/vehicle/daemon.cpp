#include "hal/vehicle/daemon.hpp"

#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "hal/heap_guard/heap_guard.hpp"

namespace lf::hal {

namespace {

// Three heartbeats of a master, and many of its SYNCs.
constexpr Duration listen_for = Duration::from_ms(350);
constexpr Duration serve_for = Duration::from_ms(20);
constexpr Duration estop_every = Duration::from_ms(100);  // while the chain stays open
constexpr Duration stop_within = Duration::from_ms(8000);
constexpr std::uint64_t turns_a_camera_report = 20;

// Signals that came are taken, so that the next look sees only new ones.
bool signals_pending(int signals) {
  signalfd_siginfo info{};
  return signals >= 0 && read(signals, &info, sizeof info) == static_cast<ssize_t>(sizeof info);
}

}  // namespace

Daemon::Daemon(const VehicleConfig& config)
    : config_(config),
      platform_(config, log_rings_),
      control_(platform_, config.core.controller, loop_rings_),
      vision_(platform_, config.core.scan, loop_rings_),
      writer_(log_rings_, loop_rings_, config.interface),
      estop_(config.estop_input),
      server_([this](unsigned user) { return role_of_user(user, config_.operators, config_.engineers); },
              [this](const std::string& line, Role role) { return answer(line, role); }) {
  if (const std::string taken = lock_.take(config.lock_folder, config.interface); !taken.empty()) throw EnvironmentLacks(taken);
  if (const PortStatus error = platform_.open_bus(); error != port_ok) throw EnvironmentLacks(SocketCan::explain(error, config.interface));
  if (const auto other = hear_another_master(platform_.can(), listen_for)) throw EnvironmentLacks(config.interface + ": " + *other);
  if (std::string why; platform_.open_camera(why) != port_ok) throw EnvironmentLacks(why);
  if (const int error = writer_.open(config.log_folder); error != 0)
    throw EnvironmentLacks(config.log_folder + ": the log cannot be written there: " + std::strerror(error));
  if (const int error = server_.open(config.operator_socket); error != 0)
    throw EnvironmentLacks(config.operator_socket + ": " + std::strerror(error) + "; `operator.socket` names another place");
}

Daemon::~Daemon() { stop_threads(); }

void Daemon::fill(ControlReport& report) const {
  report.can = platform_.can().stats();
  report.missed_ticks = platform_.clock().missed();
  report.page_faults = static_cast<std::uint64_t>(page_faults() - first_page_faults_);
  report.heap_calls -= first_heap_calls_;
  report.frames_unlogged = log_rings_.frames.lost();
  report.realtime = realtime_;
}

void Daemon::run_control() {
  name_thread("control");
  const auto fill_in = [this](ControlReport& report) { fill(report); };
  platform_.start_clock();
  first_heap_calls_ = HeapGuard::calls();
  first_page_faults_ = page_faults();
  while (!control_.stopped() && !control_gives_up_) {
    control_.turn(fill_in);
    beats_.fetch_add(1, std::memory_order_relaxed);
  }
  control_.report(fill_in);
  control_runs_ = false;
}

void Daemon::run_vision() {
  name_thread("vision");
  if (config_.vision_cpu >= 0) (void)become_realtime({.priority = 0, .cpu = config_.vision_cpu, .lock_memory = false});
  for (std::uint64_t turn = 0; !vision_stops_; ++turn) {
    platform_.wait_for_image();
    vision_.turn();
    if (turn % turns_a_camera_report == 0) (void)loop_rings_.cameras.push(platform_.camera_report());
  }
  (void)loop_rings_.cameras.push(platform_.camera_report());
}

bool Daemon::run(int signals, bool one_job) {
  lost_ = lock_process_memory(config_.realtime);
  std::atomic<bool> ready{false};
  control_runs_ = true;
  control_thread_ = std::thread([this, &ready] {
    const std::vector<std::string> refused = become_realtime(config_.realtime);
    lost_.insert(lost_.end(), refused.begin(), refused.end());
    realtime_ = refused.empty() && config_.realtime.priority > 0;
    prefault_stack();
    ready = true;
    run_control();
  });
  vision_thread_ = std::thread([this] { run_vision(); });
  while (!ready) sleep_until(monotonic_now() + Duration::from_ms(1));
  writer_.start();
  writer_.say({{"t_s", monotonic_now().s()},
               {"kind", "begin"},
               {"config", config_.machine.file},
               {"interface", config_.interface},
               {"lost", lost_}});
  for (const std::string& loss : lost_) std::fprintf(stderr, "lanternfishd: %s\n", loss.c_str());
  notify_service_manager("READY=1\nSTATUS=waiting for orders");
  if (one_job) {
    mission::Order start;
    send_order(start);
  }

  bool job_ended = false;
  while (control_runs_ && !job_ended) {
    server_.serve(serve_for, signals);
    watch_estop();
    feed_watchdog();
    if (signals_pending(signals)) break;
    job_ended = one_job && writer_.newest().control.outcome.ended;
  }
  const mission::Outcome outcome = writer_.newest().control.outcome;
  notify_service_manager("STOPPING=1");
  stop_threads();
  return !outcome.ended || outcome.success;
}

// The arm comes to rest, loses power, and its nodes are stopped; a control thread that cannot do that in time is left to the nodes' own watch over it.
void Daemon::stop_threads() {
  if (!control_thread_.joinable()) return;
  mission::Order order;
  order.command = Command::shut_down;
  send_order(order);
  const Time end = monotonic_now() + stop_within;
  while (control_runs_ && monotonic_now() < end) {
    sleep_until(monotonic_now() + Duration::from_ms(5));
    feed_watchdog();
  }
  control_gives_up_ = true;
  control_thread_.join();
  vision_stops_ = true;
  vision_thread_.join();
  writer_.stop();
}

void Daemon::send_order(const mission::Order& order) { (void)loop_rings_.orders.push({++orders_sent_, order}); }

void Daemon::watch_estop() {
  const Time now = monotonic_now();
  const bool open = estop_.present() && !estop_.whole();
  if (open != estop_open_)
    writer_.say({{"t_s", now.s()}, {"kind", open ? "emergency stop" : "emergency-stop chain closed"}, {"input", config_.estop_input}});
  estop_open_ = open;
  if (!open || now < next_estop_) return;
  next_estop_ = now + estop_every;
  mission::Order order;
  order.command = Command::emergency_stop;
  send_order(order);
}

// Only while the control thread beats: one that hangs is the service manager's to see.
void Daemon::feed_watchdog() {
  static const std::optional<Duration> interval = watchdog_interval();
  const Time now = monotonic_now();
  const std::uint64_t beats = beats_.load(std::memory_order_relaxed);
  if (!interval || now < next_feed_ || beats == last_beats_) return;
  last_beats_ = beats;
  next_feed_ = now + *interval / 2;
  notify_service_manager("WATCHDOG=1");
}

}  // namespace lf::hal
