#include "host_sim/app/matrix_rows.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "shared/input_error.hpp"

namespace lf::app {
namespace {

using mission::Step;

const std::vector<FaultMoment> moments{{"mission", Step::idle, "power-on", 0, 0},    {"mission", Step::boot, "boot", 0.1, 0.1},
                                       {"mission", Step::deploy, "deploy", 5, 1},    {"mission", Step::scan, "scan", 9, 2},
                                       {"mission", Step::advance, "advance", 20, 1}, {"mission", Step::turn, "turn", 30, 2},
                                       {"mission", Step::press, "press", 40, 1},     {"mission", Step::stow, "stow", 50, 1}};

std::set<std::string> names(const MatrixChoice& choice) {
  std::set<std::string> all;
  for (const MatrixRow& row : matrix_rows(moments, choice)) all.insert(row.name());
  return all;
}

TEST(MatrixRows, EveryCauseHasARowInEveryStepAndPowerOnAlonesAreThereOnly) {
  const auto causes = judge::all_causes();
  const auto of_power_on =
      std::count_if(causes.begin(), causes.end(), [](const auto& cause) { return cause.rule->kind == "limits_refused"; });
  EXPECT_GT(of_power_on, 0);
  EXPECT_EQ(names({}).size(), moments.size() * causes.size() - (moments.size() - 1) * std::size_t(of_power_on));
}

TEST(MatrixRows, ShardsPartThem) {
  std::set<std::string> united;
  std::size_t sum = 0;
  for (std::size_t shard = 1; shard <= 3; ++shard) {
    MatrixChoice choice;
    choice.shard = shard;
    choice.shards = 3;
    const std::set<std::string> part = names(choice);
    sum += part.size();
    united.insert(part.begin(), part.end());
  }
  EXPECT_EQ(united, names({}));
  EXPECT_EQ(sum, united.size());
}

// One sample at two shares of the steps would fly the same rows twice.
TEST(MatrixRows, EachShareOfTheStepsHasASampleOfItsOwn) {
  const auto sample = [](double into) {
    MatrixChoice choice;
    choice.one_in = 4;
    choice.into = into;
    return names(choice);
  };
  const std::set<std::string> early = sample(0.05), usual = sample(usual_share_of_step), late = sample(0.9);
  EXPECT_EQ(early, sample(0.05));
  const double quarter = double(names({}).size()) / 4;
  for (const auto* of : {&early, &usual, &late}) EXPECT_NEAR(double(of->size()), quarter, 0.2 * quarter);
  const auto common = [](const std::set<std::string>& a, const std::set<std::string>& b) {
    return std::count_if(a.begin(), a.end(), [&](const std::string& name) { return b.contains(name); });
  };
  for (const auto count : {common(early, late), common(early, usual), common(usual, late)})
    EXPECT_NEAR(double(count), quarter / 4, 0.5 * quarter / 4);
}

TEST(MatrixRows, APairIsWithinHalfASecondAndInAStepOfAPhase) {
  MatrixChoice choice;
  choice.pairs = true;
  choice.one_in = 10;
  const std::vector<MatrixRow> rows = matrix_rows(moments, choice);
  EXPECT_GT(rows.size(), 100u);
  for (const MatrixRow& row : rows) {
    ASSERT_EQ(row.causes.size(), 2u) << row.name();
    EXPECT_GE(row.apart_s, 0) << row.name();
    EXPECT_LT(row.apart_s, 0.5) << row.name();
    EXPECT_NE(row.moment.step, Step::idle) << row.name();
  }
}

TEST(MatrixRows, WhatIsMisspeltIsRefusedWithWhatIsLikeIt) {
  const auto refusal = [](const MatrixChoice& choice) -> std::string {
    try {
      (void)matrix_rows(moments, choice);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  MatrixChoice kind, step, row;
  kind.kinds = {"estpo"};
  step.steps = {"trun"};
  row.rows = {"turn: estpo"};
  EXPECT_THAT(refusal(kind), testing::HasSubstr("--kinds: there is no 'estpo'; did you mean 'estop'?"));
  EXPECT_THAT(refusal(step), testing::HasSubstr("--steps: there is no 'trun'; did you mean 'turn'?"));
  EXPECT_THAT(refusal(row), testing::HasSubstr("--rows: there is no 'turn: estpo'; did you mean 'turn: estop'?"));
}

}  // namespace
}  // namespace lf::app
