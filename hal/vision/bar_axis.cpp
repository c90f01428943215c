#include "hal/vision/bar_axis.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lf::vision {
namespace {

struct Spread {
  double xx = 0, xy = 0, yy = 0;
};

double across(const BarAxis& bar, const Vec2& p) {
  const Vec2 d = p - bar.centre;
  return bar.direction.x() * d.y() - bar.direction.y() * d.x();
}

BarAxis from_moments(std::span<const Vec2> points) {
  BarAxis bar;
  for (const Vec2& p : points) bar.centre += p;
  bar.centre /= static_cast<double>(points.size());
  Spread spread;
  for (const Vec2& p : points) {
    const Vec2 d = p - bar.centre;
    spread.xx += d.x() * d.x();
    spread.xy += d.x() * d.y();
    spread.yy += d.y() * d.y();
  }
  const double angle_rad = 0.5 * std::atan2(2 * spread.xy, spread.xx - spread.yy);
  bar.direction = Vec2(std::cos(angle_rad), std::sin(angle_rad));
  return bar;
}

// A bar's points lie within 2 of the median distance to its axis when spread evenly over its width; half as much again for their noise.
std::vector<Vec2> on_the_bar(std::span<const Vec2> points, const BarAxis& bar) {
  std::vector<double> distances;
  for (const Vec2& p : points) distances.push_back(std::abs(across(bar, p)));
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double limit_m = 3 * *middle;
  std::vector<Vec2> kept;
  std::copy_if(points.begin(), points.end(), std::back_inserter(kept), [&](const Vec2& p) { return std::abs(across(bar, p)) <= limit_m; });
  return kept;
}

}  // namespace

BarAxis bar_axis(std::span<const Vec2> points) {
  if (points.empty()) return {};
  if (points.size() == 1) return {points[0], Vec2::UnitX()};
  BarAxis bar = from_moments(points);
  for (int round = 0; round < 2; ++round) {
    const std::vector<Vec2> kept = on_the_bar(points, bar);
    if (kept.size() < points.size() / 2 || kept.size() < 2) break;
    bar = from_moments(kept);
  }
  return bar;
}

}  // namespace lf::vision
