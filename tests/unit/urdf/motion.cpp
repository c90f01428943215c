#include "tests/unit/urdf/motion.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "shared/random.hpp"

namespace lf::urdf {
namespace {

// The free joint among `free` that moves joint `joint`, and by how much.
struct Share {
  std::size_t column;
  double multiplier;
};

std::optional<Share> share_of(const Mechanism& mechanism, const std::vector<std::size_t>& free, std::size_t joint) {
  const Mimic driver = mechanism.driver(joint);
  const auto found = std::find(free.begin(), free.end(), driver.joint);
  if (found == free.end()) return std::nullopt;
  return Share{static_cast<std::size_t>(found - free.begin()), driver.multiplier};
}

// Evenly in [0, 1).
double unit(std::uint64_t& state) {
  const std::uint64_t bits = splitmix64(state);
  state += splitmix64_step;
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

// Of a matrix with columns. The threshold is a share of its largest pivot: rotations that a file writes with 4 digits are off by 4e-6.
Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposed(const Eigen::MatrixXd& matrix) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> result;
  result.setThreshold(1e-5);
  result.compute(matrix);
  return result;
}

}  // namespace

std::vector<double> coordinates(const Mechanism& mechanism, std::span<const std::size_t> free, std::span<const double> q) {
  std::vector<double> all(mechanism.joints.size(), 0);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (const auto& range = mechanism.joints[i].range) all[i] = range->middle();
  for (std::size_t i = 0; i < free.size(); ++i) all[free[i]] = q[i];
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!mechanism.joints[i].mimic) continue;
    const Mimic driver = mechanism.driver(i);
    all[i] = driver.multiplier * all[driver.joint] + driver.offset;
  }
  return all;
}

Pose begin_from_end(const Mechanism& mechanism, std::span<const Step> path, std::span<const double> all) {
  Pose pose = Pose::Identity();
  for (const Step& step : path) {
    const Pose joint = mechanism.joints[step.joint].parent_from_child(all[step.joint]);
    pose = pose * (step.outward ? joint : joint.inverse());
  }
  return pose;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const Mechanism& mechanism, std::span<const Step> path, std::span<const double> all) {
  const std::vector<std::size_t> free = mechanism.free_joints({path.begin(), path.end()});
  Eigen::Matrix<double, 6, Eigen::Dynamic> result(6, static_cast<Eigen::Index>(free.size()));
  result.setZero();
  const Vec3 end = begin_from_end(mechanism, path, all).translation();
  Pose pose = Pose::Identity();
  for (const Step& step : path) {
    const Joint& joint = mechanism.joints[step.joint];
    const Pose moved = joint.parent_from_child(all[step.joint]);
    // The axis is the same in the joint's and in the child's frame.
    const Pose before = pose;
    pose = pose * (step.outward ? moved : moved.inverse());
    if (!joint.moves()) continue;
    const auto share = share_of(mechanism, free, step.joint);
    if (!share) continue;
    const Pose& child = step.outward ? pose : before;
    const Vec3 axis = (step.outward ? 1 : -1) * share->multiplier * (child.linear() * joint.axis);
    auto column = result.col(static_cast<Eigen::Index>(share->column));
    if (joint.type == JointType::prismatic) {
      column.head<3>() += axis;
    } else {
      column.head<3>() += axis.cross(end - child.translation());
      column.tail<3>() += axis;
    }
  }
  return result;
}

Freedom freedom(const Mechanism& mechanism, const std::vector<Step>& path, const Vec3& approach) {
  Freedom result;
  const std::vector<std::size_t> free = mechanism.free_joints(path);
  result.joints = free.size();
  if (free.empty()) return result;
  constexpr int draws = 8;  // a pose drawn at random is singular with probability 0; the best of several is told
  std::uint64_t state = 1;
  std::vector<double> q(free.size());
  for (int draw = 0; draw < draws; ++draw) {
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Range range = mechanism.joints[free[i]].range.value_or(Range{-pi, pi});
      q[i] = range.lower + (range.upper - range.lower) * unit(state);
    }
    const std::vector<double> all = coordinates(mechanism, free, q);
    const Eigen::MatrixXd j = jacobian(mechanism, path, all);
    const auto whole = decomposed(j);
    result.dimensions = std::max(result.dimensions, static_cast<int>(whole.rank()));
    result.translates = result.translates || decomposed(j.topRows(3)).rank() == 3;
    Eigen::VectorXd roll = Eigen::VectorXd::Zero(6);
    roll.tail<3>() = begin_from_end(mechanism, path, all).linear() * approach;
    result.rolls = result.rolls || (j * whole.solve(roll) - roll).norm() < 1e-4;  // ten times what rounded rotations leave
  }
  return result;
}

}  // namespace lf::urdf
