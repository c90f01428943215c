// The water's drag on a link that moves: quadratic in the speed across it. Internal to this folder.
//
// Strip theory (Morison): each shape that collides is a rod along its longest side, cut into slices; a slice of diameter d and length l that moves at v across
// its axis is held back by density / 2 * coefficient * d * l * |v| v. Along the axis there is none. A sphere has no axis.
#pragma once

#include <vector>

#include "shared/geometry/pose.hpp"
#include "shared/scene/scene.hpp"

namespace lf::world {

inline constexpr double sea_water_kg_m3 = 1025;

class LinkDrag {
 public:
  struct Wrench {
    Vec3 force_n = Vec3::Zero();
    Vec3 torque_nm = Vec3::Zero();
  };

  LinkDrag() = default;
  // `frame_from_link`: of the frame in which at() is asked.
  LinkDrag(const std::vector<scene::Shape>& shapes, const Pose& frame_from_link);

  // Force and torque at the frame's origin, which moves at `velocity_m_s` and turns at `turn_rad_s`; all in the frame.
  Wrench at(const Vec3& velocity_m_s, const Vec3& turn_rad_s, double coefficient) const;

 private:
  struct Slice {
    Vec3 place_m;
    Vec3 axis;
    double area_m2;
  };
  void cut(const Pose& frame_from_rod, double length_m, double diameter_m);

  std::vector<Slice> slices_;
};

}  // namespace lf::world
