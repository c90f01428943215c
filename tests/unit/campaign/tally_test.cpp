#include "host_sim/campaign/tally.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/table_text.hpp"
#include "tests/unit/campaign/made_up.hpp"

namespace lf::campaign {
namespace {

Cell counted() {
  Cell cell;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RunSummary run = test::run(seed);
    for (double& value : run.figures) value = static_cast<double>(seed);
    cell.runs.push_back(run);
  }
  return cell;
}

const Spread& spread_of(const Tally& tally, const std::string& name) {
  for (const Spread& spread : tally.spreads) {
    if (figures()[spread.figure].name == name) return spread;
  }
  throw std::invalid_argument(name);
}

TEST(Tally, OfErrorsTheLargestIsTheWorstAndOfRecallTheSmallest) {
  const Tally tally = tally_of(counted());
  const Spread &error = spread_of(tally, "plane_normal_deg"), &recall = spread_of(tally, "peak_recall");
  EXPECT_EQ(error.median, 10);
  EXPECT_EQ(error.p95, 19);
  EXPECT_EQ(error.worst, 20);
  EXPECT_EQ(error.worst_runs, (std::vector<std::size_t>{19, 18, 17}));
  EXPECT_EQ(recall.median, 11);
  EXPECT_EQ(recall.p95, 2);
  EXPECT_EQ(recall.worst, 1);
  EXPECT_EQ(recall.worst_runs, (std::vector<std::size_t>{0, 1, 2}));
}

TEST(Tally, RunsWithoutAFigureAreNotCountedInIt) {
  Cell cell = counted();
  cell.runs[19] = test::failed(20, "turn", "no grip");
  const Tally tally = tally_of(cell);
  EXPECT_EQ(spread_of(tally, "valve_final_deg").runs, 19u);
  EXPECT_EQ(spread_of(tally, "valve_final_deg").worst, 19);
  EXPECT_EQ(tally.successes, 19u);
  EXPECT_LT(tally.success.high, 1);
  for (RunSummary& run : cell.runs) run.figures.assign(figures().size(), record::unknown);
  EXPECT_TRUE(tally_of(cell).spreads.empty());
}

TEST(Tally, ACampaignWithRunsThatAreMissingHasNotSucceeded) {
  Campaign campaign = test::campaign(3);
  EXPECT_TRUE(all_succeeded(campaign));
  campaign.cells[0].not_flown = {4};
  EXPECT_FALSE(all_succeeded(campaign));
  EXPECT_NE(table_text(campaign).find("3 of 3 succeeded (95 %: 43.9 to 100.0 %), 0 false successes (0.0 to 56.1 %), 1 not flown"),
            std::string::npos)
      << table_text(campaign);
}

TEST(Tally, TheTextHasARowACellAndTheCausesWithTheirSeeds) {
  Campaign grid = test::grid();
  grid.cells[1].runs[2] = test::failed(3, "turn", "no grip");
  const std::string text = table_text(grid);
  EXPECT_NE(text.find("valve.friction_nm=1: 4 of 4 succeeded"), std::string::npos) << text;
  EXPECT_NE(text.find("valve.friction_nm=2: 3 of 4 succeeded"), std::string::npos) << text;
  EXPECT_NE(text.find("all: 7 of 8 succeeded"), std::string::npos) << text;
  EXPECT_NE(text.find("failed, 1 in turn: no grip\n    valve.friction_nm=2, seed 3\n"), std::string::npos) << text;
}

// Each row of the table of figures reads its own member of a run's result.
TEST(Tally, FiguresAreThoseOfTheRun) {
  record::RunResult result;
  result.errors = {0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.6, 0.5, 0.85, 0.9};
  record::TaskRecord done, not_done;
  done.task = not_done.task = "turn_valve";
  done.target_deg = 90;
  done.reached_deg = 88.5;
  done.done = true;
  not_done.target_deg = 0;
  not_done.reached_deg = 50;
  result.tasks = {done, not_done};
  result.errors.peaks_false = 0.95;
  result.contact.peak_force_n = 12;
  result.time = {33, 4, 8};
  result.core.tick_us.p999 = 55;
  const std::vector<double> values = figures_of(result);
  EXPECT_EQ(values, (std::vector<double>{0.1, 0.2, 0.25, 0.3, 0.4, 1.5, 0.5, 0.6, 0.7, 0.8, 1.2, 0.85, 0.9, 0.95, 12, 33, 8, 55}));
  EXPECT_TRUE(std::isnan(figures_of(record::RunResult{})[0]));
}

}  // namespace
}  // namespace lf::campaign
