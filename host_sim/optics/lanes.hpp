// Eight vectors and rotations side by side: a ray packet. Private to the renderer.
#pragma once

#include "shared/geometry/pose.hpp"
#include "shared/lanes/lanes.hpp"

namespace lf::optics {

using lf::select;

// Eight vectors. A scalar Vec3 joins in as all lanes alike.
struct Lanes3 {
  Lanes x{}, y{}, z{};

  Lanes3() = default;
  Lanes3(Lanes x_lanes, Lanes y_lanes, Lanes z_lanes) : x(x_lanes), y(y_lanes), z(z_lanes) {}
  explicit Lanes3(const Vec3& v)
      : x(all_lanes(static_cast<float>(v.x()))), y(all_lanes(static_cast<float>(v.y()))), z(all_lanes(static_cast<float>(v.z()))) {}
};

inline Lanes3 select(LaneMask mask, const Lanes3& a, const Lanes3& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Lanes3 operator*(const Lanes3& a, Lanes s) { return {a.x * s, a.y * s, a.z * s}; }
inline Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Lanes norm(const Lanes3& a) { return sqrt(dot(a, a)); }

// Matrix times vectors; the matrix is stored as its columns.
struct Rotation {
  Lanes3 column_x, column_y, column_z;

  Rotation() = default;
  explicit Rotation(const Mat3& m) : column_x(m.col(0)), column_y(m.col(1)), column_z(m.col(2)) {}
  Lanes3 operator*(const Lanes3& v) const { return column_x * v.x + column_y * v.y + column_z * v.z; }
  Lanes3 transposed_times(const Lanes3& v) const { return {dot(column_x, v), dot(column_y, v), dot(column_z, v)}; }
};

}  // namespace lf::optics
