#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <memory>
#include <thread>

#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/run_experiment.hpp"
#include "host_sim/app/run_session.hpp"
#include "host_sim/app/shell_word.hpp"
#include "host_sim/app/tell_arm.hpp"
#include "host_sim/campaign/utc_time.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string scenario = "default";
  std::uint64_t seed = 1;
  std::vector<std::string> set;
  std::string out;
  bool realtime = false;
  int render_threads = 0;
  bool outside = true;
  bool record_images = false;
  bool quiet = false;
  bool json = false;
};

// One thread steps the world, the rest render.
int default_render_threads() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

std::string command_of(const Options& options) {
  std::string command = "lanternfish run " + shell_word(options.scenario) + " --seed " + std::to_string(options.seed);
  for (const std::string& set : options.set) command += " --set " + shell_word(set);
  return command;
}

// What the reason does not say already.
void tell_failure(const record::FailureRecord& failure) {
  const auto is_news = [&failure](const std::string& text) { return failure.reason.find(text) == std::string::npos; };
  if (is_news(failure.cause)) print("  cause: %s\n", failure.cause.c_str());
  if (is_news(failure.remedy)) print("  what to do: %s\n", failure.remedy.c_str());
  if (!failure.seen.empty()) print("  the look saw: %s\n", failure.seen.c_str());
}

void tell_error(const char* name, double value, const char* unit) {
  if (std::isfinite(value)) print("  %-32s %8.3f %s\n", name, value, unit);
}

// The core's own account, so not among the errors.
void tell_calibration(const record::RunResult& result) {
  if (!result.calibration) return;
  const record::CalibrationRecord& fit = *result.calibration;
  print("left over by looks and presses:\n");
  tell_error("marker's side on the plane", fit.marker_side_percent, "%");
  tell_error("marker's corners about a square", fit.marker_corners_mm, "mm");
  tell_error("plane's bend", fit.plane_bend_mm, "mm");
  tell_error("panel's shift between looks", fit.panel_shift_mm, "mm");
  tell_error("buttons' faces, behind their place", fit.faces_off_mm, "mm");
  if (!fit.doubt.empty()) print("doubtful calibration: %s. %s\n", fit.doubt.c_str(), fit.remedy.c_str());
}

void tell(const RunOutcome& outcome, const std::string& folder) {
  const record::RunResult& result = outcome.result;
  for (const record::TaskRecord& task : result.tasks) {
    if (task.task == "turn_valve") {
      print("turn valve%s%s to %.1f deg: %s, it stands at %.2f deg\n", task.valve.empty() ? "" : " ", task.valve.c_str(), task.target_deg,
            task.done ? "done" : "NOT DONE", task.reached_deg);
    } else {
      print("press %s button: %s\n", task.button.c_str(), task.done ? "done" : "NOT DONE");
    }
  }
  print("errors against the truth:\n");
  tell_error("plane, normal", result.errors.plane_normal_deg, "deg");
  tell_error("plane, offset", result.errors.plane_offset_mm, "mm");
  tell_error("panel's place over the room kept for it", result.errors.panel_over_doubt, "");
  tell_error("valve's base", result.errors.valve_base_mm, "mm");
  tell_error("handle's angle", result.errors.handle_angle_deg, "deg");
  tell_error("cloud to the true surface, median", result.errors.cloud_truth_median_mm, "mm");
  tell_error("cloud to the true surface, p95", result.errors.cloud_truth_p95_mm, "mm");
  tell_error("peaks, rms", result.errors.peak_rms_px, "px");
  tell_error("peaks away from edges, rms", result.errors.peak_rms_smooth_px, "px");
  tell_error("clear peaks away from marks, rms", result.errors.peak_rms_clear_px, "px");
  tell_error("their bound", result.errors.peak_bound_px, "px");
  tell_error("peaks at marks, rms", result.errors.peak_rms_at_marks_px, "px");
  tell_error("peaks, recall", result.errors.peak_recall, "");
  tell_error("peaks, false", result.errors.peaks_false, "");
  tell_calibration(result);
  print("%.1f s simulated in %.1f s, %.1f x real time\n", result.time.simulated_s, result.time.wall_s, result.time.real_time_factor);
  print("bus load %.1f %%; without stuff bits %.1f %%, with worst-case stuffing %.1f %%\n", result.bus.load_percent,
        result.bus.load_unstuffed_percent, result.bus.load_worst_case_percent);
  for (const std::string& fault : result.faults_not_made) print("note: this fault did not happen: %s\n", fault.c_str());
  if (result.success) {
    const std::string expected = result.expected_failure ? ": it failed as expected, " + result.expected_failure->reason : "";
    print("SUCCESS%s\n", expected.c_str());
  } else {
    print("%s in %s: %s\n", result.false_success ? "FALSE SUCCESS" : "FAILED", result.failure->phase.c_str(),
          result.failure->reason.c_str());
    tell_failure(*result.failure);
  }
  if (outcome.has_report && outcome.kept) print("report: %s/report.html\n", folder.c_str());
}

