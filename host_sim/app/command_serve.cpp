#include <cmath>
#include <ctime>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "hal/config/homing_file.hpp"
#include "hal/config/key_text.hpp"
#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/run_experiment.hpp"
#include "host_sim/app/shell_word.hpp"
#include "host_sim/app/tell_arm.hpp"
#include "host_sim/campaign/utc_time.hpp"
#include "host_sim/record/folder_in_writing.hpp"
#include "host_sim/serve/serve_session.hpp"
#include "shared/input_error.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string scenario = "default";
  std::uint64_t seed = 1;
  std::vector<std::string> set;
  std::string can;
  std::string nodes = "all";
  std::string camera = "none";
  std::string homing, renderer, orders, out;
  int render_threads = 1;
  double for_s = 0;
  bool json = false;
};

void tell(const serve::ServeResult& result) {
  for (const record::TaskRecord& task : result.tasks) {
    if (task.task == "turn_valve") {
      print("turn valve%s%s to %.1f deg: %s, it stands at %.2f deg\n", task.valve.empty() ? "" : " ", task.valve.c_str(), task.target_deg,
            task.done ? "done" : "not done", task.reached_deg);
    } else {
      print("press %s button: %s\n", task.button.c_str(), task.done ? "done" : "not done");
    }
  }
  print("bus: %llu frames received, %llu sent, %.1f %% load with their stuff bits; ",
        static_cast<unsigned long long>(result.frames_received), static_cast<unsigned long long>(result.frames_sent), result.load_percent);
  if (std::isfinite(result.answer_us.max)) {
    print("a SYNC answered after %.0f us (p50), %.0f us (p99), %.0f us at most\n", result.answer_us.p50, result.answer_us.p99,
          result.answer_us.max);
  } else {
    print("no SYNC came\n");
  }
  if (result.camera) {
    print("camera: %llu exposures, %llu frames, %llu of them late\n", static_cast<unsigned long long>(result.camera->exposures),
          static_cast<unsigned long long>(result.camera->frames), static_cast<unsigned long long>(result.camera->late));
  }
  const serve::PaceStats& pace = result.pace;
  print("real time: %s; %.1f s, latest step %.2f ms late, %llu of %llu over 1 ms, %llu over 4 ms, %.1f ms lost\n",
        pace.held() ? "held" : "NOT HELD", result.simulated_s, 1e3 * pace.worst.s(), static_cast<unsigned long long>(pace.late_1_ms),
        static_cast<unsigned long long>(pace.steps), static_cast<unsigned long long>(pace.late_4_ms), 1e3 * pace.lost.s());
}

serve::ServeResult serve_or_say_what_lacks(const serve::ServeRequest& request) {
  try {
    return serve::serve(request, &interrupted);
  } catch (const InputError&) {
    throw;
  } catch (const record::RecordError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw EnvironmentError(error.what());
  }
}

std::string command_of(const Options& options) {
  std::string command = "lanternfish serve " + shell_word(options.scenario) + " --seed " + std::to_string(options.seed) + " --can " +
                        shell_word(options.can) + " --nodes " + shell_word(options.nodes) + " --camera " + shell_word(options.camera);
  if (!options.homing.empty()) command += " --homing " + shell_word(options.homing);
  if (!options.orders.empty()) command += " --orders " + shell_word(options.orders);
  if (options.for_s > 0) command += " --for " + config::number_text(options.for_s);
  for (const std::string& set : options.set) command += " --set " + shell_word(set);
  return command;
}

// What was served, to whom, and where the drives counted from.
record::Experiment served_experiment(const Options& options, const serve::ServeRequest& request) {
  record::Experiment experiment = experiment_of(request.scenario, request.seed);
  experiment["served nodes"] = request.nodes.text();
  experiment["camera"] = options.camera;
  if (!options.homing.empty()) experiment["file " + options.homing] = record::file_hash(options.homing);
  return experiment;
}

int run(const Options& options) {
  serve::ServeRequest request;
  request.scenario = scenario::load_scenario(options.scenario, options.set);
  tell_arm_notes(request.scenario);
  request.seed = options.seed;
  request.can = options.can;
  request.nodes = serve::NodeSet::parse(options.nodes);
  if (!options.homing.empty()) request.zero_counts = config::read_homing_file(options.homing, request.scenario.joints).zero_counts;
  request.camera = options.camera;
  request.renderer = options.renderer;
  request.render_threads = options.render_threads;
  request.orders = options.orders;
  request.for_s = options.for_s;
  request.say = [](const std::string& line) { std::fprintf(stderr, "lanternfish serve: %s\n", line.c_str()); };
  const record::Experiment experiment = served_experiment(options, request);
  const record::ProvenanceRecord provenance{campaign::utc_text(std::time(nullptr)), command_of(options), options.set, request.scenario.file,
                                            record::hash_of(experiment)};
  std::optional<record::FolderInWriting> out;
  if (!options.out.empty()) {
    request.folder = &out.emplace(options.out, experiment).folder();
    keep_scenario(request.scenario, *request.folder);
  }
  catch_interrupts();
  serve::ServeResult result = serve_or_say_what_lacks(request);
  result.version = version();
  result.provenance = provenance;
  const std::string text = serve::serve_result_json(result);
  if (out) {
    request.folder->write("result.json", text);
    out->publish();
  }
  if (options.json) {
    print("%s", text.c_str());
  } else {
    tell(result);
  }
  return done;
}

}  // namespace

void add_serve(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("serve", "Be the hardware: drives, outputs and camera in real time, on a CAN interface and a camera device");
  auto options = std::make_shared<Options>();
  command->add_option("SCENARIO", options->scenario, "A file or a shipped name (`lanternfish scenarios`)")->capture_default_str();
  command->add_option("--can", options->can, "SocketCAN interface, real or virtual: can0, vcan0")->required();
  command->add_option("--camera", options->camera, "Where frames go: ring:FILE, v4l2:/dev/videoN (v4l2loopback), none")
      ->capture_default_str();
  command->add_option("--nodes", options->nodes, "Nodes to serve, as 1-5 or 1,3,6, all, none; the others are real and are followed")
      ->capture_default_str();
  command->add_option("--homing", options->homing,
                      "Homing file, as the daemon has it: where the simulated drives count from, and the real ones that are followed");
  command->add_option("--seed", options->seed, "Draws everything random")->check(check_seed)->capture_default_str();
  command->add_option("--set", options->set, "path.to.key=value: change the scenario")->allow_extra_args(false);
  command->add_option("--renderer", options->renderer, "FILE that `lanternfish render-frames` renders for, instead of a thread here");
  command->add_option("--render-threads", options->render_threads, "Threads that render")->check(CLI::Range(1, 256))->capture_default_str();
  command->add_option("--orders", options->orders, "FIFO to read orders from: camera freeze 2, fault reboot elbow ...");
  command->add_option("--out", options->out, "Folder for result.json, can0.log, scenario.yaml and experiment.json, as a run leaves one");
  command->add_option("--for", options->for_s, "Seconds to serve (default: until SIGTERM)")->check(check_positive);
  command->add_flag("--json", options->json, "Print result.json");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace lf::app
