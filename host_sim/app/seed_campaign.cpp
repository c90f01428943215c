#include "host_sim/app/seed_campaign.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "host_sim/app/command.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/lost_run.hpp"
#include "host_sim/app/progress_line.hpp"
#include "host_sim/app/run_experiment.hpp"
#include "host_sim/app/run_processes.hpp"
#include "host_sim/app/shell_word.hpp"
#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/utc_time.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/input_error.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace fs = std::filesystem;
using campaign::Campaign;
using campaign::Cell;
using campaign::folder_of;
using campaign::label_of;

namespace {

std::string command_of(const CampaignOptions& options) {
  std::string command = "lanternfish campaign " + shell_word(options.scenario) + " --seeds " + options.seeds;
  for (const std::string& set : options.set) command += " --set " + shell_word(set);
  if (!options.compare.empty()) command += " --compare " + shell_word(options.compare);
  for (const std::string& key : options.across) command += " --across " + shell_word(key);
  return command;
}

record::Experiment cell_experiment(const CampaignOptions& options, const std::vector<std::string>& set, const std::string& label) {
  try {
    const scenario::Scenario scenario = scenario::load_scenario(options.scenario, set);
    scenario::check_runnable(scenario);
    return experiment_of(scenario);
  } catch (const InputError& error) {
    if (label.empty()) throw;
    throw InputError(std::string("the grid's cell ").append(label).append(" cannot be flown:\n").append(error.what()));
  }
}

class Flyer {
 public:
  Flyer(const CampaignOptions& options, const campaign::Grid& grid, fs::path folder, Campaign& campaign)
      : options_(options), grid_(grid), folder_(std::move(folder)), campaign_(campaign) {}

  std::string fly(const std::vector<std::uint64_t>& seeds) {
    for (const std::uint64_t seed : seeds) {
      for (std::size_t cell = 0; cell < campaign_.cells.size(); ++cell) {
        tasks_.push_back({cell, seed});
        if (std::optional<campaign::RunSummary> run = finished(cell, seed)) tasks_.back().run = std::move(run);
      }
    }
    const auto kept =
        static_cast<std::size_t>(std::count_if(tasks_.begin(), tasks_.end(), [](const Task& task) { return task.run.has_value(); }));
    std::fprintf(stderr, "%s in %s, %s at a time%s\n", count_of(tasks_.size(), "run").c_str(), folder_.c_str(),
                 std::to_string(jobs_of(options_)).c_str(),
                 kept > 0 ? (", " + std::to_string(kept) + (kept == 1 ? " is kept" : " are kept")).c_str() : "");
    ProgressLine progress(tasks_.size() - kept, "run");
    progress_ = &progress;
    const std::string begun = campaign::utc_text(std::time(nullptr));
    fly_tasks();
    if (flown_ > 0) campaign_.sittings.push_back({begun, campaign::utc_text(std::time(nullptr)), flown_});
    progress_ = nullptr;
    for (const Task& task : tasks_) {
      Cell& cell = campaign_.cells[task.cell];
      if (task.run) {
        cell.runs.push_back(*task.run);
      } else {
        cell.not_flown.push_back(task.seed);
      }
    }
    return lacks_;
  }

 private:
  struct Task {
    std::size_t cell = 0;
    std::uint64_t seed = 0;
    std::optional<campaign::RunSummary> run{};
  };

  void fly_tasks() {
    try {
      RunProcesses processes(
          static_cast<std::size_t>(jobs_of(options_)), [this](const RunProcesses::Ended& ended) { take(ended); },
          [this] { progress_->tick(); });
      for (std::size_t i = 0; i < tasks_.size() && !interrupted(); ++i) {
        if (tasks_[i].run) {
          tell(tasks_[i], true);
        } else {
          processes.start(i, arguments_of(tasks_[i]));
        }
      }
      processes.finish();
    } catch (const EnvironmentError& error) {
      lacks_ = error.what();  // the other runs are ended: they would find no more
    }
  }

  std::string name_of(const Task& task) const { return (fs::path(campaign_.cells[task.cell].folder) / std::to_string(task.seed)).string(); }

  std::vector<std::string> arguments_of(const Task& task) const {
    std::vector<std::string> words{
        "run",          options_.scenario, "--seed", std::to_string(task.seed), "--out", folder_ / name_of(task), "--render-threads", "1",
        "--no-outside", "--quiet",         "--json"};
    for (const std::string& set : grid_.set_of(campaign_.cells[task.cell].choice)) words.insert(words.end(), {"--set", set});
    return words;
  }

