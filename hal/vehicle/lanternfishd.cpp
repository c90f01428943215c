// The `lanternfishd` program: the daemon itself, and its sub-commands for the operator.
// Exit status: 0 done (of an order: it was taken), 1 the job failed or an order was refused, 2 bad input, 3 this machine lacks something.
#include <unistd.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "hal/command_line/help_command.hpp"
#include "hal/command_line/refusal.hpp"
#include "hal/config/arm_notes.hpp"
#include "hal/config/holding.hpp"
#include "hal/config/homing_file.hpp"
#include "hal/config/share.hpp"
#include "hal/vehicle/daemon.hpp"
#include "hal/vehicle/doctor/examination.hpp"
#include "hal/vehicle/doctor_command.hpp"
#include "hal/vehicle/end_signals.hpp"
#include "hal/vehicle/manual.hpp"
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
  bool print_config = false;
  bool print_schema = false;
  bool json = false;
};

bool json_wanted = false;

void complain(const std::string& message) {
  for (std::size_t at = 0; at < message.size();) {
    const std::size_t end = std::min(message.find('\n', at), message.size());
    std::fprintf(stderr, "lanternfishd: %s\n", message.substr(at, end - at).c_str());
    at = end + 1;
  }
}

// A text that nobody can have read is no success. A reader that went away (`| head`) has had enough.
int print(const std::string& text) {
  errno = 0;
  std::fputs(text.c_str(), stdout);
  if ((std::fflush(stdout) != 0 || std::ferror(stdout) != 0) && errno != EPIPE)
    throw EnvironmentLacks(std::string("standard output: ") + std::strerror(errno));
  return done;
}

// Of what ends the program: a script that asked for JSON reads why from stdout, as a person does from stderr.
int refuse(const std::string& message, int status) {
  complain(message);
  if (!json_wanted) return status;
  Json problems = Json::array();
  for (std::size_t at = 0; at < message.size();) {
    const std::size_t end = std::min(message.find('\n', at), message.size());
    problems.push_back(message.substr(at, end - at));
    at = end + 1;
  }
  const Json document{{"problems", problems}, {"exit_status", status}};
  std::printf("%s\n", document.dump(1, ' ', false, Json::error_handler_t::replace).c_str());
  return status;
}

