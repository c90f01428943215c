#include "hal/config/arm_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/input_error.hpp"
#include "shared/random.hpp"

namespace lf::config {

namespace {

using urdf::Joint;
using urdf::JointType;
using urdf::Mechanism;

[[noreturn]] void refuse(const Mechanism& mechanism, int line, const std::string& what) {
  throw InputError(mechanism.file + ":" + std::to_string(line) + ": " + what);
}

std::vector<std::size_t> leaves(const Mechanism& mechanism) {
  std::vector<bool> carries(mechanism.links.size(), false);
  for (const Joint& joint : mechanism.joints) carries[joint.parent] = true;
  std::vector<std::size_t> ends;
  for (std::size_t link = 0; link < carries.size(); ++link) {
    if (!carries[link]) ends.push_back(link);
  }
  return ends;
}

std::size_t tool_of(const Mechanism& mechanism, const std::string& name) {
  if (!name.empty()) return mechanism.link(name);
  const std::vector<std::size_t> ends = leaves(mechanism);
  if (ends.size() == 1) return ends.front();
  std::string names;
  for (const std::size_t end : ends) names += (names.empty() ? "'" : ", '") + mechanism.links[end].name + "'";
  throw InputError(mechanism.file + ": the arm could end at " + names + ": say which link is the tool (--tool LINK)");
}

chain::ChainJoint chain_joint(const Joint& joint, const Pose& before) {
  chain::ChainJoint out;
  out.kind = joint.type == JointType::prismatic ? chain::JointKind::prismatic : chain::JointKind::revolute;
  out.parent_from_joint = before * joint.parent_from_joint;
  out.axis = joint.axis;
  out.limited = joint.range.has_value();
  if (joint.range) out.lower = joint.range->lower, out.upper = joint.range->upper;
  return out;
}

// A joint moves the tool point where that is off its axis. In a posture drawn at random it is, if it ever is.
bool moves_its_tool(const chain::Chain& arm) {
  constexpr int postures = 8;
  constexpr double least_m = 1e-6;  // what files with few digits leave of an axis through the tool
  std::uint64_t state = 1;
  for (int k = 0; k < postures; ++k) {
    const chain::Jacobian jacobian = arm.jacobian(random_posture(arm, state));
    for (std::size_t i = 0; i < arm.size(); ++i) {
      const chain::ChainJoint& joint = arm.joint(i);
      const double range = joint.limited ? std::min(1.0, joint.upper - joint.lower) : 1;
      if (jacobian.col(Eigen::Index(i)).head<3>().norm() * range > least_m) return true;
    }
  }
  return false;
}

}  // namespace

chain::JointValues random_posture(const chain::Chain& arm, std::uint64_t& state) {
  chain::JointValues q = chain::JointValues::Zero();
  for (std::size_t i = 0; i < arm.size(); ++i) {
    const double share = std::ldexp(static_cast<double>(splitmix64(state) >> 11), -53);
    state += splitmix64_step;
    const chain::ChainJoint& joint = arm.joint(i);
    const double lower = joint.limited ? joint.lower : -pi, upper = joint.limited ? joint.upper : pi;
    q[Eigen::Index(i)] = lower + share * (upper - lower);
  }
  return q;
}

ArmChain arm_chain(const Mechanism& mechanism, const ArmEnds& ends) {
  const std::size_t base = ends.base_link.empty() ? Mechanism::root : mechanism.link(ends.base_link);
  const std::size_t tool = tool_of(mechanism, ends.tool_link);
  ArmChain arm;
  arm.base_link = mechanism.links[base].name, arm.tool_link = mechanism.links[tool].name;
  std::array<chain::ChainJoint, chain::max_joints> joints;
  Pose since = Pose::Identity();  // from the last joint that moves, or the base
  for (const urdf::Step& step : mechanism.path(base, tool)) {
    const Joint& joint = mechanism.joints[step.joint];
    if (!step.outward)
      throw InputError(mechanism.file + ": '" + arm.base_link + "' does not carry '" + arm.tool_link + "': the base is a link between '" +
                       mechanism.links[Mechanism::root].name + "' and the tool");
    if (!joint.moves()) {
      since = since * joint.parent_from_joint;
      continue;
    }
    if (joint.mimic)
      refuse(mechanism, joint.line,
             "joint '" + joint.name + "' mimics '" + mechanism.joints[joint.mimic->joint].name +
                 "', and lies between base and tool: an arm's joints move on their own. Choose a tool link before it");
    if (arm.joints.size() < chain::max_joints) joints[arm.joints.size()] = chain_joint(joint, since);
    arm.joints.push_back(step.joint);
    since = Pose::Identity();
  }
  if (arm.joints.empty()) throw InputError(mechanism.file + ": no joint moves between '" + arm.base_link + "' and '" + arm.tool_link + "'");
  if (arm.joints.size() > chain::max_joints)
    throw InputError(mechanism.file + ": " + std::to_string(arm.joints.size()) + " joints move between '" + arm.base_link + "' and '" +
                     arm.tool_link + "', an arm has " + std::to_string(chain::max_joints) + " at most: choose links that are nearer");
  Pose tool_axes = Pose::Identity();
  tool_axes.linear() = urdf::tool_axes(ends.approach, ends.opening);
  const auto fault = arm.chain.set({joints.data(), arm.joints.size()}, since * tool_axes);
  if (fault != chain::ChainFault::none) throw InputError(mechanism.file + ": no chain can be made of it: " + chain::name(fault));
  if (!moves_its_tool(arm.chain))
    refuse(mechanism, mechanism.links[tool].line,
           "the tool cannot move: link '" + arm.tool_link + "' has its origin on the axis of each joint from '" + arm.base_link +
               "' on. Choose a tool link farther out (--tool LINK)");
  return arm;
}

}  // namespace lf::config
