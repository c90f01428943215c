#include "firmware/scan/sweep.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "firmware/arm/kinematics.hpp"
#include "firmware/arm/trajectory.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::scan {
namespace {

arm::JointVector joints(const PerArmJoint<double>& q) { return arm::planar_joints(q[0], q[1], q[2], q[3]); }

arm::JointVector along(const SweepPlan& plan, double f) {
  return joints(plan.start_rad) + f * (joints(plan.end_rad) - joints(plan.start_rad));
}

// Positive where the stripe has passed the point.
double passed_m(const SweepPlan& plan, double f, const Vec3& point, const LaserCalibration& laser) {
  const Pose pose = test::arm5e.base_from_laser(along(plan, f), laser);
  return pose.linear().col(0).dot(point - pose.translation());
}

SweepRequest whole_panel() {
  SweepRequest request;
  request.base_from_panel = PanelLayout{}.nominal_base_from_panel();
  (void)request.handles.push_back({});
  return request;
}

SweepRequest handle_band(const Pose& base_from_panel) {
  SweepRequest request;
  request.base_from_panel = base_from_panel;
  request.top_m = 0.055;
  request.bottom_m = -0.055;
  request.margin_m = 0.010;
  request.docking_shift_m = 0.003;
  request.docking_turn_rad = 0.0035;
  (void)request.handles.push_back({});
  return request;
}

// The point is before the stripe at the start and behind it at the end, and in the fan when the stripe passes.
void expect_scanned(const SweepPlan& plan, const Vec3& point, const LaserCalibration& laser) {
  ASSERT_LT(passed_m(plan, 0, point, laser), 0);
  ASSERT_GT(passed_m(plan, 1, point, laser), 0);
  double before = 0, after = 1;
  for (int i = 0; i < 30; ++i) (passed_m(plan, 0.5 * (before + after), point, laser) < 0 ? before : after) = 0.5 * (before + after);
  const Vec3 in_laser = test::arm5e.base_from_laser(along(plan, after), laser).inverse() * point;
  ASSERT_GT(in_laser.z(), 0);
  ASSERT_LE(std::atan2(std::abs(in_laser.y()), in_laser.z()), laser.fan_half_angle_rad);
}

TEST(Sweep, PassesThePanelAndItsMarginAtEveryDockingError) {
  const LaserCalibration laser = test::nominal_laser();
  const SweepPlan plan = plan_sweep(test::arm5e, whole_panel(), laser);
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  std::mt19937_64 random(20);
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 20");
    const Pose base_from_panel = test::docked_panel(random, 0.020, rad_from_deg(2));
    for (double x : {-0.425, -0.2, 0.0, 0.2, 0.425})
      for (double y : {-0.403, -0.2, 0.0, 0.247}) expect_scanned(plan, base_from_panel * Vec3(x, y, 0), laser);
    if (HasFatalFailure()) return;
  }
}

TEST(Sweep, OfABandPassesTheWholeHandle) {
  const LaserCalibration laser = test::nominal_laser();
  std::mt19937_64 random(21);
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 21");
    const Pose base_from_panel = test::docked_panel(random, 0.020, rad_from_deg(2));
    const SweepPlan plan = plan_sweep(test::arm5e, handle_band(base_from_panel), laser);
    ASSERT_EQ(plan.outcome, SweepOutcome::ok);
    for (double angle = 0; angle < 2 * pi; angle += pi / 6)
      expect_scanned(plan, base_from_panel * Vec3(0.054 * std::cos(angle), 0.054 * std::sin(angle), 0.106), laser);
    if (HasFatalFailure()) return;
  }
}

