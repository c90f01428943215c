// The `lanternfish` command: picks the sub-command and turns what it throws into one line and an exit status.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "hal/command_line/help_command.hpp"
#include "hal/command_line/refusal.hpp"
#include "hal/config/nearest.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/manual.hpp"
#include "host_sim/record/file_sink.hpp"
#include "shared/input_error.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace {

void add_commands(CLI::App& app, Action& action) {
  add_run(app, action);
  add_campaign(app, action);
  add_compare(app, action);
  add_serve(app, action);
  add_render_frames(app, action);
  add_scenarios(app, action);
  add_reach(app, action);
  add_peaks(app, action);
  add_plane(app, action);
  add_markers(app, action);
  add_ik(app, action);
  add_check(app, action);
  add_new(app, action);
  add_export(app, action);
  add_bench(app, action);
  add_doctor(app, action);
  add_version(app, action);
  command_line::add_help_commands(app, action, manual_of(app), word_sources(), [](const std::string& text) { print("%s", text.c_str()); });
}

bool json_wanted = false;

// A line for each problem; with --json a document on stdout, too.
int complain(const std::string& message, int status) {
  Json problems = Json::array();
  std::istringstream lines(message);
  for (std::string line; std::getline(lines, line);) {
    std::fprintf(stderr, "lanternfish: %s\n", line.c_str());
    problems.push_back(line);
  }
  if (!json_wanted) return status;
  try {
    print_json({{"problems", problems}, {"exit_status", status}});
  } catch (const EnvironmentError&) {  // stdout is what failed: stderr has it already
  }
  return status;
}

void refuse_unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return;
    names.push_back(command->get_name());
  }
  const std::string near = config::suggestion(argv[1], names);
  throw InputError(std::string("no command '") + argv[1] + "'" + (near.empty() ? "; `lanternfish --help` lists them" : near));
}

int run_command(int argc, char** argv) {
  CLI::App app{"Lanternfish: an underwater robot that works on panels, and the simulator it is proven in", "lanternfish"};
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.set_version_flag("--version", version_line("lanternfish"), "Print which build this is");
  Action action;
  add_commands(app, action);
  try {
    refuse_unknown_command(app, argc, argv);
    if (argc < 2) {
      std::fputs(app.help().c_str(), stderr);
      return bad_input;
    }
    app.parse(argc, argv);
    return action();
  } catch (const CLI::Success& help) {  // --help and its like
    std::ostringstream text;
    const int status = app.exit(help, text, text);
    print("%s", text.str().c_str());
    return status;
  } catch (const CLI::ParseError& error) {
    return complain(command_line::refusal(app, error), bad_input);
  }
}

}  // namespace

}  // namespace lf::app

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is a failed write, not a death
  lf::app::json_wanted = std::any_of(argv, argv + argc, [](std::string_view word) { return word == "--json"; });
  try {
    return lf::app::run_command(argc, argv);
  } catch (const lf::InputError& error) {
    return lf::app::complain(error.what(), lf::app::bad_input);
  } catch (const lf::app::EnvironmentError& error) {
    return lf::app::complain(error.what(), lf::app::environment);
  } catch (const lf::record::RecordError& error) {
    return lf::app::complain(error.what(), lf::app::environment);
  } catch (const std::bad_alloc&) {
    return lf::app::complain("out of memory", lf::app::environment);
  } catch (const std::exception& error) {
    return lf::app::complain(std::string("unexpected: ") + error.what(), lf::app::environment);
  }
}
