// Arms that can point their tool: postures, ways and rates against the product of their description's transforms, written out here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "firmware/arm/pointing.hpp"
#include "firmware/arm/tool_place.hpp"
#include "firmware/arm/trajectory.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"
#include "tests/arm5e.hpp"
#include "tests/unit/arm/arm_of_file.hpp"

namespace lf::arm {
namespace {

class Pointing : public ArmOfFile {
 protected:
  Pose tool_of(const JointVector& q) const {
    Pose pose = Pose::Identity();
    for (std::size_t i = 0; i < description.arm_joints(); ++i) {
      const ArmJoint& joint = description.joints[i];
      pose = pose * joint.parent_from_joint * Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], joint.axis);
    }
    return pose * description.wrist_from_tool;
  }

  // Six joints that point the tool can do it in many postures beside each other: which one it is depends on the way there.
  bool spare() const { return arm.pointing_joints() > 5; }

  bool within(const JointVector& q, double margin_rad) const {
    for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
      const double value = q[static_cast<Eigen::Index>(i)];
      if (value < arm.joint(i).lower_rad + margin_rad - 1e-9 || value > arm.joint(i).upper_rad - margin_rad + 1e-9) return false;
    }
    return true;
  }
};

TEST_P(Pointing, PutsTheToolThereSoPointedAndSoRolled) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  ASSERT_TRUE(can_point(arm));
  constexpr int poses = 500;
  for (int k = 0; k < poses; ++k) {
    const Pose target = tool_of(draw());
    const double roll_rad = uniform(-2, 2);
    const IkResult found = point_tool(arm, target.translation(), 3 * target.linear().col(2), roll_rad, 0, draw());
    ASSERT_TRUE(found.ok()) << k << ": " << name(found.outcome);
    const Pose reached = tool_of(found.q_rad);
    ASSERT_LT((reached.translation() - target.translation()).norm(), 1e-7) << k;
    ASSERT_LT((reached.linear().col(2) - target.linear().col(2)).norm(), 1e-7) << k;
    ASSERT_EQ(arm.roll_rad(found.q_rad), arm.rolls() ? roll_rad : 0);
    ASSERT_TRUE(within(found.q_rad, 0)) << k;
  }
}

// Of the postures the one that is near: a target beside the arm's place does not swing it about.
TEST_P(Pointing, StaysInThePostureWhereItIs) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  int looked_at = 0;
  for (int k = 0; k < 200; ++k) {
    const JointVector here = draw(0.7);
    if (is_singular(arm, here)) continue;
    Pose target = tool_of(here);
    target.translation() += 0.01 * Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
    JointVector led = here;
    if (!move_tool(arm, target.translation(), target.linear().col(2), led) || !within(led, 0)) continue;
    if ((led - here).cwiseAbs().maxCoeff() > 0.2) continue;  // another posture may be nearer
    const double roll_rad = arm.roll_rad(here);
    const IkResult found = point_tool(arm, target.translation(), target.linear().col(2), roll_rad, 0, here);
    ASSERT_TRUE(found.ok()) << k;
    ASSERT_LT((found.q_rad - led).cwiseAbs().maxCoeff(), spare() ? 0.1 : 1e-6) << k;
    ++looked_at;
  }
  EXPECT_GT(looked_at, 100);
}

TEST_P(Pointing, SaysWhyItCannot) {
  const JointVector here = draw();
  const Vec3 ahead = Vec3::UnitX();
  EXPECT_EQ(point_tool(arm, Vec3(NAN, 0, 0), ahead, 0, 0, here).outcome, IkOutcome::not_a_number);
  EXPECT_EQ(point_tool(arm, Vec3(0.4, 0, 0.4), Vec3::Zero(), 0, 0, here).outcome, IkOutcome::not_a_number);
  const IkResult far = point_tool_or_why(arm, Vec3(8, 0, 0), ahead, 0, 0, here);
  EXPECT_EQ(far.outcome, IkOutcome::too_far);
  EXPECT_GT(far.excess, 5);
  EXPECT_FALSE(point_tool(arm, Vec3(5, 0, 0), ahead, 0, 0, here).ok());
  const Pose target = tool_of(here);
  if (!arm.rolls()) return;
  const IkResult rolled = point_tool(arm, target.translation(), target.linear().col(2), 3.3, 0, here);
  EXPECT_EQ(rolled.outcome, IkOutcome::joint_limit);
  EXPECT_EQ(rolled.joint, arm.roll_joint());
  EXPECT_NEAR(rolled.excess, 3.3 - arm.joint(arm.roll_joint()).upper_rad, 1e-9);
}

