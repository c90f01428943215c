// Sweeps of arms that point: what the planner says of its plan against the description's own chain of transforms, over panels anywhere within the docking error.
#include "firmware/scan/pointed_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "firmware/arm/gripper.hpp"
#include "firmware/scan/sweep.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"
#include "tests/arm5e.hpp"

namespace lf::scan {
namespace {

struct Case {
  const char* name;
  const char* urdf;
  std::vector<double> park_rad;
  Vec3 laser_m, camera_m, panel_m;
  double fan_deg, slowest_rad_s, laser_turn_deg = 0;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class PointedSweep : public testing::TestWithParam<Case> {
 protected:
  PointedSweep() {
    request.base_from_panel.translation() = GetParam().panel_m;
    request.camera_m = GetParam().camera_m;
    request.slowest_rad_s = GetParam().slowest_rad_s;
    (void)request.handles.push_back({});
    laser.tool_from_laser.translation() = GetParam().laser_m;
    laser.tool_from_laser.linear() = Eigen::AngleAxisd(rad_from_deg(GetParam().laser_turn_deg), Vec3::UnitZ()).toRotationMatrix();
    laser.fan_half_angle_rad = rad_from_deg(GetParam().fan_deg);
    for (std::size_t i = 0; i < GetParam().park_rad.size(); ++i) park_rad[static_cast<Eigen::Index>(i)] = GetParam().park_rad[i];
  }

  SweepPlan planned() const { return planned(request, laser); }
  SweepPlan planned(const SweepRequest& asked, const LaserCalibration& by) const {
    arm::Surroundings surroundings(arm, layout, vehicle);
    surroundings.enter({asked.base_from_panel, {asked.docking_shift_m, asked.docking_turn_rad, 0}, {jaw_rad(), jaw_rad()}, 0});
    return plan_sweep(arm, asked, by, park_rad, surroundings);
  }
  double jaw_rad() const { return arm::jaw_from_gap(arm.jaw(), 0); }

  arm::JointVector along(const SweepPlan& plan, double share) const {
    const arm::JointVector from(plan.start_rad.data()), to(plan.end_rad.data());
    return from + share * (to - from);
  }

  // The laser, carried by the joints that point the tool.
  Pose laser_of(const SweepPlan& plan, double share) const {
    const arm::JointVector q = along(plan, share);
    Pose pose = Pose::Identity();
    for (std::size_t i = 0; i < description.arm_joints(); ++i) {
      const ArmJoint& joint = description.joints[i];
      const bool rolls = description.rolls && i + 1 == description.arm_joints();
      const double angle_rad = rolls ? 0 : q[static_cast<Eigen::Index>(i)];
      pose = pose * joint.parent_from_joint * Eigen::AngleAxisd(angle_rad, joint.axis);
    }
    return pose * description.wrist_from_tool * laser.tool_from_laser;
  }

  // Positive where the stripe has yet to come down to the point; up is the panel's.
  double above_m(const SweepPlan& plan, double share, const Vec3& point_m) const {
    const Pose pose = laser_of(plan, share);
    const Vec3 normal = pose.linear().col(0);
    const double up = std::copysign(1.0, normal.dot(request.base_from_panel.linear().col(1)));
    return up * normal.dot(pose.translation() - point_m);
  }

  ArmDescription description = load_arm_urdf(std::string(LANTERNFISH_SOURCE_DIR "/") + GetParam().urdf);
  arm::Arm arm{make_model(description)};
  SweepRequest request = [] {
    SweepRequest of_docked_panel;
    of_docked_panel.base_from_panel = PanelLayout{}.nominal_base_from_panel();
    return of_docked_panel;
  }();
  LaserCalibration laser;
  PanelLayout layout;
  arm::VehicleShape vehicle;
  arm::JointVector park_rad = arm::JointVector::Zero();
};

TEST_P(PointedSweep, PassesThePanelWhereverItMayStand) {
  constexpr std::uint64_t seed = 22;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const SweepPlan plan = planned();
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    Pose panel = request.base_from_panel;
    for (Eigen::Index i = 0; i < 3; ++i) panel.translation()[i] += request.docking_shift_m * share(random);
    for (Eigen::Index i = 0; i < 3; ++i)
      panel.linear() = (Eigen::AngleAxisd(request.docking_turn_rad * share(random), Vec3::Unit(i)) * panel.linear()).eval();
    for (const double x : {request.left_m, 0.0, request.right_m}) {
      for (const double y : {request.bottom_m, -0.1, request.top_m}) {
        const Vec3 point_m = panel * Vec3(x, y, 0);
        ASSERT_GT(above_m(plan, 0, point_m), 0) << trial << " " << x << " " << y;
        ASSERT_LT(above_m(plan, 1, point_m), 0) << trial << " " << x << " " << y;
        double before = 0, after = 1;
        for (int i = 0; i < 30; ++i) (above_m(plan, (before + after) / 2, point_m) > 0 ? before : after) = (before + after) / 2;
        const Vec3 in_laser = laser_of(plan, after).inverse() * point_m;
        ASSERT_GT(in_laser.z(), 0);
        ASSERT_LE(std::abs(std::atan2(in_laser.y(), in_laser.z())), laser.fan_half_angle_rad) << trial << " " << x << " " << y;
      }
    }
  }
}

// Joints do not move below their stiction.
TEST_P(PointedSweep, MovesOneJointAndFastEnough) {
  const SweepPlan plan = planned();
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  int moving = 0;
  const arm::JointLimits limits = arm.limits();
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double way_rad = plan.end_rad[i] - plan.start_rad[i];
    EXPECT_NEAR(plan.speed_rad_s[i] * plan.duration.s(), way_rad, 1e-9);
    for (const double end_rad : {plan.start_rad[i], plan.end_rad[i]}) {
      EXPECT_GE(end_rad, limits.lower_rad[k] + 0.05);
      EXPECT_LE(end_rad, limits.upper_rad[k] - 0.05);
    }
    if (way_rad == 0) continue;
    ++moving;
    EXPECT_GE(std::abs(plan.speed_rad_s[i]), request.slowest_rad_s - 1e-9);
    EXPECT_LE(std::abs(plan.speed_rad_s[i]), limits.velocity_rad_s[k]);
  }
  EXPECT_EQ(moving, 1);
}

// Where each stripe meets the panel, one below the other, by intersection of plane and panel.
TEST_P(PointedSweep, ItsLinesLieNoFartherApartThanItSays) {
  const SweepPlan plan = planned();
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  const auto height_m = [&](double share) {
    const Pose panel_from_laser = request.base_from_panel.inverse() * laser_of(plan, share);
    const Vec3 normal = panel_from_laser.linear().col(0);
    return panel_from_laser.translation().dot(normal) / normal.y();
  };
  const double step = request.stripe_period.s() / plan.duration.s();
  double widest_m = 0;
  for (double share = 0; share + step <= 1; share += step) {
    const double here_m = height_m(share), next_m = height_m(share + step);
    ASSERT_GT(here_m, next_m) << "it goes down all the way";
    if (here_m <= request.top_m && next_m >= request.bottom_m) widest_m = std::max(widest_m, here_m - next_m);
  }
  EXPECT_LE(widest_m, 1.1 * plan.widest_spacing_m) << "it was looked at in seven places";
  EXPECT_GT(widest_m, 0.5 * plan.widest_spacing_m);
}

// Between the places that were looked at, too, and by another way of telling whether a link stands in a line of sight: by points along it.
TEST_P(PointedSweep, KeepsClearAndHidesLittleOfTheStripe) {
  const SweepPlan plan = planned();
  ASSERT_EQ(plan.outcome, SweepOutcome::ok);
  arm::Surroundings surroundings(arm, layout, vehicle);
  surroundings.enter({request.base_from_panel, {request.docking_shift_m, request.docking_turn_rad, 0}, {jaw_rad(), jaw_rad()}, 0});
  int seen = 0, hidden = 0;
  for (int i = 0; i <= 100; ++i) {
    const arm::JointVector q = along(plan, i / 100.0);
    const arm::Distances here = surroundings.distances(q, jaw_rad());
    EXPECT_GT(std::min({here.panel_m, here.vehicle_m, here.itself_m}), 0.010) << i;
    const Pose pose = laser_of(plan, i / 100.0);
    for (const double x : {-0.4, -0.2, 0.0, 0.2, 0.4}) {
      const Vec3 left = request.base_from_panel * Vec3(x, 0, 0), up = request.base_from_panel.linear().col(1),
                 normal = pose.linear().col(0);
      const double y = normal.dot(pose.translation() - left) / normal.dot(up);
      if (y > request.top_m || y < request.bottom_m) continue;
      const Vec3 point_m = left + y * up, sight_m = point_m - request.camera_m;
      EXPECT_GT(std::abs(sight_m.normalized().dot(normal)), 0.1) << "the camera looks along the sheet at " << i;
      bool barred = false;
      for (const arm::Capsule& link : arm.link_capsules(q, jaw_rad())) {
        for (double share = 0; share <= 1 && !barred; share += 0.005) {
          const Vec3 at_m = request.camera_m + share * sight_m, axis_m = link.b_m - link.a_m;
          const double along_axis = std::clamp((at_m - link.a_m).dot(axis_m) / std::max(axis_m.squaredNorm(), 1e-12), 0.0, 1.0);
          barred = (at_m - link.a_m - along_axis * axis_m).norm() < link.radius_m;
        }
      }
      ++seen;
      hidden += barred ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 300);
  EXPECT_LE(hidden, 0.25 * seen);
}

// No control tick bears it all, and none waits for long.
TEST_P(PointedSweep, IsPlannedInSharesOfNoMoreThanTwelveSeconds) {
  PointedSweepPlanner planner;
  arm::Surroundings surroundings(arm, layout, vehicle);
  surroundings.enter({request.base_from_panel, {request.docking_shift_m, request.docking_turn_rad, 0}, {jaw_rad(), jaw_rad()}, 0});
  planner.begin(arm, request, laser, park_rad);
  int shares = 0;
  while (!planner.advance(surroundings)) ++shares;
  EXPECT_GT(shares, 10);
  EXPECT_LT(shares, 3000);
}

TEST_P(PointedSweep, IsRefusedWhereThereIsNone) {
  SweepRequest far = request;
  far.base_from_panel.translation().x() += 3;
  EXPECT_EQ(planned(far, laser).outcome, SweepOutcome::top_unreachable);
  SweepRequest bad = request;
  bad.camera_m.x() = NAN;
  EXPECT_EQ(planned(bad, laser).outcome, SweepOutcome::bad_request);
  SweepRequest fast = request;
  fast.slowest_rad_s = 2;
  EXPECT_NE(planned(fast, laser).outcome, SweepOutcome::ok) << "faster than the joints go";
  SweepRequest blind = request;
  blind.camera_m = laser_of(planned(), 0.5).translation();
  const SweepPlan other = planned(blind, laser);
  EXPECT_TRUE(other.outcome != SweepOutcome::ok || other.start_rad != planned().start_rad) << "the camera would look along the sheet";
  EXPECT_EQ(plan_sweep(arm, request, laser).outcome, SweepOutcome::bad_request) << "as if it were of the planar form";
}

INSTANTIATE_TEST_SUITE_P(Arms, PointedSweep,
                         testing::Values(Case{"Oberon",
                                              "shared/arm/oberon7/oberon7.urdf",
                                              {0, 1.2, -1.0, 0, 0.3, 0},
                                              {-0.12, 0, -0.3},
                                              {0.1, -0.5, 0.75},
                                              {1.3, 0, 0.2},
                                              40,
                                              0.045},
                                         Case{"Predator",
                                              "shared/arm/predator/predator.urdf",
                                              {0, 1.2, -1.2, 0.3, 0},
                                              {0, 0.12, -0.3},
                                              {0.1, -0.5, 0.75},
                                              {1.6, 0, 0},
                                              40,
                                              0.045,
                                              -90},
                                         Case{"Ur",
                                              "shared/arm/ur5/ur5.urdf",
                                              {0, -1.934, 2.304, -0.37, 1.5708, 0},
                                              {-0.1, 0, -0.2},
                                              {0, -0.42, -0.05},
                                              {0.75, 0, 0.35},
                                              50,
                                              0.055},
                                         Case{"SixJoints",
                                              "tests/data/arms/six_joints/six_joints.urdf",
                                              {0, 0.6, -1.3, 0, 0.4, 0},
                                              {-0.09, 0, -0.365},
                                              {0.015, -0.245, 0.06},
                                              {0.7, 0, 0.5},
                                              40,
                                              0.065}));

}  // namespace
}  // namespace lf::scan
