// What the sub-commands share: how one is added, what it may end with, and where its words go.
//
// stdout carries the answer (with --json one JSON document and nothing else), stderr everything said on the way.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace lf::app {

enum ExitStatus : int { done = 0, failed = 1, bad_input = 2, environment = 3 };

// Something outside of the program is missing: exit status 3. The message says what to do about it.
class EnvironmentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What the chosen sub-command does; its return value is the exit status. InputError and EnvironmentError become their exit statuses in main().
using Action = std::function<int()>;

// Each adds its sub-command to `app`, which sets `action` when it is chosen.
void add_run(CLI::App& app, Action& action);
void add_campaign(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_scenarios(CLI::App& app, Action& action);
void add_serve(CLI::App& app, Action& action);
void add_render_frames(CLI::App& app, Action& action);
void add_reach(CLI::App& app, Action& action);
void add_peaks(CLI::App& app, Action& action);
void add_plane(CLI::App& app, Action& action);
void add_markers(CLI::App& app, Action& action);
void add_ik(CLI::App& app, Action& action);
void add_check(CLI::App& app, Action& action);
void add_new(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);
void add_version(CLI::App& app, Action& action);

// Keys in the order they are put in, as the contract lists them.
using Json = nlohmann::ordered_json;

// One document on stdout, numbers that are not finite as null. Both: what a reader that went away (`| head`) would have got is left out in silence.
void print_json(const Json& document);

// printf to stdout. Throws EnvironmentError when stdout cannot be written (a full disk).
void print(const char* format, ...) __attribute__((format(printf, 1, 2)));

// Says on stderr why the answer about `file` is to be doubted, a line a reason; the command then ends with exit status 1.
void tell_doubts(const std::string& file, const std::vector<std::string>& doubts);

// "1 peak", "3 peaks".
std::string count_of(std::size_t n, const std::string& noun);

}  // namespace lf::app
