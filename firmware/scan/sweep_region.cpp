#include "firmware/scan/sweep_region.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lf::scan {
namespace {

bool valid(const SweepRequest& r, const LaserCalibration& laser) {
  const std::array values{r.top_m,           r.bottom_m,         r.left_m,         r.right_m,       r.margin_m,
                          r.docking_shift_m, r.docking_turn_rad, r.line_spacing_m, r.slowest_rad_s, laser.fan_half_angle_rad};
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return false;
  for (const SweepRequest::Handle& handle : r.handles) {
    if (!handle.at_m.allFinite() || !std::isfinite(handle.radius_m) || !std::isfinite(handle.height_m)) return false;
  }
  if (!r.base_from_panel.matrix().allFinite() || !r.camera_m.allFinite() || !laser.tool_from_laser.matrix().allFinite()) return false;
  return r.top_m > r.bottom_m && r.right_m > r.left_m && r.docking_shift_m >= 0 && r.docking_turn_rad >= 0 &&
         r.stripe_period > Duration() && r.slowest_rad_s > 0;
}

}  // namespace

bool SweepRegion::set(const SweepRequest& request, const LaserCalibration& laser) {
  request_ = request;
  laser_ = laser;
  if (!valid(request, laser)) return false;
  above_ = points_to_pass(request.top_m, 1);
  below_ = points_to_pass(request.bottom_m, -1);
  return true;
}

// Left and right border at the height of `border_m`, and the edge of each handle that the region reaches: points the stripe has to pass.
SweepRegion::Points SweepRegion::points_to_pass(double border_m, double outward) const {
  const SweepRequest& r = request_;
  Points points;
  const double y = border_m + outward * r.margin_m;
  (void)points.push_back(r.base_from_panel * Vec3(r.left_m - r.margin_m, y, 0));
  (void)points.push_back(r.base_from_panel * Vec3(r.right_m + r.margin_m, y, 0));
  for (const SweepRequest::Handle& handle : r.handles) {
    const double x = handle.at_m.x(), axis_y = handle.at_m.y();
    if (r.bottom_m < axis_y + handle.radius_m && r.top_m > axis_y - handle.radius_m)
      (void)points.push_back(r.base_from_panel * Vec3(x, axis_y + outward * handle.radius_m, handle.height_m));
  }
  return points;
}

// A plane's distance is linear in shift and small turn, so the worst is the sum of the worst of each.
double SweepRegion::beyond(const LaserPlane& laser, const Points& points, double side) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) {
    const Vec3 lever = (point - request_.base_from_panel.translation()).cross(laser.normal);
    const double doubt = request_.docking_shift_m * laser.normal.lpNorm<1>() + request_.docking_turn_rad * lever.lpNorm<1>();
    least = std::min(least, side * laser.normal.dot(point - laser.origin_m) - doubt);
  }
  return least;
}

double SweepRegion::height_m(const LaserPlane& laser) const {
  const Vec3 up = request_.base_from_panel.linear().col(1);
  return (laser.origin_m - request_.base_from_panel.translation()).dot(laser.normal) / up.dot(laser.normal);
}

bool SweepRegion::fan_reaches(const LaserPlane& laser, double y_m, double aside_m) const {
  const double wide_m = std::max(std::abs(request_.left_m - aside_m), std::abs(request_.right_m - aside_m)) + request_.margin_m;
  // Half the turn: that all of shift, turn and margin fall on one corner is not asked for.
  const double nearer_m = request_.docking_shift_m + 0.5 * request_.docking_turn_rad * wide_m;
  const Vec3 middle = request_.base_from_panel * Vec3(0, y_m, nearer_m);
  const Vec3 across = request_.base_from_panel.linear().col(0);
  const Vec3 in_plane = middle - laser.normal * laser.normal.dot(middle - laser.origin_m);
  const double ahead_m = (in_plane - laser.origin_m - across * across.dot(in_plane - laser.origin_m)).norm();
  return std::atan2(wide_m + request_.docking_shift_m, ahead_m) <= laser_.fan_half_angle_rad - fan_spare_rad;
}

}  // namespace lf::scan
