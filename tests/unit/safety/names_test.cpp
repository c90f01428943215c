// What people read of the stops and their causes.
#include "firmware/safety/faults.hpp"
#include "firmware/safety/limits.hpp"
#include "firmware/safety/power.hpp"
#include "tests/unit/all_named.hpp"

namespace lf::safety {
namespace {

TEST(Names, OfEachFaultPhaseAndReaction) {
  test::expect_all_named<Fault>(
      fault_count, [](Fault f) { return name(f); }, "unknown fault");
  test::expect_all_named<Phase>(phase_count, [](Phase p) { return name(p); });
  test::expect_all_named<Reaction>(6, [](Reaction r) { return name(r); });
  EXPECT_STREQ(name(Reaction::power_off), "power off");
}

TEST(Names, OfEachVerdictAndStateOfThePower) {
  test::expect_all_named<LimitsVerdict>(5, [](LimitsVerdict v) { return name(v); });
  test::expect_all_named<Power::State>(5, [](Power::State s) { return name(s); });
  EXPECT_STREQ(name(LimitsVerdict::not_positive), "not positive");
}

}  // namespace
}  // namespace lf::safety
