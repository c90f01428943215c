// Of several faults in one tick the most severe reaction is taken, once, in whatever order they are reported: over all pairs of kinds, in all phases and
// circumstances.
#include "firmware/safety/fault_arbiter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace lf::safety {
namespace {

std::vector<Circumstances> all_circumstances() {
  std::vector<Circumstances> all;
  for (std::size_t phase = 0; phase < phase_count; ++phase) {
    for (int bits = 0; bits < 8; ++bits) {
      Circumstances circumstances;
      circumstances.phase = static_cast<Phase>(phase);
      circumstances.may_retry = (bits & 1) != 0;
      circumstances.powered = (bits & 2) != 0;
      circumstances.on_hold = (bits & 4) != 0;
      all.push_back(circumstances);
    }
  }
  return all;
}

std::string words(const Circumstances& c) {
  return std::string(name(c.phase)) + (c.may_retry ? ", tries left" : "") + (c.powered ? ", powered" : "") + (c.on_hold ? ", on hold" : "");
}

TEST(FaultArbiter, TakesTheMoreSevereOfAnyTwo) {
  int pairs = 0;
  for (const Circumstances& c : all_circumstances()) {
    for (std::size_t i = 0; i < fault_count; ++i) {
      for (std::size_t j = 0; j < fault_count; ++j) {
        const FaultReport a{static_cast<Fault>(i), 1}, b{static_cast<Fault>(j), 2};
        const Reaction ra = reaction_in(a, c), rb = reaction_in(b, c);
        FaultArbiter arbiter;
        arbiter.report(a);
        arbiter.report(b);
        const FaultArbiter::Verdict verdict = arbiter.decide(c);
        ASSERT_EQ(verdict.reaction, std::max(ra, rb)) << name(a.fault) << " and " << name(b.fault) << " in " << words(c);
        ASSERT_EQ(verdict.cause.code, rb > ra ? 2 : 1) << "the first of those that call for it";
        ++pairs;
      }
    }
  }
  EXPECT_EQ(pairs, static_cast<int>(fault_count * fault_count * phase_count * 8));
}

TEST(FaultArbiter, TakesThePowerAtOnceWhereAnotherMasterCommandsADrive) {
  for (const Circumstances& c : all_circumstances()) {
    for (const std::int32_t set_points : {0x200, 0x27F, 0x301, 0x403, 0x57F}) {
      EXPECT_EQ(reaction_in({Fault::second_master, set_points}, c), Reaction::power_off) << std::hex << set_points << " in " << words(c);
    }
    for (const std::int32_t other : {0x000, 0x080, 0x1FF, 0x281, 0x580, 0x603, 0x77F}) {
      EXPECT_EQ(reaction_in({Fault::second_master, other}, c), reaction(Fault::second_master, c.phase))
          << std::hex << other << " in " << words(c);
    }
  }
}

TEST(FaultArbiter, DoesNotMindTheOrderOfAnyNumber) {
  constexpr unsigned seed = 20261122;
  std::mt19937 random(seed);
  const std::vector<Circumstances> circumstances = all_circumstances();
  for (int round = 0; round < 20'000; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", round " + std::to_string(round));
    const Circumstances& c = circumstances[random() % circumstances.size()];
    std::vector<FaultReport> reports(1 + random() % 12);
    for (FaultReport& report : reports) {
      report.fault = static_cast<Fault>(random() % fault_count);
      report.out_of_tries = random() % 4 == 0;
      report.only_counted = random() % 8 == 0;
    }
    Reaction worst = Reaction::count_only;
    for (const FaultReport& report : reports) worst = std::max(worst, reaction_in(report, c));
    for (int shuffle = 0; shuffle < 3; ++shuffle) {
      std::shuffle(reports.begin(), reports.end(), random);
      FaultArbiter arbiter;
      for (const FaultReport& report : reports) ASSERT_TRUE(arbiter.report(report));
      ASSERT_EQ(arbiter.decide(c).reaction, worst);
    }
  }
}

TEST(FaultArbiter, WithoutReportsDoesNothing) {
  const FaultArbiter::Verdict verdict = FaultArbiter().decide({});
  EXPECT_EQ(verdict.reaction, Reaction::count_only);
  EXPECT_EQ(verdict.cause.fault, Fault::count);
}

TEST(FaultArbiter, CountsWhatFindsNoRoom) {
  FaultArbiter arbiter;
  for (std::size_t i = 0; i < FaultReports::capacity(); ++i) ASSERT_TRUE(arbiter.report(Fault::image_lost));
  EXPECT_FALSE(arbiter.report(Fault::image_lost));
  EXPECT_EQ(arbiter.overflows(), 1u);
}

// What a reaction can be, whatever the circumstances: never milder than the table without a reason.
TEST(Reactions, BecomeMilderOnlyWhereTheMissionAlreadyKnows) {
  for (const Circumstances& c : all_circumstances()) {
    for (std::size_t i = 0; i < fault_count; ++i) {
      FaultReport report{static_cast<Fault>(i)};
      const Reaction table = reaction(report.fault, c.phase);
      const Reaction taken = reaction_in(report, c);
      EXPECT_GE(taken, table) << name(report.fault) << " in " << words(c);
      report.only_counted = true;
      EXPECT_EQ(reaction_in(report, c), Reaction::count_only);
    }
  }
}

// Nobody knows which way is free. What is more severe than a hold stays so.
TEST(Reactions, AfterATouchNeitherTryAgainNorGoBack) {
  for (const Circumstances& c : all_circumstances()) {
    FaultReport touched{Fault::step_failed, 1};
    const Reaction without = reaction_in(touched, c);
    touched.touched = true;
    const bool sets_out = without == Reaction::retry || without == Reaction::retreat;
    EXPECT_EQ(reaction_in(touched, c), sets_out ? Reaction::hold : without) << words(c);
  }
}

TEST(Reactions, NeverSetOutWithoutThePowerToDoSo) {
  for (const Circumstances& c : all_circumstances()) {
    if (c.powered) continue;
    for (std::size_t i = 0; i < fault_count; ++i) {
      EXPECT_NE(reaction_in({static_cast<Fault>(i)}, c), Reaction::retreat) << name(static_cast<Fault>(i)) << " in " << words(c);
    }
  }
}

// Once on its way home, held or stopped, the mission is never sent back to work: what comes then can only stop it.
TEST(Reactions, OnTheWayHomeAndAfterTheEndLeadOnlyToAStop) {
  for (const Circumstances& c : all_circumstances()) {
    if (c.phase != Phase::stow && c.phase != Phase::ended) continue;
    for (std::size_t i = 0; i < fault_count; ++i) {
      const Reaction taken = reaction_in({static_cast<Fault>(i)}, c);
      EXPECT_NE(taken, Reaction::retry) << name(static_cast<Fault>(i)) << " in " << words(c);
      EXPECT_NE(taken, Reaction::retreat) << name(static_cast<Fault>(i)) << " in " << words(c);
    }
  }
}

}  // namespace
}  // namespace lf::safety
