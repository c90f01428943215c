// The `lanternfishd` program: the daemon itself, and its sub-commands for the operator.
// Exit status: 0 done, 1 the job failed or an order was refused, 2 bad input, 3 this machine lacks something.
#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/vehicle/daemon.hpp"
#include "hal/vehicle/operator_client.hpp"
#include "shared/input_error.hpp"

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

int run(int argc, char** argv) {
  CLI::App app{"Lanternfish's control core on the vehicle: SocketCAN, camera, real time", "lanternfishd"};
  Options options;
  Action action = [&options] { return run_daemon(options); };
  app.add_option("--config", options.config, "The vehicle's configuration");
  app.add_option("--socket", options.socket, "The operator interface's socket, for the sub-commands");
  app.add_flag("--check", options.check, "Only check the configuration");
  app.add_flag("--run", options.run_job, "Start the job at once and end with it");
  app.add_flag("--json", options.json, "Answer in JSON");
  app.fallthrough();
  app.require_subcommand(0, 1);
  add_simple_requests(app, options, action);
  add_jog(app, options, action);
  add_task(app, options, action);
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
