#include "firmware/arm/pointing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/arm/chain/ik.hpp"

namespace lf::arm {
namespace {

constexpr double exact = 1e-9;  // m and rad

// Where the tool is and what it does at small turns of the pointing joints.
struct PointedTool {
  using Rows = Eigen::Matrix<double, 5, capacity::arm_joints>;
  using Change = Eigen::Matrix<double, 5, 1>;

  PointedTool(const Arm& arm, const JointVector& q_rad) {
    const LinkPoses links = arm.base_from_links(q_rad, 0);
    const Pose& last = links[arm.arm_joints() - 1];
    const Mat3 tool = arm.rolls() ? last.linear() : Mat3(last.linear() * arm.model().last_from_tool().linear());
    tool_m = last * arm.tool_on_last_m();
    approach = tool.col(2);
    across_x = tool.col(0);
    across_y = tool.col(1);
    for (std::size_t i = 0; i < arm.pointing_joints(); ++i) {
      const Vec3 axis = links[i].linear().col(2);
      const auto joint = static_cast<Eigen::Index>(i);
      rows.block<3, 1>(0, joint) = axis.cross(tool_m - links[i].translation());
      rows(3, joint) = across_x.dot(axis);
      rows(4, joint) = across_y.dot(axis);
    }
  }

  // The least change of the joints that moves and turns the tool so.
  JointVector joints_for(const Change& change) const {
    const Eigen::Matrix<double, 5, 5> square = rows * rows.transpose();
    return rows.transpose() * square.ldlt().solve(change);
  }
  Change change(const Vec3& way_m, const Vec3& turn) const {
    Change all;
    all << way_m.x(), way_m.y(), way_m.z(), across_x.dot(turn), across_y.dot(turn);
    return all;
  }

  Vec3 tool_m, approach, across_x, across_y;
  Rows rows = Rows::Zero();  // the tool point's motion, and its turns about the tool's x and y
};

// The arm, a roll without ends: what turns about the approach axis is chosen afterwards.
chain::Chain chain_of(const Arm& arm, double limit_margin_rad) {
  std::array<chain::ChainJoint, capacity::arm_joints> joints;
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    joints[i].parent_from_joint = arm.model().origins[i];
    joints[i].lower = arm.joint(i).lower_rad + limit_margin_rad;
    joints[i].upper = arm.joint(i).upper_rad - limit_margin_rad;
    joints[i].limited = !arm.rolls() || i != arm.roll_joint();
  }
  Pose last_from_tool = arm.rolls() ? Pose::Identity() : arm.model().last_from_tool();
  last_from_tool.translation() = arm.tool_on_last_m();
  chain::Chain chain;
  (void)chain.set(std::span(joints).first(arm.arm_joints()), last_from_tool);
  return chain;
}

// A tool that approaches so, turned about its axis as little as may be from what `tool` is.
Mat3 turned_to(const Mat3& tool, const Vec3& approach) {
  const Vec3 z = approach.normalized();
  Vec3 y = z.cross(tool.col(0));
  if (y.norm() < 0.1) y = tool.col(1) - z * z.dot(tool.col(1));
  y.normalize();
  Mat3 turned;
  turned << y.cross(z), y, z;
  return turned;
}

IkOutcome outcome_of(chain::IkOutcome found) {
  switch (found) {
    case chain::IkOutcome::solved: return IkOutcome::ok;
    case chain::IkOutcome::not_a_number: return IkOutcome::not_a_number;
    case chain::IkOutcome::joint_limit: return IkOutcome::joint_limit;
    case chain::IkOutcome::orientation_unreachable: return IkOutcome::turned_away;
    case chain::IkOutcome::out_of_reach: return IkOutcome::too_far;
    default: return IkOutcome::not_found;
  }
}

JointVector joints_of(const chain::JointValues& q, std::size_t count) {
  JointVector all = JointVector::Zero();
  all.head(static_cast<Eigen::Index>(count)) = q.head(static_cast<Eigen::Index>(count));
  return all;
}

// A pose of 10,000 drawn at random took 32 restarts (`lanternfish bench chain`); what is out of reach must not cost a control period.
chain::NumericIkConfig without_reasons() {
  chain::NumericIkConfig config;
  config.max_restarts = 32;
  config.explain = false;
  return config;
}

IkResult pointed(const Arm& arm, const Vec3& tool_m, const Vec3& approach, double roll_rad, double limit_margin_rad,
                 const JointVector& near_rad, const chain::NumericIkConfig& config) {
  IkResult result;
  if (!can_point(arm)) {
    result.outcome = IkOutcome::other_form;
    return result;
  }
  const bool numbers = tool_m.allFinite() && approach.allFinite() && near_rad.allFinite() && std::isfinite(roll_rad + limit_margin_rad);
  if (!numbers || !(approach.norm() > 0)) return result;
  chain::IkTask task;
  task.roll = arm.rolls();
  task.base_from_tool.translation() = tool_m;
  task.base_from_tool.linear() = turned_to(arm.base_from_tool(near_rad).linear(), approach);
  chain::JointValues seed = chain::JointValues::Zero();
  seed.head<capacity::arm_joints>() = near_rad;
  chain::Ik solver(chain_of(arm, limit_margin_rad));
  const chain::IkResult found = solver.solve(task, seed, config);
  result.outcome = outcome_of(found.outcome);
  result.excess = found.excess;
  result.joint = found.joint < 0 ? 0 : static_cast<std::size_t>(found.joint);
  result.q_rad = joints_of(found.nearest, arm.arm_joints());
  if (!arm.rolls()) return result;
  const std::size_t roll = arm.roll_joint();
  result.q_rad[static_cast<Eigen::Index>(roll)] = roll_rad;
  const double lower_rad = arm.joint(roll).lower_rad + limit_margin_rad, upper_rad = arm.joint(roll).upper_rad - limit_margin_rad;
  const double past_rad = std::max({0.0, lower_rad - roll_rad, roll_rad - upper_rad});
  if (!result.ok() || past_rad <= exact) return result;
  result.outcome = IkOutcome::joint_limit;
  result.joint = roll;
  result.excess = past_rad;
  return result;
}

}  // namespace