// At the upper edge the light rises toward the panel: to start above what stands proud there, the stripe has to be higher on the plate.
TEST(Sweep, StartsAboveASecondHandleNearTheUpperEdge) {
  const LaserCalibration laser = test::nominal_laser();
  SweepRequest request = whole_panel();
  const SweepPlan one = plan_sweep(test::arm5e, request, laser);
  const SweepRequest::Handle second{Vec2(0.20, 0.19), 0.055, 0.107};
  ASSERT_TRUE(request.handles.push_back(second));
  const SweepPlan two = plan_sweep(test::arm5e, request, laser);
  ASSERT_EQ(one.outcome, SweepOutcome::ok);
  ASSERT_EQ(two.outcome, SweepOutcome::ok);
  std::mt19937_64 random(22);
  int missed_by_one = 0;
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 22");
    const Pose base_from_panel = test::docked_panel(random, 0.020, rad_from_deg(2));
    for (double angle = 0; angle < 2 * pi; angle += pi / 6) {
      const Vec2 rim = second.at_m + 0.054 * Vec2(std::cos(angle), std::sin(angle));
      expect_scanned(two, base_from_panel * Vec3(rim.x(), rim.y(), 0.106), laser);
    }
    if (HasFatalFailure()) return;
    missed_by_one += passed_m(one, 0, base_from_panel * Vec3(second.at_m.x(), second.at_m.y() + 0.054, 0.106), laser) >= 0;
  }
  EXPECT_GT(missed_by_one, 0) << "nothing was put to the test";
}

TEST(Sweep, IsWithinTheSoftLimitsWithRunUpAndAboveTheStiction) {
  const arm::JointLimits limits = test::arm5e.limits(0.05);
  for (const SweepRequest& request : {whole_panel(), handle_band(PanelLayout{}.nominal_base_from_panel())}) {
    const SweepPlan plan = plan_sweep(test::arm5e, request, test::nominal_laser());
    ASSERT_EQ(plan.outcome, SweepOutcome::ok);
    arm::ConstantSpeedSweep motion;
    EXPECT_EQ(motion.plan(joints(plan.start_rad), joints(plan.end_rad), plan.duration.s(), limits), arm::PlanOutcome::ok);
    for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) {
      EXPECT_TRUE(plan.speed_rad_s[i] == 0 || std::abs(plan.speed_rad_s[i]) >= 0.0649) << "joint " << i;
      EXPECT_NEAR(plan.start_rad[i] + plan.speed_rad_s[i] * plan.duration.s(), plan.end_rad[i], 1e-6);
    }
  }
}

// 14 s where the first exploration's elbow-only sweep took 18.1, its lines no further apart than 2.6 mm.
TEST(Sweep, OfTheWholePanelIsShortAndDense) {
  const SweepPlan plan = plan_sweep(test::arm5e, whole_panel(), test::nominal_laser());
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  EXPECT_LT(plan.duration.s(), 15);
  EXPECT_LT(plan.widest_spacing_m, 0.0027);
  EXPECT_GT(plan.widest_spacing_m, 0.0020);
}

TEST(Sweep, OfABandIsDenserWhenAskedForWithShoulderAndElbowTogether) {
  SweepRequest request = handle_band(PanelLayout{}.nominal_base_from_panel());
  request.line_spacing_m = 0.0015;
  const SweepPlan plan = plan_sweep(test::arm5e, request, test::nominal_laser());
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  EXPECT_LE(plan.widest_spacing_m, 0.0015);
  EXPECT_GT(plan.speed_rad_s[1], 0.06);
  EXPECT_LT(plan.speed_rad_s[2], -0.06);
}

TEST(Sweep, IsAsSlowAsItIsAskedToBe) {
  SweepRequest request = whole_panel();
  const SweepPlan slow = plan_sweep(test::arm5e, request, test::nominal_laser());
  request.slowest_rad_s = 0.1;
  const SweepPlan fast = plan_sweep(test::arm5e, request, test::nominal_laser());
  ASSERT_EQ(fast.outcome, SweepOutcome::ok);
  EXPECT_NEAR(std::abs(slow.speed_rad_s[2]), 0.065, 1e-9);
  EXPECT_NEAR(std::abs(fast.speed_rad_s[2]), 0.1, 1e-9);
  EXPECT_NEAR(fast.widest_spacing_m / slow.widest_spacing_m, 0.1 / 0.065, 0.02);
  request.slowest_rad_s = 0.5;
  EXPECT_NE(plan_sweep(test::arm5e, request, test::nominal_laser()).outcome, SweepOutcome::ok) << "faster than the joints go";
  request.slowest_rad_s = 0;
  EXPECT_EQ(plan_sweep(test::arm5e, request, test::nominal_laser()).outcome, SweepOutcome::bad_request);
}

