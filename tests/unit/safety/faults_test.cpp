#include "firmware/safety/faults.hpp"

#include <gtest/gtest.h>

#include <array>

namespace lf::safety {
namespace {

std::array<Fault, fault_count> all_faults() {
  std::array<Fault, fault_count> faults{};
  for (std::size_t i = 0; i < fault_count; ++i) faults[i] = static_cast<Fault>(i);
  return faults;
}

TEST(Faults, AnEmergencyStopStopsInEveryPhaseAndNeverLetsGoOfAHandle) {
  for (std::size_t phase = 1; phase < phase_count; ++phase) {
    EXPECT_EQ(reaction(Fault::estop, static_cast<Phase>(phase)), Reaction::quick_stop) << name(static_cast<Phase>(phase));
  }
}

// A drive that latched a fault has stopped: the others cannot retreat with one joint dead. And without the output node, the bus, the clock or with a
// second master nobody knows what a retreat would do.
TEST(Faults, WhatCannotBeTrustedStops) {
  for (const Fault fault : {Fault::node_lost, Fault::node_rebooted, Fault::drive_fault, Fault::following_error, Fault::stale_position,
                            Fault::io_lost, Fault::bus_off, Fault::clock_lost, Fault::second_master}) {
    for (const Phase phase : {Phase::free, Phase::scan, Phase::contact, Phase::gripping, Phase::stow, Phase::ended}) {
      EXPECT_EQ(reaction(fault, phase), Reaction::quick_stop) << name(fault) << " in " << name(phase);
    }
  }
}

TEST(Faults, WhileGrippingAnOverloadLetsGoAndALateAnswerDoesNothing) {
  EXPECT_EQ(reaction(Fault::overload, Phase::gripping), Reaction::retreat);
  EXPECT_EQ(reaction(Fault::vision_late, Phase::gripping), Reaction::count_only);
  EXPECT_EQ(reaction(Fault::image_lost, Phase::gripping), Reaction::count_only);
}

TEST(Faults, NothingMovesOnLimitsWithAWrongChecksum) {
  for (std::size_t phase = 0; phase + 1 < phase_count; ++phase) {
    EXPECT_EQ(reaction(Fault::limits_refused, static_cast<Phase>(phase)), Reaction::power_off);
  }
}

TEST(Faults, OnTheWayToTheParkNothingIsTriedAgain) {
  for (const Fault fault : all_faults()) {
    EXPECT_NE(reaction(fault, Phase::stow), Reaction::retry) << name(fault);
    EXPECT_NE(reaction(fault, Phase::stow), Reaction::retreat) << name(fault);
  }
}

TEST(Faults, AfterTheEndTheyAreCountedOrStop) {
  for (const Fault fault : all_faults()) {
    const Reaction taken = reaction(fault, Phase::ended);
    EXPECT_TRUE(taken == Reaction::count_only || taken == Reaction::quick_stop) << name(fault);
  }
}

TEST(Faults, AFaultThatIsNotInTheTableStops) {
  EXPECT_EQ(reaction(Fault::count, Phase::free), Reaction::quick_stop);
  EXPECT_EQ(reaction(Fault::estop, Phase::count), Reaction::quick_stop);
}

}  // namespace
}  // namespace lf::safety