const char* family_of(const Arm& arm) { return chain::name(chain::classify(chain_of(arm, 0)).family); }

IkResult point_tool(const Arm& arm, const Vec3& tool_m, const Vec3& approach, double roll_rad, double limit_margin_rad,
                    const JointVector& near_rad) {
  return pointed(arm, tool_m, approach, roll_rad, limit_margin_rad, near_rad, without_reasons());
}

IkResult point_tool_or_why(const Arm& arm, const Vec3& tool_m, const Vec3& approach, double roll_rad, double limit_margin_rad,
                           const JointVector& near_rad) {
  return pointed(arm, tool_m, approach, roll_rad, limit_margin_rad, near_rad, chain::NumericIkConfig());
}

bool move_tool(const Arm& arm, const Vec3& tool_m, const Vec3& approach, JointVector& q_rad) {
  constexpr int most_steps = 8;
  constexpr double longest_step_rad = 0.5;
  const Vec3 wanted = approach.normalized();
  for (int step = 0; step <= most_steps; ++step) {
    const PointedTool tool(arm, q_rad);
    const Vec3 way_m = tool_m - tool.tool_m, turn = tool.approach.cross(wanted);
    if (!(tool.approach.dot(wanted) > 0)) return false;
    if (way_m.norm() < exact && turn.norm() < exact) return true;
    const JointVector change = tool.joints_for(tool.change(way_m, turn));
    if (!(change.cwiseAbs().maxCoeff() <= longest_step_rad)) return false;
    q_rad += change;
  }
  return false;
}

bool is_singular(const Arm& arm, const JointVector& q_rad) {
  // The square of the sine of a degree: of a wrist whose outer axes are so far from one line, or an elbow that is so far from stretched.
  constexpr double least_square = 3e-4;
  const PointedTool tool(arm, q_rad);
  PointedTool::Rows rows = tool.rows;
  const double length_m = std::max(rows.topRows<3>().colwise().norm().maxCoeff(), 1e-3);
  rows.topRows<3>() /= length_m;
  const Eigen::Matrix<double, 5, 5> square = rows * rows.transpose();
  return !(square.ldlt().vectorD().minCoeff() > least_square);
}

JointVector tool_rates(const Arm& arm, const JointVector& q_rad, const Vec3& way_m) {
  const PointedTool tool(arm, q_rad);
  return tool.joints_for(tool.change(way_m, Vec3::Zero()));
}

}  // namespace lf::arm
