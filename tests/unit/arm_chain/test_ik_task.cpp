#include <gtest/gtest.h>

#include <limits>

#include "firmware/arm/chain/ik_task.hpp"
#include "tests/unit/arm_chain/random_postures.hpp"
#include "tests/unit/arm_chain/real_arms.hpp"

namespace lf::chain {
namespace {

constexpr std::uint64_t seed = 20261128;

IkTask task_at(const Pose& pose, bool axis, bool roll) {
  IkTask task;
  task.base_from_tool = pose;
  task.axis = axis;
  task.roll = roll;
  return task;
}

Pose turned(const Pose& pose, const Vec3& tool_axis, double angle_rad) {
  Pose out = pose;
  out.linear() = pose.linear() * Eigen::AngleAxisd(angle_rad, tool_axis).toRotationMatrix();
  return out;
}

TEST(IkTask, MeasuresTiltAndRollAsTheyWereMade) {
  const Chain chain = chain_of(ur5());
  RandomPostures random(chain, seed);
  for (int k = 0; k < 1000; ++k) {
    const Pose at = chain.base_from_tool(random.next());
    const double tilt = random.uniform(0, 3), roll = random.uniform(-3.1, 3.1);
    const double direction = random.uniform(-pi, pi);
    const Vec3 about(std::cos(direction), std::sin(direction), 0);
    Pose want = turned(at, about, tilt);
    want.translation() += Vec3(0.01, -0.02, 0.02);
    const TaskError axis = task_error(task_at(want, true, false), at.linear(), at.translation());
    ASSERT_NEAR(axis.position_m, 0.03, 1e-12);
    ASSERT_NEAR(axis.axis_rad, tilt, 1e-9);
    ASSERT_EQ(axis.roll_rad, 0) << "not asked for";
    want = turned(at, Vec3::UnitZ(), roll);
    ASSERT_NEAR(task_error(task_at(want, false, true), at.linear(), at.translation()).roll_rad, std::abs(roll), 1e-9);
    ASSERT_NEAR(task_error(task_at(want, true, true), at.linear(), at.translation()).orientation_rad, std::abs(roll), 1e-7);
  }
}

// Half a turn is the one angle whose axis the sine does not tell.
TEST(IkTask, MeasuresHalfATurnAboutAnyAxis) {
  for (const Vec3& about : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.6, -0.8, 0), Vec3(0.48, 0.6, 0.64)}) {
    const Pose at = Pose::Identity();
    for (const double angle : {pi, pi - 1e-6, pi - 0.1}) {
      const TaskError error = task_error(task_at(turned(at, about, angle), true, true), at.linear(), at.translation());
      EXPECT_NEAR(error.orientation_rad, angle, 1e-8) << about.transpose();
    }
  }
}

TEST(IkTask, SaysThatABarAlongTheApproachAxisHasNoRoll) {
  Pose want = Pose::Identity();
  want.linear() = Eigen::AngleAxisd(pi / 2, Vec3::UnitX()).toRotationMatrix();  // its y is the tool's z
  EXPECT_GT(task_error(task_at(want, false, true), Mat3::Identity(), Vec3::Zero()).roll_rad, 1);
}

// The descent follows these rates: they have to be those of the residual, for every mask and tolerance.
TEST(IkTask, ItsResidualFallsAsItSays) {
  constexpr double h = 1e-6;
  const Chain chain = chain_of(panda());
  RandomPostures random(chain, seed + 1);
  int compared = 0;
  for (int k = 0; k < 2000; ++k) {
    const JointValues q = random.next();
    IkTask task = task_at(chain.base_from_tool(random.next()), k % 2 == 0, k % 4 < 2);
    task.position_tolerance_m = k % 3 == 0 ? 0.2 : 0;
    task.axis_tolerance_rad = k % 5 == 0 ? 0.4 : 0;
    task.roll_tolerance_rad = k % 7 == 0 ? 0.3 : 0;
    ChainState state, before, after;
    chain.evaluate(q, state);
    TaskResidual here, low, high;
    residual(task, state, chain.length_m(), 1.5, here);
    const Jacobian j = chain.jacobian(q);
    for (std::size_t i = 0; i < chain.size(); ++i) {
      JointValues a = q, b = q;
      a[i] -= h;
      b[i] += h;
      chain.evaluate(a, before);
      chain.evaluate(b, after);
      residual(task, before, chain.length_m(), 1.5, low);
      residual(task, after, chain.length_m(), 1.5, high);
      // The square's slope: the same in whatever frame the rows are.
      const double slope = (high.value.squaredNorm() - low.value.squaredNorm()) / (2 * h);
      Eigen::Matrix<double, 6, 1> fall;
      fall << here.from_linear * j.col(i).head<3>(), here.from_angular * j.col(i).tail<3>();
      if (std::abs(slope) > 50) continue;  // across the step of a half turn
      ASSERT_NEAR(slope, -2 * here.value.dot(fall), 1e-5) << "mask " << task.axis << task.roll << " joint " << i << " case " << k;
      ++compared;
    }
  }
  EXPECT_GT(compared, 13'000);
}

TEST(IkTask, IsMetWithinItsTolerancesAndNotBeyond) {
  IkTask task;
  task.position_tolerance_m = 0.01;
  task.axis_tolerance_rad = 0.2;
  task.roll_tolerance_rad = 0.05;
  const auto is_met = [&](double x_m, double tilt, double roll) {
    Pose at = turned(turned(Pose::Identity(), Vec3::UnitX(), tilt), Vec3::UnitZ(), roll);
    at.translation().x() = x_m;
    ChainState state;
    state.tool = at.linear();
    state.tool_m = at.translation();
    TaskResidual out;
    residual(task, state, 1, 1, out);
    EXPECT_EQ(out.is_met, met(task, task_error(task, at.linear(), at.translation()), 1));
    return out.is_met;
  };
  EXPECT_TRUE(is_met(0.0099, 0.19, 0.049));
  EXPECT_FALSE(is_met(0.0101, 0.19, 0.049));
  EXPECT_FALSE(is_met(0.0099, 0.21, 0.049));
  EXPECT_FALSE(is_met(0.0099, 0.19, 0.051));
}

TEST(IkTask, RefusesWhatIsNoTask) {
  IkTask task;
  EXPECT_TRUE(task.valid());
  IkTask bad = task;
  bad.base_from_tool.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(bad.valid());
  bad = task;
  bad.base_from_tool.linear() *= 2;
  EXPECT_FALSE(bad.valid());
  bad = task;
  bad.roll_tolerance_rad = -0.1;
  EXPECT_FALSE(bad.valid());
  bad = task;
  bad.position_tolerance_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(bad.valid());
}

TEST(ToolWithAxes, TurnsTheFrameSoThatZApproachesAndXOpens) {
  Pose tool = turned(Pose::Identity(), Vec3(0.48, 0.6, 0.64), 0.7);
  tool.translation() = Vec3(1, 2, 3);
  const std::optional<Pose> out = tool_with_axes(tool, FrameAxis::minus_y, FrameAxis::x);
  ASSERT_TRUE(out);
  EXPECT_EQ(Vec3(out->linear().col(2)), Vec3(-tool.linear().col(1)));
  EXPECT_EQ(Vec3(out->linear().col(0)), Vec3(tool.linear().col(0)));
  EXPECT_NEAR(out->linear().determinant(), 1, 1e-12);
  EXPECT_EQ(Vec3(out->translation()), Vec3(1, 2, 3));
  EXPECT_FALSE(tool_with_axes(tool, FrameAxis::x, FrameAxis::minus_x));
}

}  // namespace
}  // namespace lf::chain
