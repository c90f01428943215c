#include "firmware/scan/plane_bend.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lf::scan {
namespace {

constexpr int cells_a_side = 8;
constexpr std::uint32_t least_in_a_cell = 30;
constexpr double half_side_sigmas = 1.8;  // of an even spread, 1.73 reach to its ends

struct Cell {
  std::uint32_t points = 0;
  double sum_m = 0;
};

// Calls visit(place in the plane, distance) for each point that is nearer than the threshold.
template <class Visit>
void visit_inliers(std::span<const CloudPoint> points, const Plane& plane, double threshold_m, const Visit& visit) {
  const Vec3 across = plane.normal.unitOrthogonal(), along = plane.normal.cross(across);
  for (const CloudPoint& point : points) {
    if (!std::isfinite(point.p_m.x()) || !std::isfinite(point.p_m.y()) || !std::isfinite(point.p_m.z())) continue;
    const Vec3 p = point.p_m.cast<double>();
    const double distance_m = plane.signed_distance_m(p);
    if (std::abs(distance_m) < threshold_m) visit(Vec2(across.dot(p), along.dot(p)), distance_m);
  }
}

int cell_of(double offset_m, double half_side_m) {
  if (!(half_side_m > 0)) return 0;
  const double share = 0.5 + 0.5 * offset_m / half_side_m;
  return static_cast<int>(std::clamp(share * cells_a_side, 0.0, cells_a_side - 0.5));
}

}  // namespace

double plane_bend_m(std::span<const CloudPoint> points, const Plane& plane, double threshold_m) {
  std::uint32_t inliers = 0;
  Vec2 sum = Vec2::Zero(), squares = Vec2::Zero();
  Vec2 origin = Vec2::Zero();  // one of the points: squares about it lose no digits
  double scatter_m2 = 0;
  visit_inliers(points, plane, threshold_m, [&](const Vec2& place, double distance_m) {
    if (inliers++ == 0) origin = place;
    sum += place - origin;
    squares += (place - origin).cwiseAbs2();
    scatter_m2 += distance_m * distance_m;
  });
  if (inliers == 0) return 0;
  const Vec2 mean = sum / inliers;
  const Vec2 half_side_m = half_side_sigmas * (squares / inliers - mean.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();

  std::array<Cell, cells_a_side * cells_a_side> cells{};
  visit_inliers(points, plane, threshold_m, [&](const Vec2& place, double distance_m) {
    const Vec2 offset = place - origin - mean;
    Cell& cell = cells[static_cast<std::size_t>((cell_of(offset.x(), half_side_m.x()) * cells_a_side) + cell_of(offset.y(), half_side_m.y()))];
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
  if (2 * counted < inliers) return std::sqrt(scatter_m2 / inliers);
  return std::sqrt(total / counted);
}

}  // namespace lf::scan
