// The `lanternfishd` program: the daemon itself, and its sub-commands for the operator.
// Exit status: 0 done, 1 the job failed or an order was refused, 2 bad input, 3 this machine lacks something.
#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hal/config/share.hpp"
#include "hal/vehicle/commissioning.hpp"
#include "hal/vehicle/daemon.hpp"
#include "hal/vehicle/operator_client.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/input_error.hpp"
#include "shared/version/version.hpp"

namespace lf::hal {

namespace {

constexpr int done = 0, failed = 1, bad_input = 2, environment = 3;

struct Options {
  std::string config;
  std::string socket;
  bool run_job = false;
  bool check = false;
  bool json = false;
};

void complain(const std::string& message) {
  for (std::size_t at = 0; at < message.size();) {
    const std::size_t end = std::min(message.find('\n', at), message.size());
    std::fprintf(stderr, "lanternfishd: %s\n", message.substr(at, end - at).c_str());
    at = end + 1;
  }
}

// Signals are taken by the main thread between two looks, never in a handler.
int take_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  return signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
}

int run_daemon(const Options& options) {
  if (options.config.empty()) throw InputError("--config FILE is needed; `lanternfishd --help` has more");
  const VehicleConfig config = load_vehicle_config(options.config);
  if (options.check) {
    std::printf("%s is sound\n", options.config.c_str());
    return done;
  }
  const int signals = take_signals();
  const auto daemon = std::make_unique<Daemon>(config);  // megabytes
  const bool well = daemon->run(signals, options.run_job);
  if (options.json) {
    std::printf("%s\n", daemon->status().dump(1).c_str());
  } else {
    std::fputs(daemon->summary().c_str(), stdout);
  }
  return well ? done : failed;
}

std::string socket_of(const Options& options) {
  if (!options.socket.empty()) return options.socket;
  if (!options.config.empty()) return load_vehicle_config(options.config).operator_socket;
  if (const char* set = std::getenv("LANTERNFISHD_SOCKET"); set != nullptr && *set != '\0') return set;
  return VehicleConfig().operator_socket;
}

int ask(const Options& options, const Json& request) {
  const Json reply = ask_daemon(socket_of(options), request);
  if (options.json) {
    std::printf("%s\n", reply.dump(1).c_str());
  } else if (!reply.value("ok", false)) {
    complain("refused: " + reply.value("why", std::string("no reason given")));
  } else if (request["do"] == "status") {
    std::fputs(status_text(reply).c_str(), stdout);
  }
  return reply.value("ok", false) ? done : failed;
}

using Action = std::function<int()>;

void add_simple_requests(CLI::App& app, const Options& options, Action& action) {
  for (const Right& right : operator_rights()) {
    const std::string request = right.request;
    if (request == "jog" || request == "task") continue;
    CLI::App* command = app.add_subcommand(request, right.does);
    command->callback([&options, &action, request] { action = [&options, request] { return ask(options, {{"do", request}}); }; });
  }
}

void add_jog(CLI::App& app, const Options& options, Action& action) {
  struct Jog {
    std::string joint;
    double by_deg = 0;
  };
  auto jog = std::make_shared<Jog>();
  CLI::App* command = app.add_subcommand("jog", right_of("jog")->does);
  command->add_option("JOINT", jog->joint, "slew, shoulder, elbow, roll or jaw")->required();
  command->add_option("DEGREES", jog->by_deg, "by how much, at most 20")->required();
  command->callback([&options, &action, jog] {
    action = [&options, jog] { return ask(options, {{"do", "jog"}, {"joint", jog->joint}, {"by_deg", jog->by_deg}}); };
  });
}

void add_task(CLI::App& app, const Options& options, Action& action) {
  struct Job {
    std::vector<double> turns;
    std::vector<std::string> buttons;
  };
  auto job = std::make_shared<Job>();
  CLI::App* command = app.add_subcommand("task", right_of("task")->does);
  command->add_option("--turn", job->turns, "turn the valve to this angle, degrees")->expected(1);
  command->add_option("--press", job->buttons, "then press these buttons: left, centre, right")->delimiter(',');
  command->callback([&options, &action, job] {
    action = [&options, job] {
      Json tasks = Json::array();
      for (const double turn : job->turns) tasks.push_back({{"turn_valve", {{"to_deg", turn}}}});
      if (!job->buttons.empty()) tasks.push_back({{"press_buttons", {{"order", job->buttons}}}});
      return ask(options, {{"do", "task"}, {"tasks", tasks}});
    };
  });
}

struct CommissionOptions {
  std::vector<std::string> joints;
  bool here = false;
  bool sure = false;
};

// A clock and a bus, without the rest of a vehicle.
struct BusOnly {
  SocketCan can;
  TickClock clock;
  PortStatus wait_for_tick(Time& tick) {
    tick = clock.wait();
    return port_ok;
  }
  PortStatus receive_can(std::uint8_t, ReceivedFrame& received) { return can.receive(received); }
  PortStatus send_can(std::uint8_t, std::span<const CanFrame> frames) { return can.send(frames); }
};

std::array<bool, joint_count> chosen(const CommissionOptions& options) {
  std::array<bool, joint_count> joints{};
  for (std::size_t i = 0; i < joint_count; ++i) {
    const auto named = std::find(options.joints.begin(), options.joints.end(), config::joint_name(i)) != options.joints.end();
    joints[i] = options.joints.empty() || named;
  }
  for (const std::string& name : options.joints) {
    bool known = false;
    for (std::size_t i = 0; i < joint_count; ++i) known = known || name == config::joint_name(i);
    if (!known) throw InputError("no joint '" + name + "': slew, shoulder, elbow, roll or jaw");
  }
  return joints;
}

// What cannot be read or written is told before anything moves.
config::HomingOffsets known_offsets(const std::string& file) {
  config::HomingOffsets offsets;
  if (std::filesystem::exists(file)) offsets = config::read_homing_file(file);
  const std::string folder = std::filesystem::absolute(file).parent_path().string();
  if (access(folder.c_str(), W_OK | X_OK) != 0) throw InputError(file + ": cannot be written: " + std::strerror(errno));
  return offsets;
}

void keep_offsets(const std::string& file, config::HomingOffsets offsets, const Commissioning& commissioning, bool here) {
  char day[32] = "";
  const std::time_t now = std::time(nullptr);
  std::strftime(day, sizeof day, "%Y-%m-%d %H:%M", std::gmtime(&now));
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (!commissioning.found()[i]) continue;
    offsets.zero_counts[i] = commissioning.zero_counts()[i];
    offsets.found[i] = std::string(here ? "in the jig, " : "at its stop, ") + day + " UTC";
    std::printf("%-9s zero at %d counts\n", config::joint_name(i), offsets.zero_counts[i]);
  }
  config::write_homing_file(file, offsets);
  std::printf("written to %s\n", file.c_str());
}

