// The watch over the joints' places, on a booted bus of scripted nodes: the places themselves are the test's.
#include "firmware/safety/watch.hpp"

#include <gtest/gtest.h>

#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::safety {
namespace {

class WatchTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bus.boot()); }

  static Limits limits() {
    Limits limits;
    for (JointLimit& joint : limits.joints) joint = {-1, 1, 100, 100};
    limits.workspace_min_m = {-9, -9, -9};
    limits.workspace_max_m = {9, 9, 9};
    return limits;
  }

  // Joint-limit faults that begin while the slew stands at `rad` for some cycles.
  int faults_at(double rad) {
    int began = 0;
    for (int i = 0; i < 10; ++i) {
      bus.step();
      watch.observe(bus.network, {rad, 0, 0, 0, 0}, bus.now);
      EXPECT_TRUE(watch.joints().valid);
      FaultReports reports;
      watch.check(bus.network, Vec3::Zero(), true, bus.now, reports);
      for (const FaultReport& report : reports) began += report.fault == Fault::joint_limit && report.code == 0;
    }
    return began;
  }

  canopen::test::Bus bus{canopen::test::plain_config()};
  Watch watch{limits()};
};

TEST_F(WatchTest, NamesAJointBeyondItsLimitOnce) {
  EXPECT_EQ(faults_at(1.009), 0) << "noise";
  EXPECT_FALSE(watch.outside(0));
  EXPECT_EQ(faults_at(1.02), 1);
  EXPECT_TRUE(watch.any_outside());
  EXPECT_EQ(faults_at(1.2), 0) << "the same, still";
  EXPECT_EQ(faults_at(0.5), 0);
  EXPECT_EQ(faults_at(-1.02), 1);
}

TEST_F(WatchTest, BearsAJointThatComesBackAndNoneThatGoesOn) {
  bus.step();
  watch.observe(bus.network, {1.2, 0, 0, 0, 0}, bus.now);
  watch.bear_outside(true);
  EXPECT_EQ(faults_at(1.2), 0);
  EXPECT_EQ(faults_at(1.207), 0) << "noise";
  EXPECT_EQ(faults_at(1.1), 0);
  EXPECT_TRUE(watch.outside(0)) << "borne, but not forgotten";
  EXPECT_EQ(faults_at(1.12), 1) << "it has been at 1.1";
  EXPECT_EQ(faults_at(0.9), 0);
  EXPECT_EQ(faults_at(1.02), 1) << "it has been inside";
}

TEST_F(WatchTest, BearsNothingOnceTheLimitsAreTheLimitsAgain) {
  bus.step();
  watch.observe(bus.network, {-1.05, 0, 0, 0, 0}, bus.now);
  watch.bear_outside(true);
  EXPECT_EQ(faults_at(-1.05), 0);
  watch.bear_outside(false);
  EXPECT_EQ(faults_at(-1.05), 1);
}

}  // namespace
}  // namespace lf::safety
