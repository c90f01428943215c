#include "host_sim/campaign/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host_sim/campaign/figures.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/campaign/made_up.hpp"

namespace lf::campaign {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using Verdict = Change::Verdict;

std::string refusal_of(const Campaign& before, const Campaign& after, const std::vector<std::string>& across = {}) {
  try {
    (void)compare(before, after, across, "before");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const Change& change_of(const Comparison& comparison, const std::string& figure, const std::string& of) {
  const auto found = std::find_if(comparison.changes.begin(), comparison.changes.end(),
                                  [&](const Change& change) { return change.figure == figure && change.of == of; });
  if (found == comparison.changes.end()) throw std::invalid_argument(figure + " " + of);
  return *found;
}

// Another digest for each run: another program flew it.
Campaign flown_again(Campaign campaign) {
  for (Cell& cell : campaign.cells) {
    cell.experiment["program"] = "cccc";
    for (RunSummary& run : cell.runs) run.digest += "'";
  }
  return campaign;
}

TEST(Comparison, TheSameRunsAreIdentical) {
  const Campaign campaign = test::campaign(4);
  const Comparison same = compare(campaign, campaign, {}, "before");
  EXPECT_TRUE(same.identical);
  EXPECT_FALSE(same.worse() || same.better());
  EXPECT_EQ(same.tests, 0u);
  EXPECT_EQ(same.doubt, "");
  EXPECT_THAT(same.notes, IsEmpty());
  EXPECT_THAT(text_of(same), HasSubstr("the runs of all common seeds are identical"));
}

// 12 pairs all moved up: the signed-rank test gives 2/2^12, the correction for two tests (median and p95) twice that.
TEST(Comparison, AFigureThatMovedInAllRunsIsWorse) {
  const Campaign before = test::campaign(12);
  Campaign after = flown_again(before);
  for (RunSummary& run : after.cells[0].runs) run.figures[test::figure("plane_normal_deg")] += 0.001 * static_cast<double>(run.seed);
  const Comparison comparison = compare(before, after, {}, "before");
  const Change& median = change_of(comparison, "plane_normal_deg", "median");
  EXPECT_EQ(median.test, "Wilcoxon");
  EXPECT_EQ(median.n, 12u);
  EXPECT_NEAR(median.p, 2.0 / 4096, 1e-12);
  EXPECT_NEAR(median.p_of_all, 2 * 2.0 / 4096, 1e-12);
  EXPECT_EQ(median.verdict, Verdict::worse);
  EXPECT_EQ(comparison.tests, 2u);
  EXPECT_TRUE(comparison.worse());
  EXPECT_EQ(change_of(comparison, "valve_base_mm", "median").verdict, Verdict::same);
  EXPECT_TRUE(compare(after, before, {}, "x").better());
  EXPECT_FALSE(compare(after, before, {}, "x").worse());
  EXPECT_THAT(comparison.notes, Contains("the program is another"));
  EXPECT_THAT(text_of(comparison), HasSubstr("worse: plane_normal_deg median, "));
  EXPECT_EQ(json_of(comparison)["worse"], true);
}

TEST(Comparison, OfRecallMoreIsBetter) {
  const Campaign before = test::campaign(12);
  Campaign after = flown_again(before);
  for (RunSummary& run : after.cells[0].runs) run.figures[test::figure("peak_recall")] += 0.001 * static_cast<double>(run.seed);
  EXPECT_TRUE(compare(before, after, {}, "x").better());
  EXPECT_TRUE(compare(after, before, {}, "x").worse());
}

// The tail alone: the pairs' typical value stays, the p95 does not.
TEST(Comparison, ATailThatGrewIsSeenByTheP95) {
  const Campaign before = test::campaign(200);
  Campaign after = flown_again(before);
  const std::size_t index = test::figure("valve_base_mm");
  for (RunSummary& run : after.cells[0].runs) {
    if (run.seed % 10 == 0) run.figures[index] += 5 + 0.01 * static_cast<double>(run.seed);
    if (run.seed % 10 == 1) run.figures[index] -= 0.001 * static_cast<double>(run.seed);
    if (run.seed % 10 == 2) run.figures[index] -= 0.001 * static_cast<double>(run.seed);
  }
  const Comparison comparison = compare(before, after, {}, "x");
  EXPECT_EQ(change_of(comparison, "valve_base_mm", "p95").verdict, Verdict::worse);
  EXPECT_EQ(change_of(comparison, "valve_base_mm", "median").verdict, Verdict::same);
}

TEST(Comparison, WhatDependsOnTheMachineIsShownAndNotJudged) {
  const Campaign before = test::campaign(12);
  Campaign after = flown_again(before);
  for (RunSummary& run : after.cells[0].runs) run.figures[test::figure("real_time_factor")] = 0.01;
  const Comparison comparison = compare(before, after, {}, "x");
  EXPECT_FALSE(comparison.worse());
  EXPECT_EQ(change_of(comparison, "real_time_factor", "median").test, "");
  EXPECT_EQ(change_of(comparison, "real_time_factor", "median").after, 0.01);
  EXPECT_EQ(comparison.tests, 0u);
}

// The same seeds: McNemar's test, 8 of 8 the wrong way. The valve's figure is missing in the failed runs and is compared over the others.
TEST(Comparison, SeedsThatFailNowAreWorse) {
  const Campaign before = test::campaign(40);
  Campaign after = flown_again(before);
  for (std::size_t i = 0; i < 8; ++i) after.cells[0].runs[i] = test::failed(i + 1, "turn", "no grip");
  const Comparison comparison = compare(before, after, {}, "x");
  const Change& success = change_of(comparison, "success", "share");
  EXPECT_EQ(success.test, "McNemar");
  EXPECT_NEAR(success.p, 2.0 / 256, 1e-12);
  EXPECT_EQ(success.verdict, Verdict::worse);
  EXPECT_EQ(success.after_counts, "32 of 40");
  EXPECT_EQ(change_of(comparison, "valve_final_deg", "median").n, 32u);
  ASSERT_EQ(comparison.turns.size(), 8u);
  EXPECT_EQ(comparison.turns[2].seed, 3u);
  EXPECT_EQ(comparison.turns[2].after, "failed in turn: no grip");
  EXPECT_THAT(text_of(comparison), HasSubstr("seed 3: was ok, is failed in turn: no grip"));
  const Comparison back = compare(after, before, {}, "x");
  EXPECT_EQ(change_of(back, "success", "share").verdict, Verdict::better);
}

// Other seeds: Fisher's test over all runs, and figures have no pairs.
TEST(Comparison, OtherSeedsAreComparedByFishersTest) {
  const Campaign before = test::campaign(30);
  Campaign after = flown_again(before);
  for (RunSummary& run : after.cells[0].runs) run.seed += 100;
  for (std::size_t i = 0; i < 15; ++i) after.cells[0].runs[i] = test::failed(101 + i, "turn", "no grip");
  const Comparison comparison = compare(before, after, {}, "x");
  EXPECT_EQ(comparison.pairs, 0u);
  EXPECT_EQ(change_of(comparison, "success", "share").test, "Fisher");
  EXPECT_EQ(change_of(comparison, "success", "share").n, 60u);
  EXPECT_TRUE(comparison.worse());
  EXPECT_THAT(comparison.notes, Contains("they have no seed in common: only the shares of success are compared"));
}

// Many figures move to and fro, so that there are many tests. Five pairs that fail now, and none the other way, have p = 2 / 2^5 = 0.0625 two-sided, which is lost
// among them; by themselves 1 / 2^5 = 0.03125. Four have 1 / 16.
TEST(Comparison, FailuresThatRoseAreWorseByThemselves) {
  for (const std::size_t failures : {4, 5}) {
    const Campaign before = test::campaign(50);
    Campaign after = flown_again(before);
    for (RunSummary& run : after.cells[0].runs) {
      for (double& value : run.figures) value += (run.seed * 2654435761u >> 7) % 2 == 0 ? 0.01 : -0.01;
    }
    for (std::size_t i = 0; i < failures; ++i) after.cells[0].runs[i] = test::failed(i + 1, "turn", "no grip");
    const Comparison comparison = compare(before, after, {}, "x");
    EXPECT_EQ(change_of(comparison, "success", "share").verdict, Verdict::same);
    const Change& rise = change_of(comparison, "failures", "share");
    EXPECT_NEAR(rise.p, 1 / std::pow(2.0, static_cast<double>(failures)), 1e-12);
    EXPECT_EQ(rise.after_counts, std::to_string(failures) + " of 50");
    EXPECT_EQ(comparison.worse(), failures == 5) << text_of(comparison);
    EXPECT_FALSE(compare(after, before, {}, "x").worse()) << "fewer failures";
  }
}

// Other seeds: 0 of 10 before and 4 of 10 now have 210/4845 = 0.0433 (10 over 4, of 20 over 4); 3 of 10 have 120/1140 = 0.105.
TEST(Comparison, FailuresOfOtherSeedsThatRoseAreWorseByThemselves) {
  for (const std::size_t failures : {3, 4}) {
    const Campaign before = test::campaign(10);
    Campaign after = flown_again(before);
    for (RunSummary& run : after.cells[0].runs) run.seed += 100;
    for (std::size_t i = 0; i < failures; ++i) after.cells[0].runs[i] = test::failed(101 + i, "turn", "no grip");
    const Comparison comparison = compare(before, after, {}, "x");
    EXPECT_NEAR(change_of(comparison, "failures", "share").p, failures == 4 ? 210.0 / 4845 : 120.0 / 1140, 1e-9);
    EXPECT_EQ(comparison.worse(), failures == 4);
  }
}

TEST(Comparison, FalseSuccessesAreWorse) {
  const Campaign before = test::campaign(40);
  Campaign after = flown_again(before);
  for (std::size_t i = 0; i < 10; ++i) {
    after.cells[0].runs[i] = test::failed(i + 1, "turn", "the valve stands elsewhere");
    after.cells[0].runs[i].false_success = true;
  }
  EXPECT_EQ(change_of(compare(before, after, {}, "x"), "false success", "share").verdict, Verdict::worse);
}

// 2 tests differ: 2/2^n x 2 is below 0.05 from n = 7 on.
TEST(Comparison, TooFewRunsAreADoubtAndNoAnswer) {
  for (const std::size_t runs : {3, 6, 7}) {
    const Campaign before = test::campaign(runs);
    Campaign after = flown_again(before);
    for (RunSummary& run : after.cells[0].runs) run.figures[test::figure("plane_normal_deg")] += 0.001 * static_cast<double>(run.seed);
    const Comparison comparison = compare(before, after, {}, "x");
    EXPECT_EQ(comparison.worse(), runs >= 7) << runs;
    EXPECT_EQ(comparison.doubt.empty(), runs >= 7) << comparison.doubt;
    if (runs >= 7) continue;
    EXPECT_THAT(comparison.doubt, HasSubstr("it takes 7 common seeds that finish; there are " + std::to_string(runs)));
  }
}

// A small change among much noise is none.
TEST(Comparison, ChanceIsNoVerdict) {
  const Campaign before = test::campaign(50);
  Campaign after = flown_again(before);
  for (Cell& cell : after.cells) {
    for (RunSummary& run : cell.runs) {
      for (double& value : run.figures) value += (run.seed * 2654435761u >> 7) % 2 == 0 ? 0.01 : -0.01;
    }
  }
  const Comparison comparison = compare(before, after, {}, "x");
  EXPECT_FALSE(comparison.worse() || comparison.better()) << text_of(comparison);
  EXPECT_EQ(comparison.doubt, "");
}

TEST(Comparison, AnotherScenarioIsRefusedUnlessItsKeyIsWhatIsCompared) {
  const Campaign before = test::campaign(12);
  Campaign after = flown_again(before);
  after.cells[0].experiment["scenario"] = "time_limit_s: 400\nvalve:\n  friction_nm: 3  # N m\n  start_deg: {min: -40, max: 40}\n";
  EXPECT_THAT(refusal_of(before, after),
              HasSubstr("not comparable: the scenario is another one: valve.friction_nm was 2, is 3. If that is what is compared, add "
                        "--across valve.friction_nm"));
  const Comparison comparison = compare(before, after, {"valve.friction_nm"}, "x");
  EXPECT_THAT(comparison.notes, Contains("valve.friction_nm was 2, is 3"));
  EXPECT_THAT(refusal_of(before, after, {"valve.friction_nm", "valve.frction"}),
              HasSubstr("--across: the scenarios have no key 'valve.frction'"));
}

// A later program has more keys: that is no other scenario.
TEST(Comparison, AKeyThatOnlyOneProgramHasIsNoted) {
  const Campaign before = test::campaign(12);
  Campaign after = flown_again(before);
  after.cells[0].experiment["scenario"] += "water:\n  glow: 0.1\n";
  after.cells[0].experiment["file arm/arm5e.urdf"] = "dddd";
  after.cells[0].experiment["file drives/new.yaml"] = "eeee";
  const Comparison comparison = compare(before, after, {}, "x");
  EXPECT_THAT(comparison.notes, Contains("only one of the two programs has the keys water.glow"));
  EXPECT_THAT(comparison.notes, Contains("arm/arm5e.urdf is another"));
  EXPECT_THAT(comparison.notes, Contains("drives/new.yaml is used now"));
}

TEST(Comparison, CellsOfGridsAreMatchedByWhatTheySet) {
  const Campaign before = test::grid();
  Campaign after = flown_again(before);
  std::swap(after.cells[0], after.cells[1]);
  const Comparison comparison = compare(before, after, {}, "x");
  EXPECT_EQ(comparison.pairs, 8u);
  EXPECT_EQ(comparison.tests, 0u);
  after.cells.pop_back();
  EXPECT_THAT(compare(before, after, {}, "x").notes, Contains("only in the earlier campaign: valve.friction_nm=1"));
  EXPECT_THAT(compare(after, before, {}, "x").notes, Contains("not in the earlier campaign: valve.friction_nm=1"));
  EXPECT_THAT(refusal_of(test::campaign(4), before),
              HasSubstr("no cell in common: no grid before; valve.friction_nm=1; valve.friction_nm=2 now"));
}

TEST(Comparison, WithoutARunThereIsNothingToCompare) {
  Campaign empty = test::campaign(3);
  empty.cells[0].runs.clear();
  EXPECT_THAT(refusal_of(empty, test::campaign(3)), HasSubstr("no run of the earlier one was flown"));
  EXPECT_THAT(refusal_of(test::campaign(3), empty), HasSubstr("no run of the later one was flown"));
}

}  // namespace
}  // namespace lf::campaign
