// Where the links of a mechanism are, and how they move, for given coordinates: a second kinematics beside the core's, for tests and the fuzz target.
#pragma once

#include <span>
#include <vector>

#include "shared/urdf/mechanism.hpp"

namespace lf::urdf {

// The coordinates of all joints, in their order, from a path's free ones: what mimics follows its driver, everything else stands at its middle, or at 0 where
// it has no range. `q` has one entry for each of `free`, rad or m.
std::vector<double> coordinates(const Mechanism& mechanism, std::span<const std::size_t> free, std::span<const double> q);

// The frame of the link at the path's end in that of the link at its begin. `all` as coordinates() gives them. O(steps).
Pose begin_from_end(const Mechanism& mechanism, std::span<const Step> path, std::span<const double> all);

// The velocity of the frame at the path's end, per unit of each free joint's own velocity: rows 0 to 2 linear (m/s), 3 to 5 angular (rad/s), both in the axes
// of the frame at the path's begin. One column for each of free_joints(path). Joints that mimic one of these count for it.
Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const Mechanism& mechanism, std::span<const Step> path, std::span<const double> all);

// What a chain can do with its end, at poses drawn evenly from its ranges: the number of joints says little. A wrist whose last joint is a yaw has five
// joints and cannot turn a valve.
struct Freedom {
  std::size_t joints = 0;   // free ones
  int dimensions = 0;       // of the end's velocities, at best 6
  bool translates = false;  // the end's origin can move every way
  bool rolls = false;       // the end can turn about `approach` with its origin and that axis held
};
// `approach`: an axis of the end's frame, unit. The same answer every time: the draws are seeded.
Freedom freedom(const Mechanism& mechanism, const std::vector<Step>& path, const Vec3& approach);

}  // namespace lf::urdf