TEST_P(Pointing, RatesMoveTheToolSoAndHoldItsAxis) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  constexpr double step = 1e-6;
  for (int k = 0; k < 100; ++k) {
    const JointVector q = draw();
    const Vec3 way_m(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    const JointVector rates = tool_rates(arm, q, way_m);
    if (!(rates.cwiseAbs().maxCoeff() < 50)) continue;  // near a singular posture
    const Pose before = tool_of(q - step * rates), after = tool_of(q + step * rates);
    ASSERT_LT(((after.translation() - before.translation()) / (2 * step) - way_m).norm(), 1e-4) << k;
    ASSERT_LT(((after.linear().col(2) - before.linear().col(2)) / (2 * step)).norm(), 1e-4) << k;
  }
}

TEST_P(Pointing, ALineKeepsTheToolOnItAndItsAxis) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  constexpr double tick_s = 0.004;
  const JointLimits limits = arm.limits(0.05);
  int planned = 0;
  for (int k = 0; k < 200; ++k) {
    const JointVector start = draw(0.6);
    const Pose from = tool_of(start);
    const Vec3 goal_m = from.translation() + 0.08 * Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
    const double goal_roll_rad = arm.roll_rad(start) + uniform(-0.5, 0.5);
    CartesianLine line;
    if (line.plan(arm, start, goal_m, goal_roll_rad, {}, limits).outcome != PlanOutcome::ok) continue;
    ++planned;
    JointVector last = line.sample(0).q_rad;
    ASSERT_LT((last - start).cwiseAbs().maxCoeff(), 1e-9);
    for (double t = tick_s; t < line.duration_s() + 2 * tick_s; t += tick_s) {
      const JointState s = line.sample(t);
      const Pose here = tool_of(s.q_rad);
      ASSERT_LT((here.translation() - line.tool_m(t)).norm(), 1e-7);
      ASSERT_LT((here.linear().col(2) - from.linear().col(2)).norm(), 1e-7);
      for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(arm.arm_joints()); ++i) {
        ASSERT_LE(std::abs(s.qd_rad_s[i]), 1.02 * limits.velocity_rad_s[i]) << i;
        ASSERT_LE(std::abs(s.qdd_rad_s2[i]), 1.05 * limits.acceleration_rad_s2[i]) << i;
        ASSERT_NEAR((s.q_rad[i] - last[i]) / tick_s, s.qd_rad_s[i], 0.02) << i;
      }
      last = s.q_rad;
    }
    ASSERT_LT((tool_of(last).translation() - goal_m).norm(), 1e-7);
    ASSERT_NEAR(arm.roll_rad(last), arm.rolls() ? goal_roll_rad : 0, 1e-9);
  }
  EXPECT_GT(planned, 100);
}

// There and back: from the place beside, a straight way leads to where it came from, in the same posture.
TEST_P(Pointing, APlaceBesideIsAStraightWayOff) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  int found = 0;
  for (int k = 0; k < 100; ++k) {
    const JointVector at = draw(0.6);
    const Pose tool = tool_of(at);
    const Vec3 beside_m = tool.translation() - 0.08 * tool.linear().col(2);
    const IkResult beside = place_tool_beside(arm, at, beside_m, tool.linear().col(2), arm.roll_rad(at), 0);
    if (!beside.ok()) continue;
    CartesianLine line;
    if (line.plan(arm, beside.q_rad, tool.translation(), arm.roll_rad(at), {}, arm.limits()).outcome != PlanOutcome::ok) continue;
    ++found;
    JointVector end = JointVector::Zero();
    for (double t = 0; t < line.duration_s() + 0.02; t += 0.01) end = line.sample(t).q_rad;
    if (!spare()) {
      ASSERT_LT((end - at).cwiseAbs().maxCoeff(), 1e-6) << k;
    }
    ASSERT_LT((tool_of(end).translation() - tool.translation()).norm(), 1e-6) << k;
  }
  EXPECT_GT(found, 50);
}

