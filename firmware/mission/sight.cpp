#include "firmware/mission/sight.hpp"

#include <algorithm>
#include <cmath>

namespace lf::mission {
namespace {

void hold_plane(const PlaneFit& fit, const Pose& base_from_panel, Sight& sight) {
  sight.plane_found = fit.valid && fit.plane.normal.allFinite() && std::isfinite(fit.plane.offset_m);
  if (!sight.plane_found) return;
  sight.inliers = fit.inliers;
  sight.plane_rms_m = static_cast<float>(fit.rms_m);
  const Vec3 outward = base_from_panel.linear().col(2);
  sight.plane_off_m = static_cast<float>(fit.plane.signed_distance_m(base_from_panel.translation()));
  sight.plane_tilt_rad = static_cast<float>(std::acos(std::clamp(fit.plane.normal.dot(outward), -1.0, 1.0)));
}

// As scan::find_handle takes one for a handle, wherever it stands.
bool like_handle(const ProudCluster& cluster, const PanelLayout::Valve& valve) {
  constexpr double height_low = 0.70, height_high = 1.25, length_low = 0.5, length_high = 1.4;
  return cluster.centroid_m.allFinite() && cluster.height_m >= height_low * valve.seen_height_m() &&
         cluster.height_m <= height_high * valve.seen_height_m() && cluster.length_m >= length_low * valve.handle_length_m &&
         cluster.length_m <= length_high * valve.handle_length_m;
}

void hold_handle(const PanelResult& result, const PanelLayout::Valve& valve, const Pose& base_from_panel, Sight& sight) {
  const Vec3 nominal_m = base_from_panel * valve.handle_centre_m();
  for (const ProudCluster& cluster : result.clusters) {
    if (!like_handle(cluster, valve)) continue;
    const auto off_m = static_cast<float>((cluster.centroid_m - nominal_m).norm());
    if (!sight.handle_found || off_m < sight.handle_off_m) sight.handle_off_m = off_m;
    sight.handle_found = true;
  }
}

// Of the markers, the one that is found with the largest margin; where none is, the one that is seen largest where the vehicle is docked exactly.
void hold_marker(const PanelResult& result, const PanelLayout& layout, const CameraCalibration& camera, Sight& sight) {
  constexpr double cells = 8;  // of an AprilTag 36h11, its black border included
  const Pose base_from_panel = layout.nominal_base_from_panel();
  for (const PanelLayout::Marker& marker : layout.markers) {
    const Vec3 nominal_tag_m = base_from_panel * marker.panel_from_tag().translation();
    const double ahead_m = (camera.base_from_camera.inverse() * nominal_tag_m).z();
    const auto cell_px = ahead_m > 0 ? static_cast<float>(camera.intrinsics.fx * marker.size_m / (cells * ahead_m)) : 0.0f;
    if (!sight.marker_found) sight.marker_cell_px = std::max(sight.marker_cell_px, cell_px);
    for (const MarkerObservation& seen : result.markers) {
      const Vec3 seen_m = (camera.base_from_camera * seen.camera_from_tag).translation();
      const auto margin_grey = static_cast<float>(seen.margin);
      const bool better = !sight.marker_found || margin_grey > sight.marker_margin_grey;
      if (seen.id != marker.id || !seen_m.allFinite() || !better) continue;
      sight.marker_found = true;
      sight.marker_cell_px = cell_px;
      sight.marker_margin_grey = margin_grey;
      sight.marker_off_m = static_cast<float>((seen_m - nominal_tag_m).norm());
    }
  }
}

}  // namespace

Sight sight_of(const PanelResult& result, const ScanStats& before, const ScanStats& now, const PanelLayout& layout, std::size_t valve,
               const CameraCalibration& camera) {
  const Pose base_from_panel = layout.nominal_base_from_panel();
  Sight sight;
  sight.look = result.id;
  sight.stripes = now.stripes - before.stripes;
  sight.images_missing = now.images_missing - before.images_missing;
  sight.images_refused = now.images_refused - before.images_refused;
  sight.columns_found = now.peaks - before.peaks;
  sight.columns_weak = now.peaks_weak - before.peaks_weak;
  sight.columns_saturated = now.peaks_saturated - before.peaks_saturated;
  sight.columns_misfit =
      (now.peaks_misfit - before.peaks_misfit) + (now.peaks_unfitted - before.peaks_unfitted) + (now.peaks_apart - before.peaks_apart);
  if (sight.stripes > 0) sight.stripe = now.stripe;
  sight.points = result.fit.points;
  hold_plane(result.fit, base_from_panel, sight);
  sight.still_taken = now.stills != before.stills;
  if (sight.still_taken) sight.still = now.still;
  hold_marker(result, layout, camera, sight);
  if (valve < layout.valves.size()) hold_handle(result, layout.valves[valve], base_from_panel, sight);
  sight.proud_clusters = static_cast<std::uint32_t>(result.clusters.size()) + result.clusters_dropped;
  return sight;
}

}  // namespace lf::mission