TEST(Sweep, SpacingIsWhatItSays) {
  const LaserCalibration laser = test::nominal_laser();
  const SweepRequest request = whole_panel();
  const SweepPlan plan = plan_sweep(test::arm5e, request, laser);
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  // Where the stripe meets the panel's middle line, at every stripe.
  double widest = 0, before = 0;
  const int stripes = static_cast<int>(plan.duration.s() / request.stripe_period.s());
  for (int i = 0; i <= stripes; ++i) {
    const Pose pose = test::arm5e.base_from_laser(along(plan, static_cast<double>(i) / stripes), laser);
    const Vec3 normal = pose.linear().col(0);
    const Vec3 up = request.base_from_panel.linear().col(1);
    const double y = (pose.translation() - request.base_from_panel.translation()).dot(normal) / up.dot(normal);
    if (i > 0 && y < 0.247 && y > -0.403) widest = std::max(widest, before - y);
    before = y;
  }
  EXPECT_NEAR(plan.widest_spacing_m, widest, 0.08 * widest);  // the plan looks at eight places
}

// A laser that is mounted steeply upward needs the shoulder where no other does.
TEST(Sweep, IsFoundInTheWholeOfTheShouldersRange) {
  LaserCalibration upward = test::nominal_laser();
  upward.tool_from_laser.rotate(Eigen::AngleAxisd(1.4, Vec3::UnitY()));
  const SweepRequest request = whole_panel();
  const SweepPlan plan = plan_sweep(test::arm5e, request, upward);
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  EXPECT_LT(std::min(plan.start_rad[1], plan.end_rad[1]), 0.7);
  for (double x : {-0.425, 0.0, 0.425})
    for (double y : {-0.403, 0.0, 0.247}) expect_scanned(plan, request.base_from_panel * Vec3(x, y, 0), upward);
}

// An arm that is mounted to look ahead has its sweeps with the elbow turning the other way.
TEST(Sweep, OfAnArmThatLooksAheadFacesThePanel) {
  ArmModel model = test::arm5e.model();
  model.planar.mount_yaw_rad = 0;
  model.joints[1].lower_rad = -0.5;
  model.joints[1].upper_rad = 3;  // the upper arm comes back far enough for the forearm to stay before the panel
  model.joints[2].lower_rad = -3;
  model.joints[2].upper_rad = 3;
  model.planar.elbow_offset_rad = 0;
  const arm::Arm ahead(model);
  const SweepRequest request = whole_panel();
  const SweepPlan plan = plan_sweep(ahead, request, test::nominal_laser());
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  EXPECT_EQ(plan.start_rad[0], 0);
  const auto laser_at = [&](double f) { return ahead.base_from_laser(along(plan, f), test::nominal_laser()); };
  const auto passed = [&](double f, const Vec3& point) {
    const Pose pose = laser_at(f);
    const Vec3 up = request.base_from_panel.linear().col(1), normal = pose.linear().col(0);
    return std::copysign(1.0, up.dot(normal)) * normal.dot(point - pose.translation());
  };
  for (double x : {-0.425, 0.0, 0.425}) {
    for (double y : {-0.403, 0.0, 0.247}) {
      const Vec3 point = request.base_from_panel * Vec3(x, y, 0);
      EXPECT_LT(passed(0, point), 0) << x << ", " << y;
      EXPECT_GT(passed(1, point), 0) << x << ", " << y;
    }
  }
}

TEST(Sweep, SaysWhatStandsInItsWay) {
  const LaserCalibration laser = test::nominal_laser();
  SweepRequest request = whole_panel();
  request.top_m = 1.0;
  EXPECT_EQ(plan_sweep(test::arm5e, request, laser).outcome, SweepOutcome::top_unreachable);
  ArmModel stiff = test::arm5e.model();
  stiff.joints[2].lower_rad = 1.9;
  EXPECT_EQ(plan_sweep(arm::Arm(stiff), whole_panel(), laser).outcome, SweepOutcome::bottom_unreachable);
  LaserCalibration narrow = laser;
  narrow.fan_half_angle_rad = 0.4;
  EXPECT_EQ(plan_sweep(test::arm5e, whole_panel(), narrow).outcome, SweepOutcome::fan_too_narrow);
  request = whole_panel();
  request.margin_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(plan_sweep(test::arm5e, request, laser).outcome, SweepOutcome::bad_request);
  request = whole_panel();
  std::swap(request.top_m, request.bottom_m);
  EXPECT_EQ(plan_sweep(test::arm5e, request, laser).outcome, SweepOutcome::bad_request);
}

}  // namespace
}  // namespace lf::scan