  // A result of this experiment that is already there, unless that run was interrupted.
  std::optional<campaign::RunSummary> finished(std::size_t cell, std::uint64_t seed) const {
    const std::string name = name_of({cell, seed});
    const fs::path run_folder = folder_ / name;
    std::error_code ignored;
    if (!fs::exists(run_folder / "result.json", ignored)) return std::nullopt;
    record::Experiment ours = campaign_.cells[cell].experiment;
    ours["seed"] = std::to_string(seed);
    if (record::read_experiment(run_folder) != ours) return std::nullopt;
    try {
      const record::RunResult result = record::read_result_file(run_folder / "result.json");
      if (result.seed != seed || (result.failure && result.failure->reason == "interrupted")) return std::nullopt;
      return campaign::run_of(result, name, fs::exists(run_folder / "report.html", ignored));
    } catch (const InputError&) {
      return std::nullopt;  // half a file of a run that died: run again
    }
  }

  void take(const RunProcesses::Ended& ended) {
    Task& task = tasks_[ended.id];
    const bool lacks = WIFEXITED(ended.status) && WEXITSTATUS(ended.status) == environment;
    if (lacks && !ended.words.empty())
      throw EnvironmentError("seed " + std::to_string(task.seed) + ": " + ended.words);  // a full disk, no memory
    task.run = finished(task.cell, task.seed);
    if (!task.run && interrupted()) return;
    if (!task.run) task.run = lost(task, ended);
    ++flown_;
    progress_->ended(!task.run->success);
    tell(task, false);
  }

  // Of a run that left no result that counts.
  campaign::RunSummary lost(const Task& task, const RunProcesses::Ended& ended) const {
    record::Experiment ours = campaign_.cells[task.cell].experiment;
    ours["seed"] = std::to_string(task.seed);
    const std::optional<record::Experiment> theirs = record::read_experiment(folder_ / name_of(task));
    record::RunResult result;
    result.seed = task.seed;
    result.failure =
        record::FailureRecord{"start", lost_reason(ended.status, ended.words, theirs ? record::difference(ours, *theirs) : "")};
    return campaign::run_of(result, "", false);
  }

  void tell(const Task& task, bool kept) {
    const campaign::RunSummary& run = *task.run;
    const std::string label = label_of(campaign_.cells[task.cell].choice);
    char times[40] = "                   ";  // of a run that left no result
    const auto [simulated_s, factor] = times_of(run);
    if (std::isfinite(simulated_s)) std::snprintf(times, sizeof times, "%6.1f s  %5.1f x  ", simulated_s, factor);
    char seed[40];
    std::snprintf(seed, sizeof seed, "seed %-6llu ", static_cast<unsigned long long>(run.seed));
    const std::string line = (label.empty() ? "" : label + "  ") + seed + times + verdict_of(run) + (kept ? "  (kept)" : "") + "\n";
    progress_->clear();
    if (options_.json) {
      std::fputs(line.c_str(), stderr);
    } else {
      print("%s", line.c_str());
    }
    progress_->tick();
  }

  static std::pair<double, double> times_of(const campaign::RunSummary& run) {
    std::pair<double, double> times{record::unknown, record::unknown};
    for (std::size_t i = 0; i < campaign::figures().size(); ++i) {
      const std::string name = campaign::figures()[i].name;
      if (name == "simulated_s") times.first = run.figures[i];
      if (name == "real_time_factor") times.second = run.figures[i];
    }
    return times;
  }

  const CampaignOptions& options_;
  const campaign::Grid& grid_;
  fs::path folder_;
  Campaign& campaign_;
  std::vector<Task> tasks_;
  ProgressLine* progress_ = nullptr;
  std::size_t flown_ = 0;
  std::string lacks_;
};

}  // namespace

Campaign planned(const CampaignOptions& options, const campaign::Grid& grid) {
  Campaign campaign;
  campaign.seeds = options.seeds;
  campaign.set = options.set;
  campaign.keys = grid.keys;
  campaign.command = command_of(options);
  campaign.version = version();
  campaign.revision = revision();
  for (const campaign::Choice& choice : grid.cells) {
    Cell cell;
    cell.choice = choice;
    cell.experiment = cell_experiment(options, grid.set_of(choice), label_of(choice));
    for (const Cell& other : campaign.cells) {
      if (other.experiment == cell.experiment)
        throw InputError("the grid's cells " + label_of(other.choice) + " and " + label_of(choice) + " are the same scenario");
    }
    if (!choice.empty()) cell.folder = folder_of(choice, record::hash_of(cell.experiment));
    campaign.cells.push_back(std::move(cell));
  }
  return campaign;
}

std::string fly(const CampaignOptions& options, const campaign::Grid& grid, const std::vector<std::uint64_t>& seeds, const fs::path& folder,
                Campaign& campaign) {
  return Flyer(options, grid, folder, campaign).fly(seeds);
}

}  // namespace lf::app
