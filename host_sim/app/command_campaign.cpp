#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "host_sim/app/campaign_options.hpp"
#include "host_sim/app/campaign_table.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/run_experiment.hpp"
#include "host_sim/record/run_folder.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace fs = std::filesystem;

namespace {

using Options = CampaignOptions;

struct Seeds {
  std::uint64_t first = 0, last = 0;
};

Seeds parse_seeds(const std::string& text) {
  constexpr std::uint64_t most = 1'000'000;
  Seeds seeds;
  const std::size_t dash = text.find('-');
  const auto number = [&](std::string_view part, std::uint64_t& value) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    return !part.empty() && error == std::errc() && end == part.data() + part.size();
  };
  const std::string_view all = text;
  const bool good = dash == std::string::npos ? number(all, seeds.first) && number(all, seeds.last)
                                              : number(all.substr(0, dash), seeds.first) && number(all.substr(dash + 1), seeds.last);
  if (!good) throw InputError("--seeds takes A-B or one number, not '" + text + "'");
  if (seeds.first > seeds.last) throw InputError("--seeds " + text + ": the first is above the last");
  if (seeds.last - seeds.first >= most) throw InputError("--seeds " + text + ": more than a million runs");
  return seeds;
}

// Runs each seed in a process of its own: a crash of one is one failed seed, and nothing is shared that could make runs differ.
class Campaign {
 public:
  Campaign(const Options& options, const scenario::Scenario& scenario, fs::path out)
      : options_(options), experiment_(experiment_of(scenario)), out_(std::move(out)), program_(fs::read_symlink("/proc/self/exe")) {}

  std::vector<record::RunResult> run(const Seeds& seeds) {
    const std::size_t jobs =
        static_cast<std::size_t>(options_.jobs > 0 ? options_.jobs : std::max(1u, std::thread::hardware_concurrency()));
    for (std::uint64_t seed = seeds.first; seed <= seeds.last && !interrupted(); ++seed) {
      if (std::optional<record::RunResult> kept = finished(seed)) {
        take(*kept, true);
        continue;
      }
      while (running_.size() >= jobs) reap();
      if (!interrupted()) start(seed);
    }
    while (!running_.empty()) reap();
    std::vector<record::RunResult> all;
    for (auto& [seed, result] : results_) all.push_back(std::move(result));
    return all;
  }

 private:
  static constexpr std::chrono::milliseconds look_every{20};

  fs::path folder(std::uint64_t seed) const { return out_ / std::to_string(seed); }

  // A result of this experiment that is already there, unless that run was interrupted.
  std::optional<record::RunResult> finished(std::uint64_t seed) const {
    const fs::path file = folder(seed) / "result.json";
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return std::nullopt;
    record::Experiment ours = experiment_;
    ours["seed"] = std::to_string(seed);
    if (record::read_experiment(folder(seed)) != ours) return std::nullopt;
    try {
      record::RunResult result = record::read_result_file(file);
      if (result.seed != seed || (result.failure && result.failure->reason == "interrupted")) return std::nullopt;
      return result;
    } catch (const InputError&) {
      return std::nullopt;  // half a file of a run that died: run again
    }
  }

