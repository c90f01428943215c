#include "firmware/scan/plane_bend.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lf::scan {
namespace {

constexpr int cells_a_side = 8;
constexpr std::uint32_t least_in_a_cell = 30;  // a mean then scatters by a fifth of what its points do
constexpr double counted_share = 0.9;
constexpr double sigmas_a_side = 3.464;  // of an even spread: the root of 12
constexpr double grid_margin = 1.04;     // for points that do not spread quite evenly; what lies beyond counts to the border's cells

struct Cell {
  std::uint32_t points = 0;
  double sum_m = 0;
};

// Two directions in the plane.
struct Axes {
  Vec3 first, second;
  Vec2 place(const Vec3& p) const { return {first.dot(p), second.dot(p)}; }
};

// Calls visit(place in the plane, distance) for each point that is nearer than the threshold.
template <class Visit>
void visit_inliers(std::span<const CloudPoint> points, const Plane& plane, double threshold_m, const Axes& axes, const Visit& visit) {
  for (const CloudPoint& point : points) {
    if (!std::isfinite(point.p_m.x()) || !std::isfinite(point.p_m.y()) || !std::isfinite(point.p_m.z())) continue;
    const Vec3 p = point.p_m.cast<double>();
    const double distance_m = plane.signed_distance_m(p);
    if (std::abs(distance_m) < threshold_m) visit(axes.place(p), distance_m);
  }
}

// How the points spread in the plane, along the directions in which they spread most and least.
struct Spread {
  std::uint32_t points = 0;
  double scatter_m2 = 0;  // of their distances
  Axes axes{};
  Vec2 centre = Vec2::Zero();   // along `axes`
  Vec2 sigma_m = Vec2::Zero();  // along `axes`, the larger first
};

Spread spread_of(std::span<const CloudPoint> points, const Plane& plane, double threshold_m) {
  const Vec3 across = plane.normal.unitOrthogonal();
  const Axes any{across, plane.normal.cross(across)};
  Spread spread;
  Vec2 origin = Vec2::Zero(), sum = Vec2::Zero(), squares = Vec2::Zero();  // about one of the points: no digits are lost
  double product = 0;
  visit_inliers(points, plane, threshold_m, any, [&](const Vec2& place, double distance_m) {
    if (spread.points++ == 0) origin = place;
    const Vec2 off = place - origin;
    sum += off;
    squares += off.cwiseAbs2();
    product += off.x() * off.y();
    spread.scatter_m2 += distance_m * distance_m;
  });
  if (spread.points == 0) return spread;
  spread.scatter_m2 /= spread.points;
  const Vec2 mean = sum / spread.points, variance = squares / spread.points - mean.cwiseAbs2();
  const double covariance = product / spread.points - mean.x() * mean.y();
  const double turn = 0.5 * std::atan2(2 * covariance, variance.x() - variance.y()), cosine = std::cos(turn), sine = std::sin(turn);
  const double middle = variance.sum() / 2, apart = std::hypot(variance.x() - variance.y(), 2 * covariance) / 2;
  spread.axes = {cosine * any.first + sine * any.second, cosine * any.second - sine * any.first};
  const Vec2 centre = origin + mean;
  spread.centre = {cosine * centre.x() + sine * centre.y(), cosine * centre.y() - sine * centre.x()};
  spread.sigma_m = Vec2(middle + apart, middle - apart).cwiseMax(0.0).cwiseSqrt();
  return spread;
}

std::size_t cell_of(double offset_m, double side_m) {
  if (!(side_m > 0)) return 0;
  return static_cast<std::size_t>(std::clamp((0.5 + offset_m / side_m) * cells_a_side, 0.0, cells_a_side - 0.5));
}

}  // namespace

PlaneBend plane_bend(std::span<const CloudPoint> points, const Plane& plane, double threshold_m) {
  const Spread spread = spread_of(points, plane, threshold_m);
  if (spread.points == 0) return {};
  const Vec2 grid_m = grid_margin * sigmas_a_side * spread.sigma_m;
  std::array<Cell, std::size_t{cells_a_side} * cells_a_side> cells{};
  visit_inliers(points, plane, threshold_m, spread.axes, [&](const Vec2& place, double distance_m) {
    const Vec2 off = place - spread.centre;
    Cell& cell = cells[(cell_of(off.x(), grid_m.x()) * cells_a_side) + cell_of(off.y(), grid_m.y())];
    ++cell.points;
    cell.sum_m += distance_m;
  });
  std::uint32_t counted = 0;
  double total = 0;
  for (const Cell& cell : cells) {
    if (cell.points < least_in_a_cell) continue;
    const double mean_m = cell.sum_m / cell.points;
    counted += cell.points;
    total += cell.points * mean_m * mean_m;
  }
  const double mean_square = counted < counted_share * spread.points ? spread.scatter_m2 : total / counted;
  return {std::sqrt(mean_square), sigmas_a_side * spread.sigma_m.y()};
}

}  // namespace lf::scan
