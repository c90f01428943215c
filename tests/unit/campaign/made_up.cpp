#include "tests/unit/campaign/made_up.hpp"

#include <stdexcept>

#include "host_sim/campaign/figures.hpp"

namespace lf::campaign::test {

RunSummary run(std::uint64_t seed) {
  RunSummary run;
  run.seed = seed;
  run.success = true;
  for (std::size_t i = 0; i < figures().size(); ++i)
    run.figures.push_back(0.1 * static_cast<double>(i + 1) + 0.01 * static_cast<double>(seed * 7 % 31));
  run.wall_s = 2.5;
  run.digest = "d" + std::to_string(seed);
  run.folder = std::to_string(seed);
  run.has_report = true;
  return run;
}

RunSummary failed(std::uint64_t seed, const std::string& phase, const std::string& reason) {
  RunSummary failed = run(seed);
  failed.success = false;
  failed.failure = record::FailureRecord{phase, reason};
  failed.figures[figure("valve_final_deg")] = record::unknown;
  return failed;
}

Campaign campaign(std::size_t count) {
  Campaign campaign;
  campaign.scenario = "default";
  campaign.seeds = "1-" + std::to_string(count);
  campaign.command = "lanternfish campaign default --seeds 1-" + std::to_string(count);
  campaign.version = "0.1.0";
  campaign.revision = "abc1234";
  campaign.sittings = {{"2026-11-24T21:35:00Z", "2026-11-24T21:36:00Z", count}};
  campaign.cells.emplace_back();
  campaign.cells[0].experiment = {{"scenario", friction_scenario}, {"program", "aaaa"}, {"file arm/arm5e.urdf", "bbbb"}};
  for (std::size_t seed = 1; seed <= count; ++seed) campaign.cells[0].runs.push_back(run(seed));
  return campaign;
}

Campaign grid() {
  Campaign grid = campaign(4);
  grid.keys = {"valve.friction_nm"};
  grid.set = {"valve.friction_nm=1,2"};
  grid.cells.push_back(grid.cells[0]);
  for (std::size_t i = 0; i < 2; ++i) {
    Cell& cell = grid.cells[i];
    const std::string value = std::to_string(i + 1);
    cell.choice = {{"valve.friction_nm", value}};
    cell.experiment["scenario"] = "valve:\n  friction_nm: " + value + "\n";
    cell.folder = folder_of(cell.choice, record::hash_of(cell.experiment));
    for (RunSummary& run : cell.runs) run.folder = cell.folder + "/" + std::to_string(run.seed);
  }
  return grid;
}

std::size_t figure(const std::string& name) {
  for (std::size_t i = 0; i < figures().size(); ++i) {
    if (figures()[i].name == name) return i;
  }
  throw std::invalid_argument(name);
}

}  // namespace lf::campaign::test
