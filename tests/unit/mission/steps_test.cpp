#include "firmware/mission/steps.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace lf::mission {
namespace {

std::vector<Step> successors(Step step) {
  const StepRow& from = row(step);
  std::vector<Step> next{from.on_done, from.on_branch};
  if (from.on_retry != Step::count) next.push_back(from.on_retry);
  if (from.on_end != Step::count) next.push_back(from.on_end);
  return next;
}

TEST(Steps, EveryStepCanBeReachedFromIdle) {
  std::vector<bool> reached(step_count, false);
  std::vector<Step> open{Step::idle};
  // Where faults lead: out of contact, to the park position, or to an end where it stands.
  for (const Step step : {Step::abandon, Step::stow, Step::shut_down, Step::held, Step::stopped, Step::off}) open.push_back(step);
  while (!open.empty()) {
    const Step step = open.back();
    open.pop_back();
    if (reached[static_cast<std::size_t>(step)]) continue;
    reached[static_cast<std::size_t>(step)] = true;
    for (const Step next : successors(step)) open.push_back(next);
  }
  for (std::size_t i = 0; i < step_count; ++i) EXPECT_TRUE(reached[i]) << row(static_cast<Step>(i)).name;
}

TEST(Steps, EndsLeadNowhere) {
  for (std::size_t i = static_cast<std::size_t>(Step::done); i < step_count; ++i) {
    const auto step = static_cast<Step>(i);
    EXPECT_TRUE(is_end(step));
    for (const Step next : successors(step)) EXPECT_EQ(next, step) << row(step).name;
  }
}

TEST(Steps, EveryStepThatMovesOrWaitsHasATimeOut) {
  for (std::size_t i = 1; i < static_cast<std::size_t>(Step::done); ++i) {
    if (static_cast<Step>(i) == Step::ready) continue;  // waits for the operator
    EXPECT_GT(row(static_cast<Step>(i)).margin_s, 0) << row(static_cast<Step>(i)).name;
  }
}

TEST(Steps, AnUnknownStepIsOff) { EXPECT_EQ(row(Step::count).step, Step::off); }

}  // namespace
}  // namespace lf::mission
