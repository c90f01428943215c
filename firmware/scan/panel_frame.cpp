#include "firmware/scan/panel_frame.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/scan/camera_model.hpp"

namespace lf::scan {
namespace {

constexpr double min_view_sine = 0.1;  // of the angle between ray and plane: 6 degrees, where 0.1 px is 20 mm

// A handle's median height lies between that of its bar alone and of bar and stem together.
constexpr double handle_height_low = 0.70, handle_height_high = 1.25;
// A bar seen end-on is shortened, one with a finger beside it lengthened.
constexpr double handle_length_low = 0.5, handle_length_high = 1.4;
constexpr std::uint32_t handle_points_min = 20;  // two stripes of ten points
constexpr double button_height_low = 0.5, button_height_high = 1.5;

bool finite(const PlaneFit& fit) { return fit.plane.normal.allFinite() && std::isfinite(fit.plane.offset_m); }

bool finite(const MarkerObservation& marker) {
  return marker.camera_from_tag.matrix().allFinite() &&
         std::all_of(marker.corners_px.begin(), marker.corners_px.end(), [](const Vec2& corner) { return corner.allFinite(); });
}

// The point of a plane (base frame) that a pixel sees.
std::optional<Vec3> on_plane(const Vec2& pixel, const CameraModel& camera, const Pose& base_from_camera, const Plane& plane) {
  const std::optional<Vec3> camera_ray = camera.ray(pixel);
  if (!camera_ray) return std::nullopt;
  const Vec3 ray = base_from_camera.linear() * *camera_ray;
  const double sine = plane.normal.dot(ray);
  if (!(std::abs(sine) > min_view_sine)) return std::nullopt;
  const double range_m = -plane.signed_distance_m(base_from_camera.translation()) / sine;
  if (!(range_m > 0)) return std::nullopt;
  return Vec3(base_from_camera.translation() + range_m * ray);
}

using Corners = std::array<Vec3, 4>;  // base frame; from the bottom left counter-clockwise

struct Square {
  Pose base_from_tag = Pose::Identity();
  double side_m = 0;
  double rms_m = 0;  // of the corners about the square
};

// The square in the plane that fits the corners best: each of the sides tells the direction of the tag's x axis.
Square fit_square(const Corners& c, const Vec3& normal) {
  Square square;
  const Vec3 right = (c[1] - c[0]) + (c[2] - c[3]), up = (c[3] - c[0]) + (c[2] - c[1]);
  const Vec3 x = right + up.cross(normal);  // four sides' length
  square.side_m = 0.25 * x.norm();
  square.base_from_tag.linear().col(0) = x.normalized();
  square.base_from_tag.linear().col(1) = normal.cross(x.normalized());
  square.base_from_tag.linear().col(2) = normal;
  square.base_from_tag.translation() = 0.25 * (c[0] + c[1] + c[2] + c[3]);
  const double h = 0.5 * square.side_m;
  const Corners ideal{Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += (square.base_from_tag * ideal[i] - c[i]).squaredNorm();
  square.rms_m = std::sqrt(sum / 4);
  return square;
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// One marker on the scanned plane.
struct OnPlane {
  PanelFrame frame;  // by this marker alone
  Corners corners{};
  const MarkerCalibration* surveyed = nullptr;
};

OnPlane put_on_plane(const PanelResult& result, std::size_t which, const MarkerCalibration& marker, const CameraCalibration& camera,
                     const PanelFrameConfig& config) {
  const MarkerObservation& seen = result.markers[which];
  OnPlane found;
  found.surveyed = &marker;
  PanelFrame& frame = found.frame;
  frame.marker = which;
  frame.surveyed_size_m = marker.size_m;
  // The marker lies on its plate, so much before the panel.
  Plane tag_plane = result.fit.plane;
  tag_plane.offset_m -= marker.panel_from_tag.translation().z();
  const CameraModel model(camera.intrinsics);
  for (std::size_t i = 0; i < found.corners.size(); ++i) {
    const std::optional<Vec3> corner = on_plane(seen.corners_px[i], model, camera.base_from_camera, tag_plane);
    if (!corner) return found;
    found.corners[i] = *corner;
  }
  const Square square = fit_square(found.corners, tag_plane.normal);
  const Pose pnp = camera.base_from_camera * seen.camera_from_tag;
  frame.base_from_panel = square.base_from_tag * marker.panel_from_tag.inverse();
  frame.marker_size_m = square.side_m;
  frame.marker_rms_m = square.rms_m;
  frame.centre_disagreement_m = (pnp.translation() - square.base_from_tag.translation()).norm();
  frame.normal_disagreement_rad = angle_between(pnp.linear().col(2), tag_plane.normal);
  const double largest_m = config.max_size_error * marker.size_m;
  if (!(std::abs(square.side_m - marker.size_m) <= largest_m && square.rms_m <= 0.5 * largest_m))
    frame.outcome = PanelFrameOutcome::bad_marker;
  else if (!(frame.centre_disagreement_m <= config.max_disagreement_m && frame.normal_disagreement_rad <= config.max_tilt_rad))
    frame.outcome = PanelFrameOutcome::poses_disagree;
  else
    frame.outcome = PanelFrameOutcome::ok;
  return found;
}

using Found = StaticVector<OnPlane, PanelLayout::max_markers>;

Vec3 surveyed_corner(const MarkerCalibration& marker, std::size_t i) {
  const double h = 0.5 * marker.size_m;
  const std::array<Vec3, 4> corners{Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
  return marker.panel_from_tag * corners[i];
}

// The turn about the plane's normal and the shift that bring the surveyed corners of all markers nearest to the measured ones: least squares, in closed form.
Pose fit_all(const Found& found, const Vec3& normal) {
  const Vec3 right = found[0].frame.base_from_panel.linear().col(0), up = normal.cross(right);
  const double count = 4.0 * static_cast<double>(found.size());
  Vec3 surveyed_mean = Vec3::Zero(), measured_mean = Vec3::Zero();
  for (const OnPlane& one : found) {
    for (std::size_t i = 0; i < 4; ++i) {
      surveyed_mean += surveyed_corner(*one.surveyed, i) / count;
      measured_mean += one.corners[i] / count;
    }
  }
  double along = 0, across = 0;
  for (const OnPlane& one : found) {
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 s = surveyed_corner(*one.surveyed, i) - surveyed_mean, m = one.corners[i] - measured_mean;
      const Vec2 on_plane(right.dot(m), up.dot(m));
      along += s.x() * on_plane.x() + s.y() * on_plane.y();
      across += s.x() * on_plane.y() - s.y() * on_plane.x();
    }
  }
  const double turn_rad = std::atan2(across, along);
  Pose base_from_panel = Pose::Identity();
  base_from_panel.linear().col(0) = std::cos(turn_rad) * right + std::sin(turn_rad) * up;
  base_from_panel.linear().col(1) = normal.cross(base_from_panel.linear().col(0));
  base_from_panel.linear().col(2) = normal;
  base_from_panel.translation() = measured_mean - base_from_panel.linear() * surveyed_mean;
  return base_from_panel;
}

double shift_m(const OnPlane& one, const Pose& base_from_panel) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < 4; ++i) sum += one.corners[i] - base_from_panel * surveyed_corner(*one.surveyed, i);
  return sum.norm() / 4;
}

// How well markers agree: the worst of their shifts and their common turn over what is allowed, up to 1. A stray marker draws the fit after it: of n it stands only
// (n - 1) / n of its error off. An error across the line between two markers turns the fit, and no shift is left: then the markers' own edges are turned against it.
double spread_of(const Found& found, const Vec3& normal, const PanelFrameConfig& config) {
  const Pose together = fit_all(found, normal);
  const auto n = static_cast<double>(found.size());
  const double allowed_m = config.max_marker_shift_m * (n - 1) / n;
  double worst = 0;
  double turn_rad = 0;  // of all edges against the fit, mean
  for (const OnPlane& one : found) {
    worst = std::max(worst, shift_m(one, together) / allowed_m);
    const Vec3& edge = one.frame.base_from_panel.linear().col(0);
    turn_rad += std::atan2(together.linear().col(0).cross(edge).dot(normal), together.linear().col(0).dot(edge)) / n;
  }
  return std::max(worst, std::abs(turn_rad) / config.max_marker_turn_rad);
}

Found without(const Found& found, std::size_t which) {
  Found others;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i != which) (void)others.push_back(found[i]);
  }
  return others;
}

