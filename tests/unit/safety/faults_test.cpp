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

TEST(Faults, AnEmergencyStopNeverLetsGoOfAHandle) {
  for (std::size_t phase = 1; phase < phase_count - 1; ++phase) {
    EXPECT_EQ(reaction(Fault::estop, static_cast<Phase>(phase)), Reaction::quick_stop) << name(static_cast<Phase>(phase));
  }
}

TEST(Faults, ADriveThatCannotBeTrustedIsNeverAskedToRetreat) {
  for (const Fault fault : {Fault::node_lost, Fault::node_rebooted, Fault::drive_fault, Fault::stale_position}) {
    for (const Phase phase : {Phase::free, Phase::scan, Phase::contact, Phase::gripping, Phase::stow}) {
      EXPECT_GE(reaction(fault, phase), Reaction::hold) << name(fault) << " in " << name(phase);
    }
  }
}

TEST(Faults, WhileGrippingAnOverloadLetsGoAndALateAnswerDoesNothing) {
  EXPECT_EQ(reaction(Fault::overload, Phase::gripping), Reaction::retreat);
  EXPECT_EQ(reaction(Fault::vision_late, Phase::gripping), Reaction::count_only);
  EXPECT_EQ(reaction(Fault::image_lost, Phase::gripping), Reaction::count_only);
}

TEST(Faults, NothingMovesOnUnsignedLimits) {
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

TEST(Faults, AfterTheEndTheyAreOnlyCounted) {
  for (const Fault fault : all_faults()) EXPECT_EQ(reaction(fault, Phase::ended), Reaction::count_only) << name(fault);
}

TEST(Faults, AFaultThatIsNotInTheTableStops) {
  EXPECT_EQ(reaction(Fault::count, Phase::free), Reaction::quick_stop);
  EXPECT_EQ(reaction(Fault::estop, Phase::count), Reaction::quick_stop);
}

}  // namespace
}  // namespace lf::safety
