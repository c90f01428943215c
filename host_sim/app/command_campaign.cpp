#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "host_sim/app/campaign_table.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/record/run_folder.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace fs = std::filesystem;

namespace {

struct Options {
  std::string scenario = "default";
  std::string seeds;
  std::vector<std::string> set;
  std::string out;
  int jobs = 0;
  bool json = false;
};

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
  Campaign(const Options& options, fs::path out) : options_(options), out_(std::move(out)), program_(fs::read_symlink("/proc/self/exe")) {}

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

  // A result that is already there, unless that run was interrupted.
  std::optional<record::RunResult> finished(std::uint64_t seed) const {
    const fs::path file = folder(seed) / "result.json";
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return std::nullopt;
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
    const std::string log = folder(seed).string() + ".log";
    const pid_t child = fork();
    if (child < 0) throw EnvironmentError("no process could be started for a run");
    if (child == 0) {
      // A terminal's Ctrl-C goes to the campaign alone, which passes it on: a second one would end a run at once, its record lost.
      setpgid(0, 0);
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      const int null = open("/dev/null", O_WRONLY);
      const int errors = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
      dup2(null, STDOUT_FILENO);
      if (errors >= 0) dup2(errors, STDERR_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    running_[child] = seed;
  }

  void reap() {
    int status = 0;
    pid_t child = 0;
    while ((child = waitpid(-1, &status, WNOHANG)) == 0) {
      if (interrupted() && !told_) {
        told_ = true;
        for (const auto& [pid, seed] : running_) kill(pid, SIGINT);
      }
      std::this_thread::sleep_for(look_every);
    }
    if (child < 0) return running_.clear();  // there is none to wait for
    const auto found = running_.find(child);
    if (found == running_.end()) return;
    const std::uint64_t seed = found->second;
    running_.erase(found);
    if (std::optional<record::RunResult> result = finished(seed)) {
      std::error_code ignored;
      fs::remove(folder(seed).string() + ".log", ignored);
      take(*result, false);
    } else if (!interrupted()) {
      take(lost(seed, status), false);
    }
  }

  record::RunResult lost(std::uint64_t seed, int status) const {
    record::RunResult result;
    result.scenario = options_.scenario;
    result.seed = seed;
    const std::string how =
        WIFSIGNALED(status) ? "ended by signal " + std::to_string(WTERMSIG(status)) : "exit status " + std::to_string(WEXITSTATUS(status));
    result.failure = record::FailureRecord{"start", how + ", see " + folder(seed).string() + ".log"};
    return result;
  }

  void take(const record::RunResult& result, bool kept) {
    if (!options_.json) {
      const std::string verdict = result.success   ? "ok"
                                  : result.failure ? "failed in " + result.failure->phase + ": " + result.failure->reason
                                                   : "failed";
      print("seed %-6llu %6.1f s  %5.1f x  %s%s\n", static_cast<unsigned long long>(result.seed), result.time.simulated_s,
            result.time.real_time_factor, verdict.c_str(), kept ? "  (kept)" : "");
    }
    results_.insert_or_assign(result.seed, result);
  }

  const Options& options_;
  fs::path out_;
  std::string program_;
  std::map<pid_t, std::uint64_t> running_;
  bool told_ = false;  // the runs, that they are interrupted
  std::map<std::uint64_t, record::RunResult> results_;
};

int campaign(const Options& options) {
  const Seeds seeds = parse_seeds(options.seeds);
  const scenario::Scenario checked = scenario::load_scenario(options.scenario, options.set);
  const record::RunFolder folder(options.out.empty() ? fs::path("runs") / (checked.name + "-campaign") : fs::path(options.out));
  catch_interrupts();
  const CampaignTable table = tabulate(Campaign(options, folder.path()).run(seeds));
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
  command->add_option("--seeds", options->seeds, "A-B, both included")->required();
  command->add_option("--jobs", options->jobs, "Runs at a time (default: the number of processors)")->check(CLI::Range(1, 1024));
  command->add_option("--set", options->set, "path.to.key=value, as for run")->allow_extra_args(false);
  command->add_option("--out", options->out,
                      "Folder of the runs, one a seed; seeds already there are kept (default runs/SCENARIO-campaign)");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return campaign(*options); }; });
}

}  // namespace lf::app
