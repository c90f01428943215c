#include "firmware/scan/valve_frame.hpp"

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

bool finite(const PanelResult& r) {
  bool good = r.fit.plane.normal.allFinite() && std::isfinite(r.fit.plane.offset_m) && r.marker.camera_from_tag.matrix().allFinite();
  for (const Vec2& corner : r.marker.corners_px) good &= corner.allFinite();
  return good;
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

}  // namespace

ValveFrame find_valve_frame(const PanelResult& result, const MarkerCalibration& marker, const CameraCalibration& camera,
                            const ValveFrameConfig& config) {
  ValveFrame frame;
  if (!finite(result)) {
    frame.outcome = ValveFrameOutcome::not_a_number;
    return frame;
  }
  if (!result.fit.valid) return frame;
  if (!result.marker.found || result.marker.id != marker.id) {
    frame.outcome = ValveFrameOutcome::no_marker;
    return frame;
  }
  // The marker lies on its plate, so much before the panel.
  Plane tag_plane = result.fit.plane;
  tag_plane.offset_m -= marker.panel_from_tag.translation().z();
  const CameraModel model(camera.intrinsics);
  Corners corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::optional<Vec3> corner = on_plane(result.marker.corners_px[i], model, camera.base_from_camera, tag_plane);
    if (!corner) return frame;
    corners[i] = *corner;
  }
  const Square square = fit_square(corners, tag_plane.normal);
  const Pose pnp = camera.base_from_camera * result.marker.camera_from_tag;
  frame.base_from_panel = square.base_from_tag * marker.panel_from_tag.inverse();
  frame.marker_size_m = square.side_m;
  frame.marker_rms_m = square.rms_m;
  frame.centre_disagreement_m = (pnp.translation() - square.base_from_tag.translation()).norm();
  frame.normal_disagreement_rad = angle_between(pnp.linear().col(2), tag_plane.normal);
  const double largest_m = config.max_size_error * marker.size_m;
  if (!(std::abs(square.side_m - marker.size_m) <= largest_m && square.rms_m <= 0.5 * largest_m))
    frame.outcome = ValveFrameOutcome::bad_marker;
  else if (!(frame.centre_disagreement_m <= config.max_disagreement_m && frame.normal_disagreement_rad <= config.max_tilt_rad))
    frame.outcome = ValveFrameOutcome::poses_disagree;
  else
    frame.outcome = ValveFrameOutcome::ok;
  return frame;
}

HandleObservation find_handle(const PanelResult& result, const ValveFrame& frame, const PanelLayout& layout,
                              const ValveFrameConfig& config) {
  HandleObservation best;
  if (frame.outcome != ValveFrameOutcome::ok) return best;
  const Pose panel_from_base = frame.base_from_panel.inverse();
  std::uint32_t most = 0;
  for (const ProudCluster& cluster : result.clusters) {
    const Vec3 centre = panel_from_base * cluster.centroid_m;
    const Vec3 axis = panel_from_base.linear() * cluster.axis;
    const bool finite_cluster = centre.allFinite() && axis.allFinite() && std::isfinite(cluster.width_m);
    const bool high =
        cluster.height_m >= handle_height_low * layout.handle_height_m && cluster.height_m <= handle_height_high * layout.handle_height_m;
    const bool long_enough = cluster.length_m >= handle_length_low * layout.handle_length_m &&
                             cluster.length_m <= handle_length_high * layout.handle_length_m && cluster.length_m > cluster.width_m;
    const bool on_axis = centre.head<2>().norm() <= config.max_handle_offset_m;
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

std::array<ButtonObservation, PanelLayout::button_count> find_buttons(const PanelResult& result, const ValveFrame& frame,
                                                                      const PanelLayout& layout) {
  std::array<ButtonObservation, PanelLayout::button_count> buttons;
  if (frame.outcome != ValveFrameOutcome::ok) return buttons;
  const Pose panel_from_base = frame.base_from_panel.inverse();
  for (std::size_t i = 0; i < buttons.size(); ++i) {
    double nearest_m = layout.button_width_m / 2;
    for (const ProudCluster& cluster : result.clusters) {
      const Vec3 centre = panel_from_base * cluster.centroid_m;
      const double off_m = (centre.head<2>() - layout.buttons_m[i]).norm();
      const bool high =
          cluster.height_m >= button_height_low * layout.button_height_m && cluster.height_m <= button_height_high * layout.button_height_m;
      if (!high || !(off_m < nearest_m)) continue;
      nearest_m = off_m;
      buttons[i].found = true;
      buttons[i].centre_m = Vec3(centre.x(), centre.y(), cluster.height_m);
    }
  }
  return buttons;
}

}  // namespace lf::scan
