// The arm, the panel and the vehicle a second time, without any of the core's formulas: the URDF's collision shapes as clouds of surface points, put where
// the URDF's joints put them, and the distance from a point to a solid. By brute force.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/arm/collision.hpp"
#include "shared/arm/arm_description.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::arm {

class SolidArm {
 public:
  explicit SolidArm(const ArmDescription& arm, double spacing_m) : arm_(arm) {
    for (std::size_t link = 1; link < arm5e_joint::links; ++link)
      for (const scene::Shape& shape : arm.links[link].shapes)
        if (shape.collides) add(link, shape, spacing_m);
  }

  struct Point {
    std::size_t link = 0;
    Vec3 at_m = Vec3::Zero();  // link frame
  };
  const std::vector<Point>& points() const { return points_; }

  std::array<Pose, arm5e_joint::links> base_from_links(const JointVector& q_rad, double jaw_rad) const {
    std::array<Pose, arm5e_joint::links> links;
    links[0] = Pose::Identity();
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      const ArmJoint& joint = arm_.joints[i];
      const double angle = i < arm5e_joint::of_arm ? q_rad[static_cast<Eigen::Index>(i)] : jaw_rad;
      links[i + 1] = links[i] * joint.parent_from_joint * Eigen::AngleAxisd(angle, joint.axis);
    }
    links[6] = links[4] * arm_.finger_b.parent_from_joint * Eigen::AngleAxisd(jaw_rad, arm_.finger_b.axis);
    return links;
  }

 private:
  void add(std::size_t link, const scene::Shape& shape, double spacing_m) {
    const auto put = [&](double x, double y, double z) { points_.push_back({link, shape.body_from_shape * Vec3(x, y, z)}); };
    const auto steps = [&](double length_m) { return std::max(1, static_cast<int>(std::ceil(length_m / spacing_m))); };
    if (shape.kind == scene::ShapeKind::box) {
      const Vec3 s = shape.size_m;
      const int nx = steps(s.x()), ny = steps(s.y()), nz = steps(s.z());
      for (int i = 0; i <= nx; ++i)
        for (int j = 0; j <= ny; ++j)
          for (int k = 0; k <= nz; ++k)
            if (i == 0 || i == nx || j == 0 || j == ny || k == 0 || k == nz)
              put((double(i) / nx - 0.5) * s.x(), (double(j) / ny - 0.5) * s.y(), (double(k) / nz - 0.5) * s.z());
      return;
    }
    const double radius = shape.size_m.x(), height = shape.size_m.z();
    const int around = steps(2 * pi * radius), up = steps(height), out = steps(radius);
    for (int a = 0; a < around; ++a) {
      const double c = std::cos(2 * pi * a / around), s = std::sin(2 * pi * a / around);
      for (int k = 0; k <= up; ++k) put(radius * c, radius * s, (double(k) / up - 0.5) * height);
      for (int i = 0; i < out; ++i)
        for (const double end : {-0.5, 0.5}) put(radius * i / out * c, radius * i / out * s, end * height);
    }
  }

  ArmDescription arm_;
  std::vector<Point> points_;
};

inline double to_box_m(const Vec3& p, const Vec3& centre, const Vec3& size) {
  return ((p - centre).cwiseAbs() - size / 2).cwiseMax(0.0).norm();
}

inline double to_rod_m(const Vec3& p, const VehicleShape::Rod& rod) {
  double least = 1e9;  // along its axis in steps, as nobody would do it who minds the time
  constexpr int steps = 60;
  for (int i = 0; i <= steps; ++i) least = std::min(least, (p - rod.a_m - (rod.b_m - rod.a_m) * (i / double{steps})).norm());
  return std::max(0.0, least - rod.radius_m);
}

// The panel as it was built, point by point in the panel frame; a handle as the disc it sweeps.
inline double to_panel_m(const Vec3& p, const PanelLayout& layout) {
  const Vec2 middle = (layout.plate_min_m + layout.plate_max_m) / 2, size = layout.plate_max_m - layout.plate_min_m;
  double least =
      to_box_m(p, Vec3(middle.x(), middle.y(), -layout.plate_thickness_m / 2), Vec3(size.x(), size.y(), layout.plate_thickness_m));
  for (const PanelLayout::Button& button : layout.buttons)
    least = std::min(least, to_box_m(p, Vec3(button.at_m.x(), button.at_m.y(), button.height_m / 2),
                                     Vec3(button.width_m, button.width_m, button.height_m)));
  for (const PanelLayout::Valve& valve : layout.valves) {
    const double disc = std::hypot(valve.handle_length_m, valve.handle_thickness_m) / 2;
    const double outward = std::max(0.0, (p.head<2>() - valve.at_m).norm() - disc);
    const double upward = std::max(0.0, std::abs(p.z() - valve.handle_height_m) - valve.handle_thickness_m / 2);
    least = std::min(least, std::hypot(outward, upward));
  }
  return least;
}

}  // namespace lf::arm
