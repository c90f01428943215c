// The `lanternfishd` program: the daemon itself, and its sub-commands for the operator.
// Exit status: 0 done (of an order: it was taken), 1 the job failed or an order was refused, 2 bad input, 3 this machine lacks something.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/config/arm_notes.hpp"
#include "hal/config/drive_kind.hpp"
#include "hal/config/nearest.hpp"
#include "hal/config/share.hpp"
#include "hal/vehicle/bus_doctor.hpp"
#include "hal/vehicle/daemon.hpp"
#include "hal/vehicle/end_signals.hpp"
#include "hal/vehicle/instance_lock.hpp"
#include "hal/vehicle/machine_check.hpp"
#include "hal/vehicle/operator_client.hpp"
#include "hal/vehicle/tick_clock.hpp"
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

std::vector<std::string> notes_of(const VehicleConfig& config) {
  const std::string urdf = config::find_file(config.machine.arm_urdf, std::filesystem::path(config.machine.file).parent_path());
  std::vector<std::string> notes = config::arm_notes(urdf);
  notes.insert(notes.end(), config.core.notes.begin(), config.core.notes.end());
  if (config.camera_source == "none") notes.emplace_back("camera.source is none: `start` is refused, `home`, `jog` and stowing need none");
  for (const std::string& note : notes) std::fprintf(stderr, "lanternfishd: note: %s\n", note.c_str());
  return notes;
}

// The file and what this machine has of it, whatever is wrong with either.
int check(const Options& options) {
  Json report{{"config", options.config}, {"problems", Json::array()}};
  int status = done;
  try {
    std::vector<std::string> problems;
    const VehicleConfig config = load_vehicle_config(options.config, problems);
    for (const std::string& problem : problems) report["problems"].push_back({{"problem", problem}});
    if (problems.empty()) report["notes"] = notes_of(config);
    for (const Finding& finding : check_machine(config)) {
      report["problems"].push_back({{"key", finding.key}, {"problem", finding.problem}, {"remedy", finding.remedy}});
      status = environment;
    }
    if (!problems.empty()) status = bad_input;
  } catch (const InputError& error) {
    if (!options.json) throw;
    report["problems"].push_back({{"problem", error.what()}});
    status = bad_input;
  }
  report["ok"] = status == done;
  if (options.json) {
    std::printf("%s\n", report.dump(1, ' ', false, Json::error_handler_t::replace).c_str());
    return status;
  }
  for (const Json& one : report["problems"]) {
    const auto problem = one["problem"].get<std::string>();
    complain(one.contains("key") ? "'" + one["key"].get<std::string>() + "': " + problem + ": " + one["remedy"].get<std::string>()
                                 : problem);
  }
  if (status == bad_input) return status;
  std::printf("%s is valid%s\n", options.config.c_str(), status == done ? "" : ", but this machine lacks something");
  return status;
}

int run_daemon(const Options& options) {
  if (options.config.empty()) throw InputError("--config FILE is needed; `lanternfishd --help` has more");
  if (options.check) return check(options);
  const VehicleConfig config = load_vehicle_config(options.config);
  (void)notes_of(config);
  const int signals = take_end_signals();
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
    if (request == "jog" || request == "task" || request == "commission") continue;
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
  bool clear = false;
};

// What a commissioning is at, each time that this changes; its end.
int follow_commissioning(const std::string& socket, bool json) {
  std::string told;
  for (;;) {
    const Json status = ask_daemon(socket, {{"do", "status"}});
    const Json now = status.value("commissioning", Json::object());
    const std::string state = now.value("state", std::string("unknown"));
    if (state == "done" || state == "failed") {
      if (json) std::printf("%s\n", now.dump(1).c_str());
      if (state == "failed") complain(now.value("why", std::string("failed")));
      if (!json) std::printf("%s", commissioning_text(now).c_str());
      return state == "done" ? done : failed;
    }
    const std::string line = now.value("joint", std::string("the nodes")) + ": " + state;
    if (line != told && !json) std::fprintf(stderr, "%s ...\n", line.c_str());
    told = line;
    sleep_until(monotonic_now() + Duration::from_ms(200));
  }
}

// The daemon does it. An interrupt here ends only the telling: `lanternfishd abort` calls the commissioning off, `estop` stops it.
int commission(const Options& options, const CommissionOptions& wanted) {
  Json request{{"do", "commission"}, {"here", wanted.here}, {"clear", wanted.clear}};
  if (!wanted.joints.empty()) request["joints"] = wanted.joints;
  const std::string socket = socket_of(options);
  const Json reply = ask_daemon(socket, request);
  if (!reply.value("ok", false)) {
    complain("refused: " + reply.value("why", std::string("no reason given")));
    return failed;
  }
  return follow_commissioning(socket, options.json);
}

