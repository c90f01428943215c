// What `lanternfish campaign` is asked for, and the folder that a campaign writes to.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/app/command.hpp"
#include "host_sim/app/fault_walk.hpp"
#include "host_sim/scenario/scenario.hpp"

namespace lf::app {

struct CampaignOptions {
  std::string scenario = "default";
  std::string seeds;
  std::vector<std::string> set;
  std::string out;
  int jobs = 0;
  bool json = false;
  bool faults = false;
  std::vector<std::string> kinds, steps, rows;
  bool pairs = false, rendered = false;
  std::size_t one_in = 1;
  double into = usual_share_of_step;
  bool ranges = false;
  std::size_t draws = 5, many = 300;
  std::string shard = "1/1";
  std::string compare;              // an earlier campaign's folder
  std::vector<std::string> across;  // keys that may differ from its
};

struct Shard {
  std::size_t index = 1, count = 1;
};
// "K/N". Throws InputError.
Shard parse_shard(const std::string& text);

int jobs_of(const CampaignOptions& options);

// A campaign's folder, locked while it runs, with the experiment that it is of.
class CampaignFolder {
 public:
  // Throws InputError when it holds another experiment or another campaign is writing there. `kind` names the default folder; `grid`: the keys of one.
  CampaignFolder(const CampaignOptions& options, const scenario::Scenario& scenario, const std::string& kind,
                 const std::vector<std::string>& grid = {});
  ~CampaignFolder();
  CampaignFolder(const CampaignFolder&) = delete;
  CampaignFolder& operator=(const CampaignFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // Of results that `command`, begun at `begun`, leaves in it: command, date, version and revision, files and scenario.
  Json provenance(const std::string& command, const std::string& begun) const;

 private:
  std::vector<std::string> set_;
  std::string scenario_file_, experiment_;
  std::filesystem::path path_;
  int lock_ = -1;
};

int seed_campaign(const CampaignOptions& options);
int fault_campaign(const CampaignOptions& options);
int range_campaign(const CampaignOptions& options);

}  // namespace lf::app
