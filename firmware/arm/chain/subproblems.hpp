// The geometric subproblems that closed-form inverse kinematics is made of (Paden and Kahan; Elias and Wen, Mech. Mach. Theory 209, 2025).
//
// Each answers for what it was given and clamps what rounding has put out of range; the caller checks the whole posture on the chain. All axes
// are unit vectors.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "shared/geometry/pose.hpp"

namespace lf::chain {

// `v` turned by `angle_rad` about `axis`.
inline Vec3 turned(const Vec3& v, const Vec3& axis, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return c * v + s * axis.cross(v) + ((1 - c) * axis.dot(v)) * axis;
}

inline Mat3 turn(const Vec3& axis, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const Vec3 k = (1 - c) * axis;
  Mat3 r;
  r << k.x() * axis.x() + c, k.x() * axis.y() - s * axis.z(), k.x() * axis.z() + s * axis.y(),  //
      k.y() * axis.x() + s * axis.z(), k.y() * axis.y() + c, k.y() * axis.z() - s * axis.x(),   //
      k.z() * axis.x() - s * axis.y(), k.z() * axis.y() + s * axis.x(), k.z() * axis.z() + c;
  return r;
}

// The angle about `axis` that brings `from` to the side of `to`. 0 where one of them is on the axis.
inline double angle_about(const Vec3& axis, const Vec3& from, const Vec3& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to) - axis.dot(from) * axis.dot(to));
}

// Two answers; both the same where they meet.
struct TwoAngles {
  std::array<double, 2> angle_rad{};
  bool any_will_do = false;  // the angle does not matter
};

// a cos x + b sin x = d. Nothing where d is out of reach. `unit` is the size of the three below which they are nothing.
inline std::optional<TwoAngles> solve_cos_sin(double a, double b, double d, double unit) {
  constexpr double nothing = 1e-9;
  // A target on the border of reach is put beyond it by rounding: the root of what is let through here is 1e-4 rad, which polishing mends.
  constexpr double rounding = 1e-8;
  const double size = std::hypot(a, b);
  if (size < nothing * unit) {
    if (std::abs(d) > 1e-6 * unit) return std::nullopt;
    return TwoAngles{{0, 0}, true};
  }
  const double ratio = d / size;
  if (!(std::abs(ratio) <= 1 + rounding)) return std::nullopt;
  const double middle = std::atan2(b, a);
  const double half = std::acos(std::fmin(1, std::fmax(-1, ratio)));
  return TwoAngles{{middle + half, middle - half}, false};
}

// x such that normal . (w turned by -x about axis) = height.
inline std::optional<TwoAngles> solve_height(const Vec3& axis, const Vec3& w, const Vec3& normal, double height, double unit) {
  const double along = axis.dot(normal) * axis.dot(w);
  return solve_cos_sin(normal.dot(w) - along, axis.cross(normal).dot(w), height - along, unit);
}

// The two unit vectors z with first . z = a and second . z = b. Nothing where there are none; `first` and `second` are not parallel.
inline std::optional<std::array<Vec3, 2>> solve_two_cones(const Vec3& first, const Vec3& second, double a, double b) {
  constexpr double rounding = 1e-8;
  const double between = first.dot(second);
  const double square = 1 - between * between;
  const double u = (a - between * b) / square;
  const double v = (b - between * a) / square;
  const double rest = 1 - u * u - v * v - 2 * u * v * between;
  if (!(rest >= -rounding)) return std::nullopt;
  const Vec3 in_plane = u * first + v * second;
  const Vec3 out = std::sqrt(std::fmax(0, rest) / square) * first.cross(second);
  return std::array<Vec3, 2>{in_plane + out, in_plane - out};
}

}  // namespace lf::chain
