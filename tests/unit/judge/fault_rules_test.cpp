// Whether a reason names its cause, and the node of it.
#include "host_sim/judge/fault_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/judge/stopping.hpp"

namespace lf::judge {
namespace {

TEST(FaultRules, TheAdviceOfAReasonNamesNothing) {
  EXPECT_TRUE(cause_of("torque_frozen elbow").named_in("step failed: no button there (Or something.)"));
  EXPECT_FALSE(cause_of("torque_high elbow").named_in("step failed: the jaw does not open (The overload: elbow.)"));
  EXPECT_TRUE(cause_of("torque_high slew").named_in("step failed: the button is stuck (It was touched.)"));
  EXPECT_FALSE(cause_of("torque_high jaw").named_in("step failed: the button is stuck (It was touched.)"));
  EXPECT_FALSE(cause_of("torque_frozen jaw").named_in("step failed: no button there (Or something.)"));
  EXPECT_FALSE(cause_of("torque_high jaw").named_in("step failed: touched something before the aim (Look.)"));
  EXPECT_FALSE(cause_of("torque_frozen slew").named_in("step failed: the button is stuck (It was touched.)"));
  EXPECT_FALSE(cause_of("following shoulder").named_in("step failed: touched something on the way back (Look.)"));
  EXPECT_FALSE(cause_of("following shoulder").named_in("step failed: touched something before the aim (Look.)"));
  EXPECT_FALSE(cause_of("runaway slew").named_in("unexpected contact: roll"));
  EXPECT_TRUE(cause_of("runaway slew").named_in("following error: slew, in step grip"));
  EXPECT_FALSE(cause_of("silent io").named_in("camera silent"));
}

// A bus whose joints and numbers are nobody's default, one name the beginning of another.
TEST(FaultRules, OfAnotherMachineAreAtItsOwnNodes) {
  const BusNodes bus{JointNames({"j1", "j10", "jaw"}), {5, 9, 12, 20}};
  const auto cause = [&](const std::string& name) {
    for (const Cause& one : all_causes(bus)) {
      if (one.name() == name) return one;
    }
    ADD_FAILURE() << "no cause " << name;
    return Cause{};
  };
  EXPECT_EQ(cause("overcurrent j10").fault().node, "j10");
  EXPECT_EQ(cause("drop_frames tpdo j1").fault().can_id, 0x180 + 5);
  EXPECT_EQ(cause("drop_frames heartbeat io").fault().can_id, 0x700 + 20);
  EXPECT_TRUE(cause("overcurrent j1").named_in("drive fault: j1"));
  EXPECT_FALSE(cause("overcurrent j1").named_in("drive fault: j10"));
  EXPECT_TRUE(cause("overcurrent j1").named_in("drive fault: j10, drive fault: j1"));
  EXPECT_TRUE(cause("silent io").named_in("output node lost"));
  EXPECT_TRUE(cause("wrong_identity j10").named_in("boot failed: no answer on 0x0609"));
  for (const Cause& one : all_causes(bus)) EXPECT_EQ(one.name().find("slew"), std::string::npos) << one.name();
}

TEST(FaultRules, AReasonNamesTheCauseAndItsNode) {
  const auto named = [](const char* cause, const char* reason) { return cause_of(cause).named_in(reason); };
  EXPECT_TRUE(named("overcurrent elbow", "drive fault: elbow, EMCY 0x2310 (continuous over-current)"));
  EXPECT_FALSE(named("overcurrent elbow", "drive fault: slew, EMCY 0x2310 (continuous over-current)")) << "another node";
  EXPECT_FALSE(named("overcurrent elbow", "step timed out"));
  EXPECT_FALSE(named("stuck_encoder roll", "step failed: the turn stalled")) << "a step that fails says nothing of the encoder";
  EXPECT_TRUE(named("silent io", "output node lost"));
  EXPECT_FALSE(named("silent io", "stale position: slew"));
  EXPECT_TRUE(named("reboot io", "node rebooted: io"));
  EXPECT_TRUE(named("drop_frames tpdo slew", "stale position: slew"));
  EXPECT_FALSE(named("drop_frames tpdo slew", "stale position: shoulder"));
  EXPECT_TRUE(named("foreign_rpdo io", "another master on the bus: identifier 0x0206"));
  EXPECT_FALSE(named("foreign_rpdo io", "another master on the bus: identifier 0x0201"));
  EXPECT_TRUE(named("foreign_sdo jaw", "another master on the bus: identifier 0x0605"));
  EXPECT_TRUE(named("foreign_sync", "another master on the bus: identifier 0x0080"));
  EXPECT_TRUE(named("stuck_encoder jaw", "step failed: the jaw does not open (Look at what it holds; free it by hand without power.)"));
  EXPECT_FALSE(named("stuck_encoder roll", "step failed: the jaw does not open (Look at what it holds; free it by hand without power.)"));
  EXPECT_TRUE(named("bus_off master", "CAN bus off"));
  EXPECT_TRUE(named("can_send_fails", "CAN bus off: sending fails"));
  EXPECT_FALSE(named("can_send_fails", "output node lost")) << "the node is well";
  EXPECT_TRUE(named("encoder_jump elbow", "unexpected contact: slew")) << "what the arm touches is felt by all joints";
  // No row reports it: what moves the tool there breaks a joint's speed or limit first.
  for (const char* row : {"encoder_jump elbow", "stuck_encoder elbow", "obstacle"})
    EXPECT_FALSE(named(row, "tool outside its workspace")) << row;
}

}  // namespace
}  // namespace lf::judge