  void start(std::uint64_t seed) {
    std::vector<std::string> words{program_,           "run", options_.scenario, "--seed", std::to_string(seed), "--out", folder(seed),
                                   "--render-threads", "1",   "--no-outside",    "--json"};
    for (const std::string& set : options_.set) words.insert(words.end(), {"--set", set});
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw EnvironmentError("no pipe could be made for a run");
    const pid_t child = fork();
    if (child < 0) throw EnvironmentError("no process could be started for a run");
    if (child == 0) {
      // A terminal's Ctrl-C goes to the campaign alone, which passes it on: a second one would end a run at once, its record lost.
      setpgid(0, 0);
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      const int null = open("/dev/null", O_WRONLY);
      dup2(null, STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(ends[1]);
    running_[child] = {seed, ends[0]};
  }

  // What a run that has ended had to say, its last lines.
  static std::string take_words(int pipe) {
    constexpr std::size_t most = 1000;
    std::string words;
    char bytes[4096];
    for (ssize_t got = 0; (got = read(pipe, bytes, sizeof bytes)) > 0;) words.append(bytes, static_cast<std::size_t>(got));
    close(pipe);
    while (words.ends_with('\n')) words.pop_back();
    return words.size() > most ? words.substr(words.size() - most) : words;
  }

  void reap() {
    int status = 0;
    pid_t child = 0;
    while ((child = waitpid(-1, &status, WNOHANG)) == 0) {
      if (interrupted() && !told_) {
        told_ = true;
        for (const auto& [pid, run] : running_) kill(pid, SIGINT);
      }
      std::this_thread::sleep_for(look_every);
    }
    if (child < 0) return running_.clear();  // there is none to wait for
    const auto found = running_.find(child);
    if (found == running_.end()) return;
    const std::uint64_t seed = found->second.seed;
    const std::string words = take_words(found->second.pipe);
    running_.erase(found);
    const bool lacks = WIFEXITED(status) && WEXITSTATUS(status) == environment;
    if (lacks && !words.empty()) {  // a full disk, no memory: the next run would find no more
      stop_all();
      throw EnvironmentError("seed " + std::to_string(seed) + ": " + words);
    }
    if (std::optional<record::RunResult> result = finished(seed)) {
      take(*result, false);
    } else if (!interrupted()) {
      take(lost(seed, status, words), false);
    }
  }

  void stop_all() {
    for (const auto& [pid, run] : running_) {
      kill(pid, SIGINT);
      waitpid(pid, nullptr, 0);
      close(run.pipe);
    }
    running_.clear();
  }

  record::RunResult lost(std::uint64_t seed, int status, const std::string& words) const {
    record::RunResult result;
    result.scenario = options_.scenario;
    result.seed = seed;
    const std::string how =
        WIFSIGNALED(status) ? "ended by signal " + std::to_string(WTERMSIG(status)) : "exit status " + std::to_string(WEXITSTATUS(status));
    result.failure = record::FailureRecord{"start", words.empty() ? how : how + ": " + words};
    return result;
  }

  void take(const record::RunResult& result, bool kept) {
    if (!options_.json) {
      const std::string verdict = result.success         ? "ok"
                                  : result.false_success ? "FALSE SUCCESS in " + result.failure->phase + ": " + result.failure->reason
                                  : result.failure       ? "failed in " + result.failure->phase + ": " + result.failure->reason
                                                         : "failed";
      char times[40] = "                   ";  // of a run that left no result
      if (std::isfinite(result.time.simulated_s))
        std::snprintf(times, sizeof times, "%6.1f s  %5.1f x  ", result.time.simulated_s, result.time.real_time_factor);
      print("seed %-6llu %s%s%s\n", static_cast<unsigned long long>(result.seed), times, verdict.c_str(), kept ? "  (kept)" : "");
    }
    results_.insert_or_assign(result.seed, result);
  }

  const Options& options_;
  record::Experiment experiment_;
  fs::path out_;
  std::string program_;
  struct Running {
    std::uint64_t seed = 0;
    int pipe = -1;
  };
  std::map<pid_t, Running> running_;
  bool told_ = false;  // the runs, that they are interrupted
  std::map<std::uint64_t, record::RunResult> results_;
};

int campaign(const Options& options) {
  if (!std::isfinite(options.into))  // CLI11's range lets it through
    throw InputError("--into takes a share from 0 to 1");
  if (!options.seeds.empty() && (options.shard != "1/1" || !options.kinds.empty()))
    throw InputError("--shard and --kinds go with --faults or --ranges; of --seeds, name those that are wanted");
  if (options.faults) return fault_campaign(options);
  if (options.ranges) return range_campaign(options);
  if (options.seeds.empty()) throw InputError("--seeds is required, or --faults, or --ranges");
  const Seeds seeds = parse_seeds(options.seeds);
  const scenario::Scenario checked = scenario::load_scenario(options.scenario, options.set);
  scenario::check_runnable(checked);
  const CampaignFolder folder(options, checked, "campaign");
  catch_interrupts();
  const CampaignTable table = tabulate(Campaign(options, checked, folder.path()).run(seeds));
  if (options.json) {
    Json json = json_of(table);
    json["scenario"] = checked.name;
    json["folder"] = folder.path().string();
    print_json(json);
  } else {
    tell(table);
  }
  if (interrupted()) return exit_interrupted;
  return table.successes == table.runs ? done : failed;
}

}  // namespace

void add_campaign(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("campaign", "Run a scenario over many seeds and tabulate what came of them");
  auto options = std::make_shared<Options>();
  command->add_option("SCENARIO", options->scenario, "A file or a shipped name")->required();
  CLI::Option* seeds = command->add_option("--seeds", options->seeds, "A-B, both included");
  CLI::Option* faults =
      command->add_flag("--faults", options->faults, "The fault matrix: every kind of fault in every step, on given sight");
  CLI::Option* ranges = command->add_flag("--ranges", options->ranges, "Every key of the scenario, drawn over its documented range");
  faults->excludes(ranges);
  seeds->excludes(faults)->excludes(ranges);
  command->add_option("--draws", options->draws, "--ranges: draws of each key by itself")->check(CLI::Range(0, 1000))->needs(ranges);
  command->add_option("--many", options->many, "--ranges: runs with eight keys at once")->check(CLI::Range(0, 100000))->needs(ranges);
  command->add_option("--kinds", options->kinds, "--faults: these kinds only; --ranges: these keys only")->delimiter(',');
  command->add_option("--steps", options->steps, "--faults: these steps only")->delimiter(';')->needs(faults);
  command->add_option("--rows", options->rows, "--faults: these rows only, by name, as 'turn: overcurrent elbow'")
      ->delimiter(';')
      ->needs(faults);
  command->add_flag("--rendered", options->rendered, "--faults: camera and vision see what is drawn, instead of being given the true pose")
      ->needs(faults);
  command->add_flag("--pairs", options->pairs, "--faults: pairs of faults within 0.5 s, in a step of each phase")->needs(faults);
  command->add_option("--one-in", options->one_in, "--faults: a sample, one row in so many")->check(CLI::Range(1, 100000))->needs(faults);
  command->add_option("--into", options->into, "--faults: how far into each step it is made, as a share of the step")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->needs(faults);
  command->add_option("--shard", options->shard, "K/N: the K-th of N parts");
  command->add_option("--jobs", options->jobs, "Runs at a time (default: the number of processors)")->check(CLI::Range(1, 1024));
  command->add_option("--set", options->set, "path.to.key=value, as for run")->allow_extra_args(false);
  command->add_option("--out", options->out,
                      "Folder of the runs, one a seed; seeds already there are kept (default runs/SCENARIO-campaign)");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return campaign(*options); }; });
}

}  // namespace lf::app