int commission(const Options& options, const CommissionOptions& wanted) {
  if (options.config.empty()) throw InputError("--config FILE is needed");
  const VehicleConfig config = load_vehicle_config(options.config);
  if (config.homing_file.empty()) throw InputError(options.config + ": 'homing.file' names no file to write to");
  Commissioning::Config setup;
  setup.network = config.core.controller.network;
  setup.joints = chosen(wanted);
  const std::filesystem::path folder = std::filesystem::path(options.config).parent_path();
  const ArmDescription arm = load_arm_urdf(config::find_file(config.machine.arm_urdf, folder));
  for (std::size_t i = 0; i < joint_count; ++i) setup.backlash_rad[i] = arm.joints[i].backlash_rad;
  setup.here = wanted.here;
  if (!wanted.sure && !wanted.here)
    throw InputError("commissioning moves the arm against its stops: clear its reach, then say so with --clear");
  const config::HomingOffsets known = known_offsets(config.homing_file);
  InstanceLock lock;
  if (const std::string taken = lock.take(config.lock_folder, config.interface); !taken.empty()) throw EnvironmentLacks(taken);
  BusOnly bus{SocketCan(config.can()), TickClock(setup.network.sync_period)};
  if (const PortStatus error = bus.can.open(); error != port_ok) throw EnvironmentLacks(SocketCan::explain(error, config.interface));
  if (const auto other = hear_another_master(bus.can, Duration::from_ms(350))) throw EnvironmentLacks(config.interface + ": " + *other);
  const int signals = take_signals();
  Commissioning commissioning(setup);
  bus.clock.start();
  const auto cancelled = [signals] {
    signalfd_siginfo info{};
    return read(signals, &info, sizeof info) > 0;
  };
  run_commissioning(bus, commissioning, cancelled, [](std::size_t joint) { std::fprintf(stderr, "%s ...\n", config::joint_name(joint)); });
  if (commissioning.state() == Commissioning::State::failed) {
    complain("nothing was written: " + commissioning.failure());
    return failed;
  }
  keep_offsets(config.homing_file, known, commissioning, wanted.here);
  return done;
}

void add_commission(CLI::App& app, const Options& options, Action& action) {
  auto wanted = std::make_shared<CommissionOptions>();
  CLI::App* command = app.add_subcommand("commission", "find and store the zeros of the joints' absolute encoders");
  command->add_option("--joint", wanted->joints, "only this one; may be given again")->allow_extra_args(false);
  command->add_flag("--here", wanted->here, "the arm stands at its zero, in a jig: nothing moves");
  command->add_flag("--clear", wanted->sure, "nobody and nothing is within the arm's reach");
  command->callback([&options, &action, wanted] { action = [&options, wanted] { return commission(options, *wanted); }; });
}

int run(int argc, char** argv) {
  CLI::App app{"Lanternfish's control core on the vehicle: SocketCAN, camera, real time", "lanternfishd"};
  Options options;
  Action action = [&options] { return run_daemon(options); };
  app.add_option("--config", options.config, "The vehicle's configuration");
  app.add_option("--socket", options.socket, "The operator interface's socket, for the sub-commands");
  app.add_flag("--check", options.check, "Only check the configuration");
  app.add_flag("--run", options.run_job, "Start the job at once and end with it");
  app.add_flag("--json", options.json, "Answer in JSON");
  app.set_version_flag("--version", version_line("lanternfishd"), "Print which build this is");
  app.fallthrough();
  app.require_subcommand(0, 1);
  add_simple_requests(app, options, action);
  add_jog(app, options, action);
  add_task(app, options, action);
  add_commission(app, options, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    complain(error.what());
    return bad_input;
  }
  return action();
}

}  // namespace

}  // namespace lf::hal

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return lf::hal::run(argc, argv);
  } catch (const lf::InputError& error) {
    lf::hal::complain(error.what());
    return lf::hal::bad_input;
  } catch (const lf::hal::EnvironmentLacks& error) {
    lf::hal::complain(error.what());
    return lf::hal::environment;
  } catch (const std::exception& error) {
    lf::hal::complain(std::string("unexpected: ") + error.what());
    return lf::hal::environment;
  }
}
