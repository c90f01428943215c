#include "firmware/arm/chain/closed_forms.hpp"

#include <cmath>

#include "firmware/arm/chain/subproblems.hpp"

namespace lf::chain {
namespace {

constexpr double on_axis = 1e-9;  // sine below which a direction is on an axis

// One target on its way through the arm.
struct Solver {
  const AxisGeometry& g;
  const JointValues& seed;
  Postures& out;
  Mat3 turn_g = Mat3::Identity();  // G's rotation
  Vec3 target_m = Vec3::Zero();
  double unit_m = 1;  // lengths far below it are nothing

  const Vec3& h() const { return g.axis[1]; }

  // G applied to a point of the arm at joint values 0.
  Vec3 moved(const Vec3& point) const { return target_m + turn_g * (point - g.tool_m); }
  // E_1^-1 applied to a point.
  Vec3 before_first(const Vec3& point, double q1) const { return g.point_m[0] + turned(point - g.point_m[0], g.axis[0], -q1); }

  // Both first angles that bring `point`, which the arm has at `at_zero`, to its height along h.
  template <class Then>
  void first_joint(const Vec3& point, const Vec3& at_zero, const Then& then) {
    const std::optional<TwoAngles> q1 = solve_height(g.axis[0], point - g.point_m[0], h(), h().dot(at_zero - g.point_m[0]), unit_m);
    if (!q1) return;
    if (q1->any_will_do) {
      out.more = true;
      then(seed[0]);
      return;
    }
    for (const double angle : q1->angle_rad) then(angle);
  }

  // Joints 2 and 3 of the triangle that brings `at_zero`, a point carried by joint 3, to `point`.
  template <class Then>
  void triangle(const Vec3& point, const Vec3& at_zero, const Then& then) {
    const auto flat = [this](const Vec3& v) { return Vec3(v - h().dot(v) * h()); };
    const Vec3 upper = flat(g.point_m[2] - g.point_m[1]);
    const Vec3 fore = flat(at_zero - g.point_m[2]);
    const Vec3 way = flat(point - g.point_m[1]);
    const double d = (way.squaredNorm() - upper.squaredNorm() - fore.squaredNorm()) / 2;
    const std::optional<TwoAngles> bend = solve_cos_sin(upper.dot(fore), upper.dot(h().cross(fore)), d, unit_m * unit_m);
    if (!bend) return;
    const bool once = bend->any_will_do;
    out.more = out.more || once;
    for (std::size_t k = 0; k < (once ? 1 : 2); ++k) {
      const double q3 = once ? seed[2] * g.sense[2] : bend->angle_rad[k];
      const Vec3 reached = upper + turned(fore, h(), q3);
      const bool folded = way.norm() < on_axis * unit_m;  // the point is on joint 2's axis: any angle
      out.more = out.more || folded;
      then(folded ? seed[1] : angle_about(h(), reached, way), q3);
    }
  }

  void push(double q1, double q2, double q3, double q4, double q5, double q6) {
    JointValues q = JointValues::Zero();
    q.head<6>() << q1, q2, g.sense[2] * q3, q4, q5, q6;
    out.push(q);
  }

  // q2, q3 and q4 for a motion E_2 E_3 E_4 that turns by `angle` about h and brings axis 4 to `point`.
  template <class Then>
  void three_parallel_joints(const Vec3& point, double angle, const Then& then) {
    triangle(point, g.point_m[3], [&](double q2, double q3) { then(q2, q3, g.sense[3] * (angle - q2 - q3)); });
  }

  // Any direction square to `axis` shows how far a turn about it goes.
  static double turn_angle(const Vec3& axis, const Mat3& r) {
    const Vec3 across = axis.unitOrthogonal();
    return angle_about(axis, across, r * across);
  }

  void spherical_wrist() {
    const Vec3 wrist = moved(g.centre_m);
    first_joint(wrist, g.centre_m, [&](double q1) {
      triangle(before_first(wrist, q1), g.centre_m, [&](double q2, double q3) {
        const Mat3 rest = (turn(g.axis[0], q1) * turn(h(), q2 + q3)).transpose() * turn_g;
        wrist_joints(rest, [&](double q4, double q5, double q6) { push(q1, q2, q3, q4, q5, q6); });
      });
    });
  }

  // R_4 R_5 R_6 = rest: joint 6's axis gives the first two.
  template <class Then>
  void wrist_joints(const Mat3& rest, const Then& then) {
    const Vec3 last = rest * g.axis[5];
    const auto cones = solve_two_cones(g.axis[3], g.axis[4], g.axis[3].dot(last), g.axis[4].dot(g.axis[5]));
    if (!cones) return;
    const bool aligned = g.axis[3].cross(last).norm() < on_axis;  // joints 4 and 6 turn about one line
    out.more = out.more || aligned;
    for (const Vec3& z : *cones) {
      const double q5 = angle_about(g.axis[4], g.axis[5], z);
      const double q4 = aligned ? seed[3] : angle_about(g.axis[3], z, last);
      then(q4, q5, turn_angle(g.axis[5], (turn(g.axis[3], q4) * turn(g.axis[4], q5)).transpose() * rest));
    }
  }

