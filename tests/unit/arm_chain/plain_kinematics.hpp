// Forward kinematics as URDF's text has it, in plain arrays: no library, nothing of the project's but its numbers.
//
// A joint's frame stands in its parent's at xyz, turned by R = Rz(yaw) Ry(pitch) Rx(roll); its child is turned about, or moved along, the axis
// (wiki.ros.org/urdf/XML/joint). Turns are Rodrigues' formula, written out.
#pragma once

#include <array>
#include <cmath>

#include "tests/unit/arm_chain/real_arms.hpp"

namespace lf::chain {

class PlainKinematics {
 public:
  explicit PlainKinematics(const RealArm& arm) : arm_(arm) {}

  // True when the posture does what the task asks, to the task's tolerances or `least`, m and rad.
  bool fulfils(const IkTask& task, const JointValues& q, double least = 1e-6) const {
    const Matrix at = tool(q);
    const auto wanted = [&](int r, int c) { return task.base_from_tool.matrix()(r, c); };
    double square = 0;
    for (int r = 0; r < 3; ++r) square += (at[r][3] - wanted(r, 3)) * (at[r][3] - wanted(r, 3));
    if (!(std::sqrt(square) <= std::max(least, task.position_tolerance_m))) return false;
    const Column z = column(at, axis_of(arm_.approach)), x = column(at, axis_of(arm_.opening)), y = cross(z, x);
    const Column want_z{wanted(0, 2), wanted(1, 2), wanted(2, 2)}, bar{wanted(0, 1), wanted(1, 1), wanted(2, 1)};
    if (task.axis && !(angle(z, want_z) <= std::max(least, task.axis_tolerance_rad))) return false;
    // About the approach axis, from the tool's y to the bar.
    const double roll = std::abs(std::atan2(dot(x, bar), dot(y, bar)));
    return !task.roll || roll <= std::max(least, task.roll_tolerance_rad);
  }

  // The pose that the solvers call base_from_tool: z approaches, x opens.
  Pose pose(const JointValues& q) const {
    const Matrix at = tool(q);
    const Column z = column(at, axis_of(arm_.approach)), x = column(at, axis_of(arm_.opening)), y = cross(z, x);
    Pose out = Pose::Identity();
    for (int r = 0; r < 3; ++r) {
      out.matrix()(r, 0) = x[r], out.matrix()(r, 1) = y[r], out.matrix()(r, 2) = z[r];
      out.matrix()(r, 3) = at[r][3];
    }
    return out;
  }

 private:
  using Matrix = std::array<std::array<double, 4>, 4>;
  using Column = std::array<double, 3>;

  static double dot(const Column& a, const Column& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static Column cross(const Column& a, const Column& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static double angle(const Column& a, const Column& b) {
    const Column c = cross(a, b);
    return std::atan2(std::sqrt(dot(c, c)), dot(a, b));
  }
  static Column axis_of(FrameAxis axis) {
    Column out{};
    const auto i = static_cast<unsigned>(axis);
    out[i % 3] = i < 3 ? 1 : -1;
    return out;
  }
  // `axis` of the tool's frame, in the base's.
  static Column column(const Matrix& at, const Column& axis) {
    Column out{};
    for (unsigned r = 0; r < 3; ++r)
      for (unsigned c = 0; c < 3; ++c) out[r] += at[r][c] * axis[c];
    return out;
  }
  static Matrix product(const Matrix& a, const Matrix& b) {
    Matrix out{};
    for (unsigned r = 0; r < 4; ++r)
      for (unsigned c = 0; c < 4; ++c)
        for (unsigned k = 0; k < 4; ++k) out[r][c] += a[r][k] * b[k][c];
    return out;
  }
  static Matrix origin(const UrdfJoint& joint) {
    const double cr = std::cos(joint.rpy[0]), sr = std::sin(joint.rpy[0]), cp = std::cos(joint.rpy[1]), sp = std::sin(joint.rpy[1]),
                 cy = std::cos(joint.rpy[2]), sy = std::sin(joint.rpy[2]);
    return {{{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, joint.xyz[0]},
             {sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, joint.xyz[1]},
             {-sp, cp * sr, cp * cr, joint.xyz[2]},
             {0, 0, 0, 1}}};
  }
  static Matrix motion(const UrdfJoint& joint, double q) {
    const double x = joint.axis[0], y = joint.axis[1], z = joint.axis[2];
    if (joint.kind == UrdfJoint::Kind::prismatic) return {{{1, 0, 0, q * x}, {0, 1, 0, q * y}, {0, 0, 1, q * z}, {0, 0, 0, 1}}};
    const double c = std::cos(q), s = std::sin(q), v = 1 - c;
    return {{{c + v * x * x, v * x * y - s * z, v * x * z + s * y, 0},
             {v * x * y + s * z, c + v * y * y, v * y * z - s * x, 0},
             {v * x * z - s * y, v * y * z + s * x, c + v * z * z, 0},
             {0, 0, 0, 1}}};
  }
  // The file's own tool frame.
  Matrix tool(const JointValues& q) const {
    Matrix at{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    int next = 0;
    for (const UrdfJoint& joint : arm_.joints) {
      at = product(at, origin(joint));
      if (joint.kind != UrdfJoint::Kind::fixed) at = product(at, motion(joint, q[next++]));
    }
    return at;
  }

  RealArm arm_;
};

}  // namespace lf::chain