// On its own interface, or the configuration's. Refused while another program is master of the bus.
int examine_bus(const Options& options, std::string interface) {
  std::string lock_folder = VehicleConfig().lock_folder;
  ConfiguredDrives configured;
  if (!options.config.empty()) {
    const VehicleConfig vehicle = load_vehicle_config(options.config);
    lock_folder = vehicle.lock_folder;
    for (std::size_t i = 0; i < joint_count; ++i) {
      const config::JointDriveChoice drive = config::drive_of(vehicle.machine.drives, i);
      configured[static_cast<std::uint8_t>(drive.node)] = {
          config::joint_name(i), config::find_drive_kind(drive.profile, std::filesystem::path(vehicle.machine.file).parent_path())};
    }
    if (interface.empty()) interface = vehicle.interface;
  }
  if (interface.empty()) throw InputError("doctor needs --interface, or --config with 'can.interface'");
  // A daemon that waits for its first order sends nothing that could be heard.
  if (const auto held = locked_by_another(lock_folder, interface)) throw EnvironmentLacks(*held + "; stop it first");
  SocketCan::Config config;
  config.interface = interface;
  config.filters = core_filters();
  for (std::uint32_t node = 1; node <= 126; ++node) config.filters.push_back(CanFilter::exactly(0x580 + node));
  SocketCan can(config);
  if (const PortStatus error = can.open(); error != port_ok) throw EnvironmentLacks(SocketCan::explain(error, interface));
  // Questions on a bus that has a master would stop its arm: a core takes them for another master's.
  if (const auto master = hear_another_master(can, listen_for_a_master)) throw EnvironmentLacks(interface + ": " + *master);
  TickClock clock(Duration::from_ms(1));
  clock.start();
  std::vector<config::DriveKind> kinds, checked;
  for (const std::string& name : config::shipped_drive_kinds()) kinds.push_back(config::find_drive_kind(name, ""));
  checked = kinds;
  for (const auto& [node, drive] : configured) checked.push_back(drive.kind);
  BusDoctor doctor(1, 126, checked);
  std::vector<CanFrame> out;
  while (!doctor.done()) {
    const Time now = clock.wait();
    for (ReceivedFrame received; can.receive(received) == port_ok;) doctor.on_frame(received.frame, now);
    out.clear();
    doctor.step(now, out);
    (void)can.send(out);
  }
  std::fputs(doctor_text(doctor.nodes(), kinds, configured).c_str(), stdout);
  return doctor.nodes().empty() ? failed : done;
}

void add_doctor(CLI::App& app, const Options& options, Action& action) {
  auto interface = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("doctor", "read the bus: which drives are on it, and what differs from their profiles");
  command->add_option("--interface", *interface, "the CAN interface, in place of the configuration's");
  command->callback([&options, &action, interface] { action = [&options, interface] { return examine_bus(options, *interface); }; });
}

void add_commission(CLI::App& app, const Options& options, Action& action) {
  auto wanted = std::make_shared<CommissionOptions>();
  CLI::App* command = app.add_subcommand("commission", right_of("commission")->does);
  command->add_option("--joint", wanted->joints, "only this one; may be given again")->allow_extra_args(false);
  command->add_flag("--here", wanted->here, "the arm stands at its zero, in a jig: nothing moves");
  command->add_flag("--clear", wanted->clear, "nobody and nothing is within the arm's reach");
  command->callback([&options, &action, wanted] { action = [&options, wanted] { return commission(options, *wanted); }; });
}

int run(int argc, char** argv) {
  CLI::App app{"Lanternfish's control core on the vehicle: SocketCAN, camera, real time", "lanternfishd"};
  Options options;
  Action action = [&options] { return run_daemon(options); };
  app.add_option("--config", options.config, "The vehicle's configuration");
  app.add_option("--socket", options.socket, "The operator interface's socket, for the sub-commands");
  app.add_flag("--check", options.check, "Only check the configuration, and what this machine has of it");
  app.add_flag("--run", options.run_job, "Start the job at once and end with it");
  app.add_flag("--json", options.json, "Answer in JSON");
  app.set_version_flag("--version", version_line("lanternfishd"), "Print which build this is");
  app.fallthrough();
  app.require_subcommand(0, 1);
  add_simple_requests(app, options, action);
  add_jog(app, options, action);
  add_task(app, options, action);
  add_commission(app, options, action);
  add_doctor(app, options, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ExtrasError& error) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(command->get_name());
    const std::vector<std::string> extras = app.remaining(true);
    complain(error.what() + (extras.empty() ? std::string() : config::suggestion(extras.front(), names)));
    return bad_input;
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