std::vector<std::string> notes_of(const VehicleConfig& config) {
  const std::string urdf = config::find_file(config.machine.arm_urdf, std::filesystem::path(config.machine.file).parent_path());
  std::vector<std::string> notes = config::arm_notes(urdf);
  const ArmDescription arm = load_arm_urdf(urdf);
  for (const std::string& note : config::holding_notes(arm, config::holding_of(arm, config.machine.drives)))
    notes.push_back(config.machine.told_in() + ": " + note);
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
    for (const doctor::Examination& one : doctor::examine(config)) {
      if (one.grade != doctor::Grade::bad) continue;
      report["problems"].push_back({{"key", one.key.empty() ? one.subject : one.key}, {"problem", one.found}, {"remedy", one.remedy}});
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
  if (options.print_schema) return print(vehicle_schema());
  if (options.print_config) return print(print_vehicle_config(options.config));
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

std::string usual_socket() {
  if (const char* set = std::getenv("LANTERNFISHD_SOCKET"); set != nullptr && *set != '\0') return set;
  return VehicleConfig().operator_socket;
}

std::string socket_of(const Options& options) {
  if (!options.socket.empty()) return options.socket;
  return options.config.empty() ? usual_socket() : load_vehicle_config(options.config).operator_socket;
}

int tell(const Options& options, const Json& request, const Json& reply) {
  if (options.json) {
    std::printf("%s\n", reply.dump(1).c_str());
  } else if (!reply.value("ok", false)) {
    complain("refused: " + reply.value("why", std::string("no reason given")));
  } else if (request["do"] == "status") {
    std::fputs(status_text(reply).c_str(), stdout);
  }
  return reply.value("ok", false) ? done : failed;
}

// To each of these sockets. It was taken when one has taken it.
int stop_at(const std::vector<std::string>& sockets, const Options& options, const Json& request) {
  std::optional<int> status;
  std::string silent;
  for (const std::string& socket : sockets) {
    try {
      const int one = tell(options, request, ask_daemon(socket, request));
      status = status ? std::min(*status, one) : one;
    } catch (const EnvironmentLacks& lacks) {
      silent += (silent.empty() ? "" : "; ") + std::string(lacks.what());
    }
  }
  if (!status) throw EnvironmentLacks(silent);
  return *status;
}

// A stop goes out whatever is wrong with the vehicle's file. Where that does not tell its socket, it goes to all that it may be, which may be another arm's: no
// success.
int ask_for_stop(const Options& options, const Json& request) {
  if (!options.socket.empty() || options.config.empty()) return tell(options, request, ask_daemon(socket_of(options), request));
  StopSocket found = stop_socket(options.config);
  for (const std::string& problem : found.problems) complain(problem);
  if (found.told) return stop_at(found.paths, options, request);
  for (const std::string& usual : {usual_socket(), VehicleConfig().operator_socket}) {
    if (std::find(found.paths.begin(), found.paths.end(), usual) == found.paths.end()) found.paths.push_back(usual);
  }
  std::string all;
  for (const std::string& path : found.paths) all += (all.empty() ? "" : " and ") + path;
  complain("the file does not tell the daemon's socket: the stop goes to " + all + ". Look whether " +
           (found.paths.size() > 1 ? "this arm's is among them" : "that is this arm's"));
  (void)stop_at(found.paths, options, request);
  return failed;
}

int ask(const Options& options, const Json& request) {
  if (request["do"] == "estop") return ask_for_stop(options, request);
  return tell(options, request, ask_daemon(socket_of(options), request));
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

// "90", or "V2=90"; null where it is neither.
Json turn_of(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string angle = equals == std::string::npos ? text : text.substr(equals + 1);
  double to_deg = 0;
  const auto [end, error] = std::from_chars(angle.data(), angle.data() + angle.size(), to_deg);
  if (error != std::errc() || end != angle.data() + angle.size() || equals == 0) return nullptr;
  Json turn{{"to_deg", to_deg}};
  if (equals != std::string::npos) turn["valve"] = text.substr(0, equals);
  return turn;
}

std::string turn_problem(const std::string& text) {
  return turn_of(text).is_null() ? "'" + text + "' is no angle in degrees, and no VALVE=ANGLE" : "";
}

void add_task(CLI::App& app, const Options& options, Action& action) {
  struct Job {
    std::vector<std::string> turns;
    std::vector<std::string> buttons;
  };
  auto job = std::make_shared<Job>();
  CLI::App* command = app.add_subcommand("task", right_of("task")->does);
  command->add_option("--turn", job->turns, "turn the valve to this angle, degrees; VALVE=ANGLE where the panel has several")
      ->expected(1)
      ->check(turn_problem);
  command->add_option("--press", job->buttons, "then press these buttons, by their names on the panel: left,centre")->delimiter(',');
  command->callback([&options, &action, job] {
    action = [&options, job] {
      Json tasks = Json::array();
      for (const std::string& turn : job->turns) tasks.push_back({{"turn_valve", turn_of(turn)}});
      if (!job->buttons.empty()) tasks.push_back({{"press_buttons", {{"order", job->buttons}}}});
      return ask(options, {{"do", "task"}, {"tasks", tasks}});
    };
  });
}

struct CommissionOptions {
  std::vector<std::string> joints;
  bool here = false;
  bool clear = false;
  bool moved = false;
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
  Json request{{"do", "commission"}, {"here", wanted.here}, {"clear", wanted.clear}, {"moved", wanted.moved}};
  if (!wanted.joints.empty()) request["joints"] = wanted.joints;
  const std::string socket = socket_of(options);
  const Json reply = ask_daemon(socket, request);
  if (!reply.value("ok", false)) {
    complain("refused: " + reply.value("why", std::string("no reason given")));
    return failed;
  }
  return follow_commissioning(socket, options.json);
}

void add_doctor(CLI::App& app, const Options& options, Action& action) {
  auto request = std::make_shared<DoctorRequest>();
  CLI::App* command = app.add_subcommand(
      "doctor",
      "look at this machine as the configuration has it, and read the bus: which drives are on it, and what differs from their profiles");
  command->add_option("--interface", request->interface, "The CAN interface, in place of the configuration's");
  CLI::Option* machine = command->add_flag("--machine", request->machine_only, "Leave the bus alone");
  command->add_flag("--bus", request->bus_only, "Only read the bus")->excludes(machine);
  command->callback([&options, &action, request] {
    action = [&options, request] {
      request->config = options.config;
      request->json = options.json;
      return run_doctor(*request);
    };
  });
}

void add_commission(CLI::App& app, const Options& options, Action& action) {
  auto wanted = std::make_shared<CommissionOptions>();
  CLI::App* command = app.add_subcommand("commission", right_of("commission")->does);
  command->add_option("--joint", wanted->joints, "only this one")->allow_extra_args(false);
  command->add_flag("--here", wanted->here, "the arm stands at its zero, in a jig: nothing moves");
  command->add_flag("--clear", wanted->clear, "nobody and nothing is within the arm's reach");
  command->add_flag("--moved", wanted->moved, "the encoder or the stop of this one joint was changed: its zero may be elsewhere");
  command->callback([&options, &action, wanted] { action = [&options, wanted] { return commission(options, *wanted); }; });
}

// What completes the arguments of orders.
command_line::WordSources word_sources() {
  std::string joints = "printf \"%s\\n\"";
  for (const std::string& joint : JointNames()) joints += " " + joint;  // the default machine's
  return {{"JOINT", {joints}}, {"--joint", {joints}}, {"--press", {"printf \"%s\\n\" left centre right"}}};
}

int run(int argc, char** argv) {
  CLI::App app{"Lanternfish's control core on the vehicle: SocketCAN, camera, real time", "lanternfishd"};
  Options options;
  Action action = [&options] { return run_daemon(options); };
  app.add_option("--config", options.config, "The vehicle's configuration");
  app.add_option("--socket", options.socket, "The operator interface's socket, for the sub-commands");
  app.add_flag("--check", options.check, "Only check the configuration, and what this machine has of it");
  app.add_flag("--print-config", options.print_config, "Print every key with its range and default: of --config, else with the defaults");
  app.add_flag("--print-schema", options.print_schema, "Print the JSON Schema of configurations, for editors");
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
  command_line::add_help_commands(app, action, manual_of(app), word_sources(), [](const std::string& text) { print(text); });
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    std::ostringstream text;
    const int status = app.exit(help, text, text);
    print(text.str());
    return status;
  } catch (const CLI::ParseError& error) {
    return refuse(command_line::refusal(app, error), bad_input);
  }
  return action();
}

}  // namespace

}  // namespace lf::hal

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  lf::hal::json_wanted = std::any_of(argv, argv + argc, [](std::string_view word) { return word == "--json"; });
  try {
    return lf::hal::run(argc, argv);
  } catch (const lf::InputError& error) {
    return lf::hal::refuse(error.what(), lf::hal::bad_input);
  } catch (const lf::hal::EnvironmentLacks& error) {
    return lf::hal::refuse(error.what(), lf::hal::environment);
  } catch (const std::exception& error) {
    return lf::hal::refuse(std::string("unexpected: ") + error.what(), lf::hal::environment);
  }
}
