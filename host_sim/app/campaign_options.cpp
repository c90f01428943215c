#include "host_sim/app/campaign_options.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <thread>

#include "host_sim/app/run_experiment.hpp"
#include "host_sim/app/tell_arm.hpp"
#include "host_sim/record/provenance_json.hpp"
#include "host_sim/record/run_folder.hpp"
#include "shared/input_error.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace fs = std::filesystem;

Shard parse_shard(const std::string& text) {
  constexpr std::size_t most = 10000;
  Shard shard;
  const std::size_t slash = text.find('/');
  const auto number = [&](std::string_view part, std::size_t& value) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    return !part.empty() && error == std::errc() && end == part.data() + part.size();
  };
  const std::string_view all = text;
  const bool good = slash != std::string::npos && number(all.substr(0, slash), shard.index) && number(all.substr(slash + 1), shard.count);
  if (!good || shard.index < 1 || shard.index > shard.count || shard.count > most)
    throw InputError("--shard takes K/N with K from 1 to N, not '" + text + "'");
  return shard;
}

int jobs_of(const CampaignOptions& options) {
  return options.jobs > 0 ? options.jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

CampaignFolder::CampaignFolder(const CampaignOptions& options, const scenario::Scenario& scenario, const std::string& kind,
                               const std::vector<std::string>& grid) {
  tell_arm_notes(scenario);
  record::Experiment experiment = experiment_of(scenario);
  experiment["campaign"] = kind;
  set_ = options.set;
  scenario_file_ = scenario.file;
  // The values are no part of it: each cell has a folder of its own, and a grid may be extended.
  for (const std::string& key : grid) experiment["grid"] += (experiment["grid"].empty() ? "" : ", ") + key;
  path_ = options.out.empty() ? default_folder(scenario.name + "-" + kind, !options.set.empty(), experiment) : fs::path(options.out);
  record::refuse_other(path_, experiment);
  const record::RunFolder folder(path_);
  lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    if (lock_ >= 0) ::close(lock_);
    throw InputError(path_.string(), 0, "another campaign is writing there");
  }
  experiment_ = record::hash_of(experiment);
  folder.write(record::experiment_file, record::experiment_json(experiment));
}

Json CampaignFolder::provenance(const std::string& command, const std::string& begun) const {
  Json json = record::provenance_json({begun, command, set_, scenario_file_, experiment_});
  json["version"] = version();
  json["revision"] = revision();
  return json;
}

CampaignFolder::~CampaignFolder() { ::close(lock_); }

}  // namespace lf::app
