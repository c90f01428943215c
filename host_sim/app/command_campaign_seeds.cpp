// `lanternfish campaign SCENARIO --seeds ...`.
#include <filesystem>
#include <optional>

#include "host_sim/app/campaign_options.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/seed_campaign.hpp"
#include "host_sim/campaign/campaign_csv.hpp"
#include "host_sim/campaign/campaign_file.hpp"
#include "host_sim/campaign/comparison.hpp"
#include "host_sim/campaign/junit.hpp"
#include "host_sim/campaign/page.hpp"
#include "host_sim/campaign/seeds.hpp"
#include "host_sim/campaign/table_text.hpp"
#include "host_sim/campaign/tally.hpp"
#include "host_sim/record/run_folder.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace fs = std::filesystem;
using campaign::Campaign;
using campaign::Comparison;

namespace {

// Before anything is flown: hours may lie between.
std::optional<Campaign> earlier_campaign(const CampaignOptions& options, const Campaign& later) {
  if (options.compare.empty()) return std::nullopt;
  Campaign earlier = campaign::read_campaign(options.compare);
  check_comparable(earlier, later, options.across);
  return earlier;
}

void refuse_itself(const CampaignOptions& options, const fs::path& folder) {
  std::error_code ignored;
  const fs::path with = fs::is_directory(options.compare, ignored) ? fs::path(options.compare) : fs::path(options.compare).parent_path();
  if (fs::equivalent(with.empty() ? "." : with, folder, ignored))
    throw InputError("--compare " + options.compare + " is the folder that this campaign writes to: give another --out");
}

// What the folder's campaign.json says of the times before.
std::vector<campaign::Sitting> sittings_before(const fs::path& folder) {
  try {
    return campaign::read_campaign(folder).sittings;
  } catch (const InputError&) {
    return {};
  }
}

void write(const Campaign& campaign, const Comparison* comparison, const fs::path& folder) {
  const record::RunFolder out(folder);
  Json json = json_of(campaign);
  if (comparison != nullptr) json["comparison"] = json_of(*comparison);
  out.write(campaign::campaign_file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  out.write("campaign.csv", cells_csv(campaign));
  out.write("runs.csv", runs_csv(campaign));
  out.write(campaign::junit_file, junit_xml(suite_of(campaign)));
  out.write(campaign::page_file, page_html(campaign, comparison));
}

void tell(const CampaignOptions& options, const Campaign& campaign, const Comparison* comparison, const fs::path& folder) {
  if (options.json) {
    Json json = json_of(campaign);
    if (comparison != nullptr) json["comparison"] = json_of(*comparison);
    json["folder"] = folder.string();
    print_json(json);
    return;
  }
  print("%s", table_text(campaign).c_str());
  if (comparison != nullptr) print("%s", text_of(*comparison).c_str());
  print("page: %s\n", (folder / campaign::page_file).c_str());
}

}  // namespace

int seed_campaign(const CampaignOptions& options) {
  const std::vector<std::uint64_t> seeds = campaign::parse_seeds(options.seeds);
  const campaign::Grid grid = campaign::grid_of(options.set);
  if (grid.cells.size() * seeds.size() > campaign::most_runs) throw InputError("the grid and its seeds are more than a million runs");
  const scenario::Scenario base = scenario::load_scenario(options.scenario, grid.fixed);
  Campaign campaign = planned(options, grid);
  campaign.scenario = base.name;
  const std::optional<Campaign> earlier = earlier_campaign(options, campaign);
  const CampaignFolder folder(options, base, "campaign", grid.keys);
  if (earlier) refuse_itself(options, folder.path());
  catch_interrupts();
  campaign.sittings = sittings_before(folder.path());
  const std::string lacks = fly(options, grid, seeds, folder.path(), campaign);
  std::optional<Comparison> comparison;
  if (earlier && lacks.empty() && !interrupted()) comparison = compare(*earlier, campaign, options.across, options.compare);
  const Comparison* compared = comparison ? &*comparison : nullptr;
  if (!lacks.empty()) {
    try {
      write(campaign, compared, folder.path());
    } catch (const std::exception&) {  // a full disk: why, is told below
    }
    throw EnvironmentError(lacks);
  }
  write(campaign, compared, folder.path());
  tell(options, campaign, compared, folder.path());
  if (interrupted()) return exit_interrupted;
  // A script that asks whether it got worse is told that, and not whether all succeeded; what cannot be told is no "no". A success that is none is worse than anything.
  if (comparison && total_of(campaign).false_successes > 0) return failed;
  if (comparison) return comparison->worse() || !comparison->doubt.empty() ? failed : done;
  return all_succeeded(campaign) ? done : failed;
}

}  // namespace lf::app
