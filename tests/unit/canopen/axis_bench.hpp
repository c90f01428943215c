// A booted bus of scripted nodes, of which two axes are looked at: the slew, and the elbow that homes to a hard stop.
#pragma once

#include <gtest/gtest.h>

#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::canopen::test {

class AxisTest : public ::testing::Test {
 protected:
  static NetworkConfig config() {
    NetworkConfig c = test::plain_config();
    c.sdo_timeout = Duration::from_ms(20);
    c.transition_timeout = Duration::from_ms(400);
    c.drives[1].quick_stop_option = 2;  // shoulder: stop, then no power
    c.drives[2].homing_method = -3;     // elbow: to a hard stop
    c.drives[2].homing_speed_counts_s = 400;
    c.drives[2].homing_accel_counts_s2 = 5000;
    c.drives[2].home_offset_counts = -77;
    c.drives[2].homing_timeout = Duration::from_ms(1500);
    return c;
  }
  void SetUp() override { ASSERT_TRUE(bus.boot()); }

  Axis& axis() { return bus.network.axis(arm5e_joint::slew); }
  ScriptedNode& drive() { return bus.nodes[0]; }
  Axis& elbow() { return bus.network.axis(arm5e_joint::elbow); }
  ScriptedNode& elbow_drive() { return bus.nodes[2]; }
  bool enable(Axis& a) {
    a.request(AxisRequest::hold_enabled);
    return bus.run_until([&a] { return a.enabled(); }, Duration::from_ms(500));
  }
  CanFrame last_rpdo(std::uint8_t node = 1) {
    for (const CanFrame& f : bus.sent) {
      if (f.id == 0x200u + node) return f;
    }
    ADD_FAILURE() << "no RPDO";
    return {};
  }

  Bus bus{config()};
};

}  // namespace lf::canopen::test
