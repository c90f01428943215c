// The speed and the following window of each pose, with drives that have one number for all poses.
#include "firmware/mission/axis_limits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "shared/arm/arm_description.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::mission {
namespace {

using canopen::Axis;
using canopen::AxisFault;
using canopen::test::Bus;

constexpr double dt_s = 0.004;

// The law of cosines, from the arm's description.
class Screw {
 public:
  explicit Screw(const ArmActuator& actuator) : a_(actuator) {}
  double counts(double q_rad) const { return a_.counts_per_m * (length_m(q_rad) - length_m(0)); }
  double rad(double counts) const {
    const double length = length_m(0) + counts / a_.counts_per_m;
    const double squares = a_.pivot_a_m * a_.pivot_a_m + a_.pivot_b_m * a_.pivot_b_m;
    return std::acos((squares - length * length) / (2 * a_.pivot_a_m * a_.pivot_b_m)) - a_.offset_rad;
  }
  // d length / d angle is the pull's lever.
  double rad_per_count(double q_rad) const {
    return length_m(q_rad) / (a_.counts_per_m * a_.pivot_a_m * a_.pivot_b_m * std::sin(q_rad + a_.offset_rad));
  }

 private:
  double length_m(double q_rad) const {
    return std::sqrt(a_.pivot_a_m * a_.pivot_a_m + a_.pivot_b_m * a_.pivot_b_m -
                     2 * a_.pivot_a_m * a_.pivot_b_m * std::cos(q_rad + a_.offset_rad));
  }
  ArmActuator a_;
};

struct End {
  std::size_t joint;
  bool upper;
};

class StrokesEnd : public testing::TestWithParam<End> {
 protected:
  StrokesEnd() {
    drive().actual_counts = static_cast<std::int32_t>(std::lround(screw.counts(end_rad)));
    EXPECT_TRUE(bus.boot());
  }

  canopen::NetworkConfig config() const {
    canopen::NetworkConfig told = canopen::test::plain_config();
    canopen::DriveSetup& drive = told.drives[index()];
    double finest_rad = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= 1000; ++i)
      finest_rad = std::min(finest_rad, screw.rad_per_count(std::lerp(joint.lower_rad, joint.upper_rad, i / 1000.0)));
    drive.max_speed_counts_s = static_cast<std::uint32_t>(joint.velocity_rad_s / finest_rad);
    drive.following_window_counts = static_cast<std::uint32_t>(following_window_rad / finest_rad);
    return told;
  }

  std::size_t index() const { return static_cast<std::size_t>(GetParam().joint); }
  Axis& axis() { return bus.network.axis(GetParam().joint); }
  canopen::test::ScriptedNode& drive() { return bus.nodes[index()]; }
  void step() {
    limit_axes(test::arm5e, bus.network);
    bus.step();
  }
  bool enable() {
    axis().request(canopen::AxisRequest::hold_enabled);
    for (int i = 0; i < 100 && !axis().enabled(); ++i) step();
    return axis().enabled();
  }
  bool ask(double q_rad) { return axis().set_target_counts(static_cast<std::int32_t>(std::lround(screw.counts(q_rad)))); }
  double lag_rad() { return std::abs(screw.rad(axis().target_counts()) - screw.rad(axis().actual_counts())); }

  // What the target goes by in each SYNC period and altogether, in angles: one count may be saved, and within a period a count's angle grows by less than a
  // hundredth.
  void expect_speed_kept_on_the_way_to(double goal_rad) {
    ASSERT_TRUE(ask(goal_rad));
    double last_rad = screw.rad(axis().target_counts()), gone_rad = 0;
    int periods = 0;
    for (; periods < 2000 && std::abs(last_rad - goal_rad) > 2 * screw.rad_per_count(goal_rad); ++periods) {
      step();
      const double rad = screw.rad(axis().target_counts()), count_rad = screw.rad_per_count(rad);
      ASSERT_LE(std::abs(rad - last_rad), 1.01 * joint.velocity_rad_s * dt_s + count_rad) << "at " << rad << " rad";
      gone_rad += std::abs(rad - last_rad);
      ASSERT_LE(gone_rad, 1.01 * joint.velocity_rad_s * dt_s * (periods + 1) + count_rad) << "at " << rad << " rad";
      last_rad = rad;
    }
    // Nor much slower: counts are rounded down, and a lag of one period changes the screw's lever a little.
    EXPECT_GT(gone_rad, 0.95 * joint.velocity_rad_s * dt_s * periods);
  }

  const ArmDescription arm = load_arm_urdf(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  const ArmJoint& joint = arm.joints[static_cast<std::size_t>(GetParam().joint)];
  const Screw screw{joint.actuator};
  const double end_rad = GetParam().upper ? joint.upper_rad : joint.lower_rad;
  const double inward = GetParam().upper ? -1 : 1;
  Bus bus{config()};
};

TEST_P(StrokesEnd, TheTargetGoesNoFasterThanTheJointMay) {
  ASSERT_TRUE(enable());
  ASSERT_NO_FATAL_FAILURE(expect_speed_kept_on_the_way_to(end_rad + inward * 0.3));
  ASSERT_NO_FATAL_FAILURE(expect_speed_kept_on_the_way_to(end_rad));
}

TEST_P(StrokesEnd, AJointThatStaysBehindByTheWindowIsAFault) {
  ASSERT_TRUE(enable());
  drive().jammed = true;
  ASSERT_TRUE(ask(end_rad + inward * 0.1));
  for (int i = 0; i < 500; ++i) step();
  EXPECT_NEAR(lag_rad(), 0.1, 0.001);
  EXPECT_EQ(axis().fault(), AxisFault::none);
  ASSERT_TRUE(ask(end_rad + inward * following_window_rad));
  for (int i = 0; i < 500 && axis().fault() == AxisFault::none; ++i) step();
  EXPECT_EQ(axis().fault(), AxisFault::following_error);
}

// On the way out the counts get fewer: the window is that of the target's pose.
TEST_P(StrokesEnd, SoIsOneThatDoesNotComeToIt) {
  drive().actual_counts = static_cast<std::int32_t>(std::lround(screw.counts(end_rad + inward * following_window_rad)));
  step();
  step();
  ASSERT_TRUE(enable());
  drive().jammed = true;
  ASSERT_TRUE(ask(end_rad));
  for (int i = 0; i < 500 && axis().fault() == AxisFault::none; ++i) step();
  EXPECT_EQ(axis().fault(), AxisFault::following_error) << "it is " << lag_rad() << " rad behind";
}

std::string name_of(const testing::TestParamInfo<End>& test) {
  constexpr std::array names{"Slew", "Shoulder", "Elbow"};
  return std::string(names[static_cast<std::size_t>(test.param.joint)]) + (test.param.upper ? "Upper" : "Lower");
}

INSTANTIATE_TEST_SUITE_P(OfEachScrew, StrokesEnd,
                         testing::Values(End{arm5e_joint::slew, false}, End{arm5e_joint::slew, true}, End{arm5e_joint::shoulder, false},
                                         End{arm5e_joint::shoulder, true}, End{arm5e_joint::elbow, false}, End{arm5e_joint::elbow, true}),
                         name_of);

}  // namespace
}  // namespace lf::mission