  void three_parallel() {
    const Vec3 centre = moved(g.centre_m);
    first_joint(centre, g.centre_m, [&](double q1) {
      const Mat3 after_first = turn(g.axis[0], q1).transpose() * turn_g;
      // R_5^-1 h = R_6 v, where v is h seen by the tool's side.
      const Vec3 v = after_first.transpose() * h();
      const auto cones = solve_two_cones(g.axis[4], g.axis[5], g.axis[4].dot(h()), g.axis[5].dot(v));
      if (!cones) return;
      const bool aligned = g.axis[5].cross(v).norm() < on_axis;  // joint 6 is parallel to the three
      out.more = out.more || aligned;
      for (const Vec3& z : *cones) {
        const double q5 = -angle_about(g.axis[4], h(), z);
        const double q6 = aligned ? seed[5] : angle_about(g.axis[5], v, z);
        const Mat3 wrist = turn(g.axis[4], q5) * turn(g.axis[5], q6);
        const Mat3 d = after_first * wrist.transpose();
        const Vec3 point = before_first(centre, q1) + d * (g.point_m[3] - g.centre_m);
        three_parallel_joints(point, turn_angle(h(), d), [&](double q2, double q3, double q4) { push(q1, q2, q3, q4, q5, q6); });
      }
    });
  }

  // 5R, whole pose.
  void planar_five() {
    const Vec3 point = moved(g.point_m[4]);
    first_joint(point, g.point_m[4], [&](double q1) {
      const Mat3 after_first = turn(g.axis[0], q1).transpose() * turn_g;
      const double q5 = -angle_about(g.axis[4], h(), after_first.transpose() * h());
      const Mat3 d = after_first * turn(g.axis[4], q5).transpose();
      const Vec3 fourth = before_first(point, q1) + d * (g.point_m[3] - g.point_m[4]);
      three_parallel_joints(fourth, turn_angle(h(), d), [&](double q2, double q3, double q4) { push(q1, q2, q3, q4, q5, 0); });
    });
  }

  // 4R or 5R with three parallel joints, by the tool's position and the direction that one of its axes has to have. A fifth joint stays at the seed.
  void planar_direction(const Vec3& at_zero, const Vec3& wanted, double fifth) {
    first_joint(target_m, g.tool_m, [&](double q1) {
      const double angle = angle_about(h(), at_zero, turned(wanted, g.axis[0], -q1));
      const Vec3 fourth = before_first(target_m, q1) + turned(g.point_m[3] - g.tool_m, h(), angle);
      three_parallel_joints(fourth, angle, [&](double q2, double q3, double q4) { push(q1, q2, q3, q4, fifth, 0); });
    });
  }

  // 4R with two parallel joints and a last one, whole pose.
  void planar_roll_pose() {
    const Vec3 point = moved(g.point_m[3]);
    first_joint(point, g.point_m[3], [&](double q1) {
      triangle(before_first(point, q1), g.point_m[3], [&](double q2, double q3) {
        const Mat3 rest = (turn(g.axis[0], q1) * turn(h(), q2 + q3)).transpose() * turn_g;
        push(q1, q2, q3, turn_angle(g.axis[3], rest), 0, 0);
      });
    });
  }

  // The same by the tool's position; the last joint rolls x square to `bar`, or stays at the seed.
  void planar_roll(const Vec3* bar) {
    first_joint(target_m, g.tool_m, [&](double q1) {
      triangle(before_first(target_m, q1), g.tool_m, [&](double q2, double q3) {
        double q4 = seed[3];
        if (bar != nullptr) {
          const Mat3 unrolled = turn(g.axis[0], q1) * turn(h(), q2 + q3) * g.tool;
          const double missing = -std::atan2(unrolled.col(0).dot(*bar), unrolled.col(1).dot(*bar));
          q4 = g.axis[3].dot(g.tool.col(2)) > 0 ? missing : -missing;
        }
        push(q1, q2, q3, q4, 0, 0);
      });
    });
  }
};

bool planar_has(const AxisGeometry& g, std::size_t joints, const IkTask& task) {
  if (task.axis && task.roll) return true;
  if (g.parallel == 2) return g.tool_on_last && !task.axis;
  if (!task.axis) return false;
  const bool turns_it = g.tool.col(2).cross(g.axis[1]).norm() > 1e-3;  // the parallel joints turn the approach axis
  return turns_it && (joints == 4 || g.tool_on_last);
}

}  // namespace

bool has_closed_form(const AxisGeometry& geometry, std::size_t joints, const IkTask& task) {
  switch (geometry.family) {
    case Family::numeric: return false;
    case Family::planar: return planar_has(geometry, joints, task);
    case Family::spherical_wrist:
    case Family::three_parallel: return task.axis && task.roll;
  }
  return false;
}

void closed_forms(const AxisGeometry& geometry, std::size_t joints, const IkTask& task, const JointValues& seed, Postures& out) {
  out.count = 0;
  out.more = false;
  Solver solver{geometry, seed, out};
  const Mat3 target = task.base_from_tool.linear();
  solver.turn_g = target * geometry.tool.transpose();
  solver.target_m = task.base_from_tool.translation();
  solver.unit_m = (geometry.tool_m - geometry.point_m[0]).norm() + 1e-3;
  if (geometry.family == Family::spherical_wrist) {
    solver.spherical_wrist();
  } else if (geometry.family == Family::three_parallel) {
    solver.three_parallel();
  } else if (geometry.parallel == 2) {
    const Vec3 bar = target.col(1);
    if (task.axis)
      solver.planar_roll_pose();
    else
      solver.planar_roll(task.roll ? &bar : nullptr);
  } else if (joints == 5 && task.roll) {
    solver.planar_five();
  } else {
    // The tool axis that the parallel joints turn most.
    const Eigen::Index column = !task.roll || geometry.tool.col(2).cross(geometry.axis[1]).norm() > 0.7 ? 2 : 0;
    solver.planar_direction(geometry.tool.col(column), target.col(column), joints == 5 ? seed[4] : 0);
    if (joints == 5) out.more = true;
  }
}

}  // namespace lf::chain
