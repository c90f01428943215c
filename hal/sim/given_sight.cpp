#include "hal/sim/given_sight.hpp"

#include <cmath>

#include "firmware/scan/camera_model.hpp"
#include "shared/random.hpp"

namespace lf::hal {

namespace {

// As many as a sweep of the whole panel gives.
constexpr std::uint32_t plane_points = 80000, handle_points = 4000;

// Nothing where a corner is out of the lens's view.
std::optional<MarkerObservation> marker_as_it_is(const Pose& base_from_panel, const MarkerCalibration& marker,
                                                 const CameraCalibration& camera) {
  const scan::CameraModel model(camera.intrinsics);
  const double h = marker.size_m / 2;
  const std::array<Vec3, 4> corners{Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
  MarkerObservation seen;
  seen.id = marker.id;
  seen.camera_from_tag = camera.base_from_camera.inverse() * base_from_panel * marker.panel_from_tag;
  seen.margin = 80;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::optional<Vec2> pixel = model.project(seen.camera_from_tag * corners[i]);
    if (!pixel) return std::nullopt;
    seen.corners_px[i] = *pixel;
    seen.centre_px += *pixel / 4;
  }
  return seen;
}

}  // namespace

PanelResult panel_as_it_is(const Pose& base_from_panel, std::span<const double> handles_rad, const PanelLayout& layout,
                           const MarkerCalibrations& markers, const CameraCalibration& camera) {
  PanelResult result;
  result.fit.valid = true;
  result.fit.plane.normal = base_from_panel.linear().col(2);
  result.fit.plane.offset_m = -result.fit.plane.normal.dot(base_from_panel.translation());
  result.fit.points = result.fit.inliers = plane_points;
  result.fit.rms_m = 0.0004;
  // About the worst of a dozen sweeps that were rendered, and how much of the plate they saw.
  result.fit.bend_m = 0.0003;
  result.fit.shape_shift_m = 0.0005;
  result.fit.seen_m = (layout.plate_max_m - layout.plate_min_m).minCoeff();
  result.confidence = 0.9f;

  for (const MarkerCalibration& marker : markers) {
    if (const std::optional<MarkerObservation> seen = marker_as_it_is(base_from_panel, marker, camera))
      (void)result.markers.push_back(*seen);
  }
  for (std::size_t i = 0; i < layout.valves.size(); ++i) {
    const PanelLayout::Valve& valve = layout.valves[i];
    ProudCluster handle;
    handle.centroid_m = base_from_panel * valve.handle_centre_m();
    handle.axis = base_from_panel.linear() * Vec3(-std::sin(handles_rad[i]), std::cos(handles_rad[i]), 0);
    handle.length_m = valve.handle_length_m;
    handle.width_m = valve.handle_thickness_m;
    handle.height_m = handle.height_max_m = valve.seen_height_m();
    handle.points = handle_points;
    (void)result.clusters.push_back(handle);
    PointerObservation pointer;
    if (valve.has_pointer()) {
      pointer.seen = true;
      pointer.direction = handle.axis;
      pointer.confidence = 0.8f;
    }
    (void)result.pointers.push_back(pointer);
  }
  return result;
}

void blank_picture(std::uint32_t sequence, optics::Frame& frame) {
  frame.width = 16;
  frame.height = 12;
  frame.channels = 1;
  frame.pixels.resize(static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height));
  for (std::size_t i = 0; i < frame.pixels.size(); ++i)
    frame.pixels[i] = static_cast<std::uint8_t>(splitmix64((std::uint64_t{sequence} << 16) + i) >> 60);
}

}  // namespace lf::hal
