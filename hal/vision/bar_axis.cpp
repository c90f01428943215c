#include "hal/vision/bar_axis.hpp"

#include <cmath>

namespace lf::vision {

BarAxis bar_axis(std::span<const Vec2> points) {
  BarAxis bar;
  if (points.empty()) return bar;
  for (const Vec2& p : points) bar.centre += p;
  bar.centre /= static_cast<double>(points.size());
  double xx = 0, xy = 0, yy = 0;
  for (const Vec2& p : points) {
    const Vec2 d = p - bar.centre;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  const double angle_rad = 0.5 * std::atan2(2 * xy, xx - yy);
  bar.direction = Vec2(std::cos(angle_rad), std::sin(angle_rad));
  return bar;
}

}  // namespace lf::vision
