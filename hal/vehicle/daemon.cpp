#include "hal/vehicle/daemon.hpp"

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <optional>
#include <utility>

#include "firmware/canopen/cob_id.hpp"
#include "hal/config/task_check.hpp"
#include "hal/heap_guard/heap_guard.hpp"

namespace lf::hal {

namespace {

constexpr int look_every_ms = 20;
constexpr Duration stop_within = Duration::from_ms(8000);
// Clients are served until the arm is off; an order's answer is 4 ms away.
constexpr Duration serve_for = Duration::from_ms(20);
constexpr Duration serve_while_settling = Duration::from_ms(2);
constexpr std::uint64_t turns_a_camera_report = 20;

// Signals that came are taken, so that the next look sees only new ones.
bool signals_pending(int signals) {
  signalfd_siginfo info{};
  return signals >= 0 && read(signals, &info, sizeof info) == static_cast<ssize_t>(sizeof info);
}

void wait_for_signals(int signals) {
  pollfd waiting{signals, POLLIN, 0};
  (void)poll(&waiting, 1, look_every_ms);
}

LogWriter::Config log_of(const VehicleConfig& config) {
  return {config.log_folder, config.interface, config.log_file_mb * 1'000'000, config.log_keep, config.log_pack};
}

}  // namespace

Daemon::Daemon(const VehicleConfig& config, const Surroundings& surroundings)
    : config_(config),
      estop_(config.estop_input),
      estop_line_(estop_.present()),
      platform_(config, log_rings_, loop_rings_, estop_line_, *surroundings.calls),
      control_(platform_, config.core.controller, loop_rings_),
      vision_(platform_, config.core.scan, loop_rings_),
      board_(log_rings_, loop_rings_, config.core.error_texts),
      writer_(log_rings_, log_of(config), *surroundings.calls),
      commissioner_(config, loop_rings_, [this](const Json& line) { writer_.say(line); }),
      desk_(loop_rings_, ways(surroundings)),
      server_([this](const std::string& line, unsigned user, OperatorServer::Ticket ticket) { return desk_.take(line, user, ticket); },
              OrderDesk::is_stop) {
  if (const std::string taken = lock_.take(config.lock_folder, config.interface); !taken.empty()) throw EnvironmentLacks(taken);
  if (const PortStatus error = platform_.open_bus(); error != port_ok) throw EnvironmentLacks(SocketCan::explain(error, config.interface));
  if (const auto other = hear_another_master(platform_.can(), listen_for_a_master))
    throw EnvironmentLacks(config.interface + ": " + *other);
  // An arm that is out must be led home and stowed without a camera, too.
  (void)platform_.open_camera(camera_lacks_);
  if (const int error = writer_.open(); error != 0)
    throw EnvironmentLacks(config.log_folder + ": the log cannot be written there: " + std::strerror(error));
  server_.on_gone([this](OperatorServer::Ticket ticket) { desk_.gone(ticket); });
  if (const int error = server_.open(config.operator_socket, {config.operator_everyone, config.operator_group}); error != 0)
    throw EnvironmentLacks(OperatorServer::explain(error, config.operator_socket));
}

Daemon::~Daemon() { stop_threads(); }

OrderDesk::Ways Daemon::ways(const Surroundings& surroundings) {
  OrderDesk::Ways ways;
  ways.status = [this] { return status(); };
  ways.restart_bus = [restart = surroundings.restart_can, interface = config_.interface] { return restart(interface); };
  ways.log = [this](const Json& line) { writer_.say(line); };
  ways.look_up = surroundings.look_up;
  if (!ways.look_up) {
    ways.look_up = [operators = config_.operators, engineers = config_.engineers](unsigned user) {
      return look_up_user(user, operators, engineers);
    };
  }
  ways.interface = config_.interface;
  ways.names = config_.machine.survey.names;
  ways.joints = config_.core.error_texts.names();
  ways.why_not = [this](const mission::Tasks& tasks) {
    const std::string beyond = config::turn_problem(tasks, config_.core.controller.mission.layout, config_.machine.survey.names);
    return beyond.empty() ? config::tasks_problem(config_.machine, config_.core, tasks) : beyond;
  };
  ways.no_sight = [this]() -> std::string { return board_.newest().camera.images > 0 ? "" : camera_lacks_; };
  ways.commissioner = &commissioner_;
  return ways;
}

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
    vision_.turn();
    if (turn % turns_a_camera_report == 0) (void)loop_rings_.cameras.push(platform_.camera_report());
  }
  (void)loop_rings_.cameras.push(platform_.camera_report());
}

void Daemon::run_operator() {
  name_thread("operator");
  const auto reply = [this](OperatorServer::Ticket ticket, const std::string& answer) { server_.reply(ticket, answer); };
  while (!operator_stops_) {
    server_.serve(desk_.settled() ? serve_for : serve_while_settling, -1);
    commissioner_.hear(board_.newest().control);
    commissioner_.step();
    desk_.settle(reply);
  }
}

