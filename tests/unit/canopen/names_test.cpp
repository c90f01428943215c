// What people read of the bus: in logs, in the status, in reports.
#include "firmware/canopen/boot_report.hpp"
#include "firmware/canopen/network.hpp"
#include "tests/unit/all_named.hpp"

namespace lf::canopen {
namespace {

TEST(Names, OfEachState) {
  test::expect_all_named<AxisState>(9, [](AxisState s) { return name(s); });
  test::expect_all_named<DriveState>(8, [](DriveState s) { return name(s); });
  EXPECT_STREQ(name(AxisState::resetting), "resetting");
}

TEST(Names, OfEachCause) {
  test::expect_all_named<AxisFault>(11, [](AxisFault f) { return name(f); });
  test::expect_all_named<Refusal>(refusal_count, [](Refusal r) { return name(r); });
  test::expect_all_named<ConfigError>(11, [](ConfigError e) { return name(e); });
  EXPECT_STREQ(name(AxisFault::node_lost), "node lost");
  EXPECT_STREQ(name(Refusal::heartbeat_state), "heartbeat with an unknown state");
  EXPECT_STREQ(name(ConfigError::timeout), "a time-out is not positive");
}

TEST(Names, OfWhatStoppedTheBootAndOfWhatTakesAnObjectsPlace) {
  test::expect_all_named<BootFailure>(16, [](BootFailure f) { return name(f); });
  test::expect_all_named<Substitute>(10, [](Substitute s) { return name(s); });
  EXPECT_STREQ(name(BootFailure::no_rating), "rated torque 6076 is 0");
  EXPECT_STREQ(name(Substitute::node_guarding), "node guarding");
}

}  // namespace
}  // namespace lf::canopen