// A wrist whose outer axes are on one line cannot turn the tool sideways: no straight way leads past it, or a hair beside it.
TEST(SingularWrist, IsNotPassedByALine) {
  const Arm arm(make_model(load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/oberon7/oberon7.urdf")));
  JointVector straight = JointVector::Zero();
  straight.head<6>() << 0.1, 0.5, -0.4, 0.3, 0, 0;
  EXPECT_TRUE(is_singular(arm, straight));
  JointVector bent = straight;
  bent[4] = 0.5;
  EXPECT_FALSE(is_singular(arm, bent));
  for (const double beside_rad : {0.0, 1e-6, 1e-5, 1e-4, 1e-3}) {
    JointVector start = straight;
    start[3] = beside_rad;
    start[4] = 0.08;
    JointVector at = start;
    at[4] = 0;
    const Vec3 from_m = arm.base_from_tool(start).translation(), way_m = arm.base_from_tool(at).translation() - from_m;
    // The arm's plane turns with the tool's axis held: so far on the wrist is straight, or has been.
    CartesianLine line;
    const LinePlan past = line.plan(arm, start, from_m + 4 * way_m, 0, {}, arm.limits());
    EXPECT_TRUE(past.outcome != PlanOutcome::ok || line.duration_s() < 20) << beside_rad;
    JointVector last = line.sample(0).q_rad;
    for (double t = 0; t < line.duration_s(); t += 0.004) {
      const JointVector q = line.sample(t).q_rad;
      ASSERT_LT((q - last).cwiseAbs().maxCoeff(), 0.01) << beside_rad << " at " << t;
      last = q;
    }
  }
  // From a straight wrist no line begins.
  CartesianLine line;
  const LinePlan plan = line.plan(arm, straight, arm.base_from_tool(straight).translation() + Vec3(0, 0.05, 0), 0, {}, arm.limits());
  EXPECT_EQ(plan.outcome, PlanOutcome::unreachable);
  EXPECT_EQ(plan.ik, IkOutcome::turned_away);
}

// Half a turn of the approach axis is no small step.
TEST_P(Pointing, DoesNotJumpToWhatIsFarOff) {
  const JointVector at = draw(0.5);
  const Pose tool = tool_of(at);
  JointVector q = at;
  EXPECT_FALSE(move_tool(arm, tool.translation(), -tool.linear().col(2), q));
  q = at;
  EXPECT_FALSE(move_tool(arm, tool.translation() + Vec3(3, 0, 0), tool.linear().col(2), q));
}

INSTANTIATE_TEST_SUITE_P(Arms, Pointing,
                         testing::Values("tests/data/arms/six_joints/six_joints.urdf", "tests/data/arms/seven_joints/seven_joints.urdf",
                                         "shared/arm/oberon7/oberon7.urdf", "shared/arm/ur5/ur5.urdf",
                                         "shared/arm/predator/predator.urdf"));

// Where the makers' files have the tool, as another program computed it. Theirs has z up and ours down; the UR5 hangs from its base, aside, and its hand is longer.
struct Told {
  const char* ours;
  const char* fk;
  Mat3 ours_from_theirs;
  Vec3 aside_m;
  double longer_m;
};

void PrintTo(const Told& told, std::ostream* out) { *out << told.ours; }

class ShippedArms : public testing::TestWithParam<Told> {};

TEST_P(ShippedArms, HaveTheirToolWhereTheirMakersFileHasIt) {
  const Told& told = GetParam();
  const Arm arm(make_model(load_arm_urdf(std::string(LANTERNFISH_SOURCE_DIR "/shared/arm/") + told.ours)));
  std::ifstream file(std::string(LANTERNFISH_TEST_DATA "/arms/") + told.fk);
  ASSERT_TRUE(file);
  int rows = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || std::isalpha(static_cast<unsigned char>(line[0])) != 0) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    JointVector q = JointVector::Zero();
    Vec3 tool_m;
    Eigen::Quaterniond turn;
    for (std::size_t i = 0; i < arm.arm_joints(); ++i) numbers >> q[static_cast<Eigen::Index>(i)];
    numbers >> tool_m.x() >> tool_m.y() >> tool_m.z() >> turn.x() >> turn.y() >> turn.z() >> turn.w();
    ASSERT_TRUE(numbers) << line;
    const Vec3 approach = told.ours_from_theirs * (turn * Vec3::UnitZ());
    const Vec3 expected_m = told.ours_from_theirs * tool_m + told.aside_m + told.longer_m * approach;
    ASSERT_LT((arm.base_from_tool(q).translation() - expected_m).norm(), 1e-6) << line;
    ASSERT_LT((arm.approach_axis(q) - approach).norm(), 1e-6) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 5);
}

const Mat3 half_a_turn_about_x = Vec3(1, -1, -1).asDiagonal().toDenseMatrix();
INSTANTIATE_TEST_SUITE_P(Makers, ShippedArms,
                         testing::Values(Told{"oberon7/oberon7.urdf", "oberon7/fk.csv", half_a_turn_about_x, Vec3::Zero(), 0},
                                         Told{"predator/predator.urdf", "predator/fk.csv", half_a_turn_about_x, Vec3::Zero(), 0},
                                         Told{"ur5/ur5.urdf", "ur5/fk.csv", Mat3::Identity(), Vec3(0, -0.109, 0), 0.1485}));

// The planar form has an answer of its own; one of neither form has none.
TEST(CanWork, ArmsOfThePlanarFormAndThoseThatPoint) {
  EXPECT_TRUE(can_work(test::arm5e));
  EXPECT_FALSE(can_point(test::arm5e));
  ArmModel few = make_model(load_arm_urdf(LANTERNFISH_TEST_DATA "/arms/six_joints/six_joints.urdf"));
  few.arm_joints = 5;
  EXPECT_FALSE(can_work(Arm(few))) << "four joints place the tool and do not turn it";
  EXPECT_EQ(place_tool(Arm(few), Vec3(0.4, 0, 0.4), Vec3::UnitX(), 0, 0, JointVector::Zero()).outcome, IkOutcome::other_form);
}

}  // namespace
}  // namespace lf::arm