void Daemon::start_threads() {
  lost_ = lock_process_memory(config_.realtime);
  std::atomic<bool> ready{false};
  control_runs_ = true;
  watch_estop(monotonic_now());  // an input that nobody has read is open
  control_thread_ = std::thread([this, &ready] {
    const std::vector<std::string> refused = become_realtime(config_.realtime);
    lost_.insert(lost_.end(), refused.begin(), refused.end());
    realtime_ = refused.empty() && config_.realtime.priority > 0;
    prefault_stack();
    ready = true;
    run_control();
  });
  vision_thread_ = std::thread([this] { run_vision(); });
  while (!ready) {
    watch_estop(monotonic_now());
    sleep_until(monotonic_now() + Duration::from_ms(1));
  }
  writer_.start();
  writer_.say({{"t_s", monotonic_now().s()},
               {"kind", "begin"},
               {"config", config_.machine.file},
               {"interface", config_.interface},
               {"camera", config_.camera_source == "none" ? "none"
                          : camera_lacks_.empty()         ? "there"
                                                          : camera_lacks_},
               {"lost", lost_}});
  operator_thread_ = std::thread([this] { run_operator(); });
}

bool Daemon::run(int signals, bool one_job) {
  start_threads();
  if (!camera_lacks_.empty()) std::fprintf(stderr, "lanternfishd: %s; without it there is no `start`\n", camera_lacks_.c_str());
  for (const std::string& loss : lost_) std::fprintf(stderr, "lanternfishd: %s\n", loss.c_str());
  notify_service_manager("READY=1\nSTATUS=waiting for orders");
  bool job_ended = false, refused = one_job && !camera_lacks_.empty();
  if (one_job && !refused) give_own(Command::start);

  while (control_runs_ && !job_ended && !refused) {
    wait_for_signals(signals);
    look_after();
    if (signals_pending(signals)) break;
    job_ended = one_job && board_.newest().control.outcome.ended;
    refused = one_job && start_refused();
  }
  const mission::Outcome outcome = board_.newest().control.outcome;
  if (refused) std::fprintf(stderr, "lanternfishd: the job was not begun: `lanternfishd status` says how the arm stands\n");
  notify_service_manager("STOPPING=1");
  stop_threads();
  return one_job ? job_ended && outcome.success : !outcome.ended || outcome.success;
}

// Nothing here waits: the emergency-stop input and the watchdog hang on it.
void Daemon::look_after() {
  const Time now = monotonic_now();
  watch_estop(now);
  feed_watchdog(now);
  board_.collect(now, [this](const Json& line) { writer_.say(line); });
}

bool Daemon::start_refused() {
  for (OrderAnswer answer; loop_rings_.own_answers.pop(answer);) {
    if (!answer.taken) return true;
  }
  return false;
}

// The arm comes to rest, loses power, and its nodes are stopped. Clients are served meanwhile.
void Daemon::stop_threads() {
  if (!control_thread_.joinable()) return;
  give_own(Command::shut_down);
  const Time end = monotonic_now() + stop_within;
  while (control_runs_ && monotonic_now() < end) {
    sleep_until(monotonic_now() + Duration::from_ms(5));
    look_after();
  }
  control_gives_up_ = true;
  control_thread_.join();
  take_power();
  vision_stops_ = true;
  vision_thread_.join();
  operator_stops_ = true;
  operator_thread_.join();
  look_after();
  writer_.stop();
}

// What the core did not bring about in time is told to the drives directly: the nodes' start, since a stopped node takes no process data; an order without
// power; two SYNCs, with which it acts; each drive's restart, for those that take no process data; and the nodes' stop.
void Daemon::take_power() {
  if (control_.stopped()) return;  // only once the mission is over, and its power off
  CanFrame nmt;
  nmt.id = canopen::cob_id::nmt;
  nmt.length = 2;
  nmt.data[0] = 1;
  std::vector<CanFrame> frames{nmt};
  for (const canopen::DriveSetup& drive : config_.core.controller.network.drives) {
    CanFrame disable;  // controlword 0: disable voltage; the rest of it is not looked at without power
    disable.id = canopen::cob_id::rpdo1 + drive.node;
    disable.length = 8;
    frames.push_back(disable);
  }
  CanFrame sync;
  sync.id = canopen::cob_id::sync;
  frames.push_back(sync);
  for (int i = 0; i < 2; ++i) {
    (void)platform_.send_can(0, frames);
    sleep_until(monotonic_now() + config_.core.controller.network.sync_period);
  }
  frames.clear();
  for (const canopen::DriveSetup& drive : config_.core.controller.network.drives) {
    nmt.data = {0x81, drive.node};
    frames.push_back(nmt);
  }
  nmt.data = {2, 0};
  frames.push_back(nmt);
  (void)platform_.send_can(0, frames);
  writer_.say({{"t_s", monotonic_now().s()}, {"kind", "power taken"}, {"why", "the core did not end in time without power"}});
}

void Daemon::give_own(Command command) {
  NumberedOrder order;
  order.order.command = command;
  (void)loop_rings_.own.push(order);
}

void Daemon::watch_estop(Time now) {
  if (!estop_.present()) return;
  const bool closed = estop_.closed();
  estop_line_.tell(closed, now);
  if (closed == !estop_open_) return;
  estop_open_ = !closed;
  writer_.say({{"t_s", now.s()}, {"kind", closed ? "emergency-stop chain closed" : "emergency stop"}, {"input", config_.estop_input}});
}

// Only while the control thread beats: one that hangs is the service manager's to see.
void Daemon::feed_watchdog(Time now) {
  static const std::optional<Duration> interval = watchdog_interval();
  const std::uint64_t beats = beats_.load(std::memory_order_relaxed);
  if (!interval || now < next_feed_ || beats == last_beats_) return;
  last_beats_ = beats;
  next_feed_ = now + *interval / 2;
  notify_service_manager("WATCHDOG=1");
}

}  // namespace lf::hal
