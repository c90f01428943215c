#include "firmware/arm/chain/ik_task.hpp"

#include <algorithm>
#include <cmath>

namespace lf::chain {
namespace {

// A solver aims at this share of a tolerance, so that what it reaches is surely inside.
constexpr double aim = 0.9;

// Angle times axis of a rotation, |angle| <= pi.
Vec3 rotation_vector(const Mat3& r) {
  const Vec3 v(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  const double sin2 = v.norm();  // twice the sine
  const double cos2 = r.trace() - 1;
  if (cos2 > -1.98) return v * (sin2 > 1e-9 ? std::atan2(sin2, cos2) / sin2 : 0.5);
  // Near half a turn the sine says nothing of the axis.
  const Eigen::Quaterniond q(r);
  const double half_sin = q.vec().norm();
  return q.vec() * (2 * std::atan2(half_sin, std::abs(q.w())) * (q.w() < 0 ? -1 : 1) / half_sin);
}

// Angle from a to b, times the direction to turn about; both unit.
Vec3 turn_between(const Vec3& a, const Vec3& b) {
  const Vec3 cross = a.cross(b);
  const double s = cross.norm();
  const double c = a.dot(b);
  if (s > 1e-9) return cross * (std::atan2(s, c) / s);
  return c > 0 ? cross : Vec3(a.unitOrthogonal() * pi);
}

// The roll that is missing until tool x is square to `bar` and tool y on its side, and how it falls per rad/s of angular velocity.
// Where the bar is on the approach axis there is no roll: 0, and nothing changes it.
double missing_roll(const Mat3& tool, const Vec3& bar, Vec3& from_angular) {
  const double x = tool.col(0).dot(bar);
  const double y = tool.col(1).dot(bar);
  const double square = x * x + y * y;
  if (square < 1e-12) {
    from_angular.setZero();
    return pi;
  }
  from_angular = (y * tool.col(0) - x * tool.col(1)).cross(bar) / square;
  return -std::atan2(x, y);
}

// A tolerance up to this, in rad or shares of the arm's length, frees no joint to speak of: it only lets the solver stop sooner.
constexpr double small = 1e-3;

// Takes a larger tolerance off an error vector: what is left to remove, and the share of the velocity that removes it.
// `from` is the rows' map before; it is multiplied in place.
template <class Vector, class Map>
void take_off(double tolerance, double unit, Vector&& error, Map&& from) {
  if (tolerance <= small * unit) return;
  const double size = error.norm();
  const double aimed = aim * tolerance;
  if (size <= aimed) {
    error.setZero();
    from.setZero();
    return;
  }
  const double share = aimed / size;
  const auto direction = (error / size).eval();
  from = ((1 - share) * from + share * direction * (direction.transpose() * from)).eval();
  error *= 1 - share;
}

bool within(double error, double tolerance, double least) { return error <= std::max(tolerance, least); }

Vec3 column(const Mat3& r, FrameAxis axis) {
  const auto i = static_cast<int>(axis);
  return i < 3 ? Vec3(r.col(i)) : Vec3(-r.col(i - 3));
}

// A whole rotation is one vector, along which descents find their way best. Up to `small` its parts are tilt and roll to one part in a million.
bool takes_apart(const IkTask& task) {
  return !(task.axis && task.roll) || task.axis_tolerance_rad > small || task.roll_tolerance_rad > small;
}

}  // namespace

bool IkTask::valid() const {
  const Mat3 r = base_from_tool.linear();
  return base_from_tool.matrix().allFinite() && (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
         r.determinant() > 0 && base_from_tool.translation().norm() < 1e6 && position_tolerance_m >= 0 && axis_tolerance_rad >= 0 &&
         roll_tolerance_rad >= 0;
}

TaskError task_error(const IkTask& task, const Mat3& tool, const Vec3& tool_m) {
  TaskError error;
  const Mat3 wanted = task.base_from_tool.linear();
  error.position_m = (task.base_from_tool.translation() - tool_m).norm();
  if (!takes_apart(task)) {
    const Vec3 turn = tool.transpose() * rotation_vector(wanted * tool.transpose());
    error.axis_rad = turn.head<2>().norm();
    error.roll_rad = std::abs(turn.z());
    error.orientation_rad = turn.norm();
    return error;
  }
  Vec3 unused;
  if (task.axis) error.axis_rad = turn_between(tool.col(2), wanted.col(2)).norm();
  if (task.roll) error.roll_rad = std::abs(missing_roll(tool, wanted.col(1), unused));
  error.orientation_rad = std::max(error.axis_rad, error.roll_rad);
  return error;
}

bool met(const IkTask& task, const TaskError& error, double length_m) {
  return within(error.position_m, task.position_tolerance_m, exact * length_m) && within(error.axis_rad, task.axis_tolerance_rad, exact) &&
         within(error.roll_rad, task.roll_tolerance_rad, exact);
}

void residual(const IkTask& task, const ChainState& state, double length_m, double position_weight, TaskResidual& out) {
  const Mat3 wanted = task.base_from_tool.linear();
  Vec3 position = task.base_from_tool.translation() - state.tool_m;
  const double missing_m = position.norm();
  Mat3 from_linear = Mat3::Identity();
  take_off(task.position_tolerance_m, length_m, position, from_linear);
  const double scale = position_weight / length_m;
  out.value.head<3>() = scale * position;
  out.from_linear = scale * from_linear;
  out.is_met = within(missing_m, task.position_tolerance_m, exact * length_m);

  auto turn = out.value.tail<3>();
  if (!takes_apart(task)) {
    const Vec3 missing = rotation_vector(wanted * state.tool.transpose());
    turn = state.tool.transpose() * missing;
    out.from_angular = state.tool.transpose();
    out.is_met = out.is_met && within(turn.head<2>().norm(), task.axis_tolerance_rad, exact) &&
                 within(std::abs(turn[2]), task.roll_tolerance_rad, exact);
    return;
  }
  turn.setZero();
  out.from_angular.setZero();
  if (task.axis) {
    const Vec3 tilt = turn_between(state.tool.col(2), wanted.col(2));
    turn.head<2>() = state.tool.leftCols<2>().transpose() * tilt;
    out.from_angular.topRows<2>() = state.tool.leftCols<2>().transpose();
    out.is_met = out.is_met && within(turn.head<2>().norm(), task.axis_tolerance_rad, exact);
    take_off(task.axis_tolerance_rad, 1, turn.head<2>(), out.from_angular.topRows<2>());
  }
  if (task.roll) {
    Vec3 from_angular;
    turn[2] = missing_roll(state.tool, wanted.col(1), from_angular);
    out.from_angular.row(2) = from_angular.transpose();
    out.is_met = out.is_met && within(std::abs(turn[2]), task.roll_tolerance_rad, exact);
    take_off(task.roll_tolerance_rad, 1, turn.tail<1>(), out.from_angular.bottomRows<1>());
  }
}

std::optional<Pose> tool_with_axes(const Pose& tool, FrameAxis approach, FrameAxis opening) {
  const Vec3 z = column(tool.linear(), approach);
  const Vec3 x = column(tool.linear(), opening);
  if (std::abs(z.dot(x)) > 0.5) return std::nullopt;
  Pose pose = tool;
  pose.linear() << x, z.cross(x), z;
  return pose;
}

}  // namespace lf::chain