// Leaves out, one by one, the marker without which the others agree best. False where two are left that do not agree: which of them strays nobody can tell.
bool leave_out_strays(Found& found, const Vec3& normal, const PanelFrameConfig& config) {
  while (found.size() > 1 && spread_of(found, normal, config) > 1) {
    if (found.size() == 2) return false;
    std::size_t stray = 0;
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double left = spread_of(without(found, i), normal, config);
      if (left >= least) continue;
      least = left;
      stray = i;
    }
    found = without(found, stray);
  }
  return true;
}

}  // namespace

PanelFrame find_panel_frame(const PanelResult& result, const MarkerCalibrations& markers, const CameraCalibration& camera,
                            const PanelFrameConfig& config) {
  PanelFrame frame;
  if (!finite(result.fit)) {
    frame.outcome = PanelFrameOutcome::not_a_number;
    return frame;
  }
  if (!result.fit.valid) return frame;
  frame.outcome = PanelFrameOutcome::no_marker;
  Found found;
  for (const MarkerCalibration& marker : markers) {
    for (std::size_t i = 0; i < result.markers.size(); ++i) {
      if (result.markers[i].id != marker.id) continue;
      if (!finite(result.markers[i])) {
        if (frame.surveyed_size_m == 0) frame.outcome = PanelFrameOutcome::not_a_number;
        break;
      }
      const OnPlane one = put_on_plane(result, i, marker, camera, config);
      if (one.frame.outcome == PanelFrameOutcome::ok) (void)found.push_back(one);
      if (frame.surveyed_size_m == 0) frame = one.frame;
      break;  // a marker that is seen twice counts once
    }
  }
  if (found.empty()) return frame;
  frame = found[0].frame;
  frame.markers = 1;
  if (found.size() == 1) return frame;
  const Vec3& normal = result.fit.plane.normal;
  if (!leave_out_strays(found, normal, config)) {
    frame.outcome = PanelFrameOutcome::bad_marker;
    return frame;
  }
  frame = found[0].frame;
  frame.markers = found.size();
  if (found.size() > 1) frame.base_from_panel = fit_all(found, normal);
  return frame;
}

