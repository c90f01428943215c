// What the arm takes for a contact where nothing may be touched.
#include <gtest/gtest.h>

#include "firmware/mission/workbench.hpp"

namespace lf::mission {
namespace {

safety::Limits limits_of(double torque_nm) {
  safety::Limits limits;
  limits.max_contact_torque_nm = 25;
  for (auto& joint : limits.joints) joint.max_torque_nm = torque_nm;
  return limits;
}

// Feeds the elbow's torque for `seconds`, and rises by `nm_s` meanwhile. True once it is a contact.
bool touches(arm::GuardedMotion& guard, double& t_s, double& nm, double nm_s, double seconds) {
  for (int i = 0; i < int(seconds * 250); ++i) {
    t_s += 0.004;
    nm += 0.004 * nm_s;
    arm::JointVector torque_nm = arm::JointVector::Zero();
    torque_nm[2] = nm;
    guard.update(Time::from_s(t_s), arm::JointVector::Zero(), arm::JointVector::Zero(), torque_nm);
    if (guard.touched()) return true;
  }
  return false;
}

// The baseline follows a load that rises slowly: an arm that something pushes and that wedges itself was never in contact.
TEST(FreeMotionGuard, ALoadThatRisesSlowlyIsAContactInTheEnd) {
  arm::GuardedMotion guard(free_motion_guard(limits_of(26)));
  double t_s = 0, nm = -7;
  EXPECT_FALSE(touches(guard, t_s, nm, 0, 0.5));
  EXPECT_FALSE(touches(guard, t_s, nm, 5, 5)) << nm;
  EXPECT_NEAR(nm, 18, 0.1);
  EXPECT_TRUE(touches(guard, t_s, nm, 5, 0.2));
  EXPECT_LT(nm, 0.75 * 26);
}

TEST(FreeMotionGuard, ARiseByHalfOfTheLimitIsAContact) {
  for (const double limit_nm : {10.0, 26.0, 100.0}) {
    arm::GuardedMotion guard(free_motion_guard(limits_of(limit_nm)));
    double t_s = 0, nm = 0;
    EXPECT_FALSE(touches(guard, t_s, nm, 0, 0.5));
    const double rise_nm = std::min(25.0, 0.5 * limit_nm);
    nm = 0.95 * rise_nm;
    EXPECT_FALSE(touches(guard, t_s, nm, 0, 0.1)) << limit_nm;
    nm = 1.2 * rise_nm;
    EXPECT_TRUE(touches(guard, t_s, nm, 0, 0.1)) << limit_nm;
  }
}

}  // namespace
}  // namespace lf::mission