int run(const Options& options) {
  RunRequest request;
  request.scenario = scenario::load_scenario(options.scenario, options.set);
  scenario::check_runnable(request.scenario);
  tell_arm_notes(request.scenario);
  request.seed = options.seed;
  request.realtime = options.realtime;
  request.outside = options.outside;
  request.render_threads = options.render_threads > 0 ? options.render_threads : default_render_threads();
  request.experiment = experiment_of(request.scenario, options.seed);
  request.out = options.out.empty()
                    ? default_folder(request.scenario.name + "-" + std::to_string(options.seed), !options.set.empty(), request.experiment)
                    : std::filesystem::path(options.out);
  request.record_images = options.record_images;
  request.provenance.command = command_of(options);
  request.provenance.set = options.set;
  request.provenance.date_utc = campaign::utc_text(std::time(nullptr));
  if (!options.quiet) request.say = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  catch_interrupts();
  const RunOutcome outcome = run_mission(request);
  if (options.json) {
    print("%s", record::result_json(outcome.result).c_str());
  } else {
    tell(outcome, request.out.string());
  }
  if (!outcome.write_error.empty())
    throw EnvironmentError(outcome.write_error +
                           (outcome.kept ? "; what was recorded before is kept" : "; the finished run that stands there is kept"));
  if (!outcome.kept) std::fprintf(stderr, "interrupted: the finished run in %s is kept\n", request.out.c_str());
  if (outcome.interrupted && !outcome.result.success) return exit_interrupted;
  return outcome.result.success ? done : failed;
}

}  // namespace

void add_run(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("run", "Run a mission in the simulator and leave a folder with its report");
  auto options = std::make_shared<Options>();
  command->add_option("SCENARIO", options->scenario, "A file or a shipped name (`lanternfish scenarios`)")->capture_default_str();
  command->add_option("--seed", options->seed, "Draws everything random")->check(check_seed)->capture_default_str();
  command->add_option("--set", options->set, "path.to.key=value: change the scenario")->allow_extra_args(false);
  command->add_option("--out", options->out, "The run's folder (default runs/SCENARIO-SEED, with --set and a hash of it)");
  command->add_flag("--realtime", options->realtime, "No faster than the clock on the wall");
  command->add_option("--render-threads", options->render_threads, "Threads that render (default: all; the result is the same)")
      ->check(CLI::Range(1, 256));
  command->add_flag("--record-images", options->record_images, "Keep the camera's pictures as they are, with their poses, in raw/ (40 MB)");
  command->add_flag("!--no-outside", options->outside, "No pictures of the robot from outside");
  command->add_flag("--quiet", options->quiet, "Do not tell each phase on stderr as it ends");
  command->add_flag("--json", options->json, "Print result.json");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace lf::app