HandleObservation find_handle(const PanelResult& result, const PanelFrame& frame, const PanelLayout::Valve& valve,
                              const PanelFrameConfig& config) {
  HandleObservation best;
  if (frame.outcome != PanelFrameOutcome::ok) return best;
  const Pose panel_from_base = frame.base_from_panel.inverse();
  std::uint32_t most = 0;
  for (const ProudCluster& cluster : result.clusters) {
    const Vec3 centre = panel_from_base * cluster.centroid_m;
    const Vec3 axis = panel_from_base.linear() * cluster.axis;
    const bool finite_cluster = centre.allFinite() && axis.allFinite() && std::isfinite(cluster.width_m);
    const bool high =
        cluster.height_m >= handle_height_low * valve.seen_height_m() && cluster.height_m <= handle_height_high * valve.seen_height_m();
    const bool long_enough = cluster.length_m >= handle_length_low * valve.handle_length_m &&
                             cluster.length_m <= handle_length_high * valve.handle_length_m && cluster.length_m > cluster.width_m;
    const bool on_axis = (centre.head<2>() - valve.at_m).norm() <= config.max_handle_offset_m;
    if (!finite_cluster || !high || !long_enough || !on_axis || cluster.points < handle_points_min || cluster.points <= most) continue;
    most = cluster.points;
    best.found = true;
    best.angle_rad = wrap(std::atan2(-axis.x(), axis.y()), pi / 2);
    // Twice the standard error of a line through points that spread evenly over the bar: its points come in stripes, not alone.
    best.sigma_rad = 2 * cluster.width_m / (cluster.length_m * std::sqrt(static_cast<double>(cluster.points)));
    best.centre_m = centre;
    best.length_m = cluster.length_m;
    best.height_m = cluster.height_m;
  }
  return best;
}

ButtonObservation find_button(const PanelResult& result, const PanelFrame& frame, const PanelLayout::Button& button) {
  ButtonObservation found;
  if (frame.outcome != PanelFrameOutcome::ok) return found;
  const Pose panel_from_base = frame.base_from_panel.inverse();
  double nearest_m = button.width_m / 2;
  for (const ProudCluster& cluster : result.clusters) {
    const Vec3 centre = panel_from_base * cluster.centroid_m;
    const double off_m = (centre.head<2>() - button.at_m).norm();
    const bool high = cluster.height_m >= button_height_low * button.height_m && cluster.height_m <= button_height_high * button.height_m;
    if (!high || !(off_m < nearest_m)) continue;
    nearest_m = off_m;
    found.found = true;
    found.centre_m = Vec3(centre.x(), centre.y(), cluster.height_m);
  }
  return found;
}

}  // namespace lf::scan
