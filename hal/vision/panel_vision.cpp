#include "hal/vision/panel_vision.hpp"

#include <algorithm>
#include <array>
#include <cfenv>
#include <exception>
#include <optional>

#include "firmware/scan/valve_frame.hpp"
#include "hal/vision/pointer.hpp"

namespace lf::vision {
namespace {

// Lanternfish may run with floating-point traps set; the libraries here divide by zero on purpose now and then.
class TrapsOff {
 public:
  TrapsOff() { std::feholdexcept(&saved_); }
  ~TrapsOff() { std::fesetenv(&saved_); }
  TrapsOff(const TrapsOff&) = delete;
  TrapsOff& operator=(const TrapsOff&) = delete;

 private:
  std::fenv_t saved_{};
};

constexpr double above_the_bar_m = 0.010;

PanelRegion region_of(const PanelVisionConfig& config) {
  const Vec2 margin = Vec2::Constant(config.region_margin_m);
  return {config.panel.nominal_base_from_panel(), config.panel.plate_min_m - margin, config.panel.plate_max_m + margin};
}

// What belongs to the panel stands no higher than the bar's top and a centimetre. The layer that gives the bar's axis is half as deep as the bar is thick.
PanelClustersConfig clusters_of(const PanelVisionConfig& config) {
  PanelClustersConfig clusters = config.clusters;
  clusters.max_height_m = config.panel.handle_height_m + config.panel.handle_thickness_m / 2 + above_the_bar_m;
  clusters.top_layer_m = config.panel.handle_thickness_m / 2;
  return clusters;
}

double tilt_cosine(const Pose& camera_from_tag, const Pose& base_from_camera, const Plane& plane) {
  return plane.normal.dot((base_from_camera * camera_from_tag).linear().col(2));
}

// A marker that the whole picture does not show may be found in a smaller one: noise averages out. Corners are found in the whole picture all the same.
constexpr std::array searched_decimations{1.0, 1.5, 2.0, 3.0};

std::optional<DetectedMarker> find_marker(ImageView still, std::int32_t id, MarkerDetectorConfig config) {
  const double first = config.decimate;
  for (const double decimate : searched_decimations) {
    config.decimate = std::min(first * decimate, 8.0);
    const auto markers = MarkerDetector(config).detect(still);
    const auto ours = std::find_if(markers.begin(), markers.end(), [id](const DetectedMarker& m) { return m.id == id; });
    if (ours != markers.end()) return *ours;
  }
  return std::nullopt;
}

MarkerObservation observe_marker(ImageView still, const PlaneFit& fit, const PanelVisionConfig& config) {
  MarkerObservation observation;
  const auto ours = find_marker(still, config.marker.id, config.detector);
  if (!ours) return observation;
  const auto pose = marker_pose(ours->corners_px, config.marker.size_m, config.camera.intrinsics);
  if (!pose) return observation;

  observation.found = true;
  observation.id = ours->id;
  observation.corners_px = ours->corners_px;
  observation.centre_px = ours->centre_px;
  observation.margin = ours->margin;
  observation.camera_from_tag = pose->camera_from_tag;
  observation.reprojection_rms_px = pose->reprojection_rms_px;
  observation.ambiguity = pose->ambiguity();
  const bool unsure = pose->has_second && observation.ambiguity < config.full_ambiguity;
  if (unsure && fit.valid &&
      tilt_cosine(pose->camera_from_tag_second, config.camera.base_from_camera, fit.plane) >
          tilt_cosine(pose->camera_from_tag, config.camera.base_from_camera, fit.plane)) {
    observation.camera_from_tag = pose->camera_from_tag_second;
    observation.reprojection_rms_px = pose->second_rms_px;
  }
  return observation;
}

double confidence_of(const PanelResult& result, bool has_still, const PanelVisionConfig& config) {
  if (!result.fit.valid || result.fit.points == 0 || result.clusters.empty()) return 0;
  if (has_still && !result.marker.found) return 0;
  double confidence = static_cast<double>(result.fit.inliers) / result.fit.points;
  confidence = std::min(confidence, static_cast<double>(result.clusters[0].points) / config.full_cluster_points);
  if (has_still) {
    const double sureness = (result.marker.ambiguity - 1) / (config.full_ambiguity - 1);
    confidence = std::min({confidence, result.marker.margin / config.full_margin, 0.5 + 0.5 * std::clamp(sureness, 0.0, 1.0)});
  }
  return std::isfinite(confidence) ? std::clamp(confidence, 0.0, 1.0) : 0;
}

// The handle is the cluster that the core itself will take.
PointerObservation observe_pointer(const PanelResult& result, ImageView still, std::span<const CloudPoint> cloud,
                                   const PanelVisionConfig& config) {
  const scan::ValveFrameConfig thresholds;
  const scan::ValveFrame frame = scan::find_valve_frame(result, config.marker, config.camera, thresholds);
  const scan::HandleObservation handle = scan::find_handle(result, frame, config.panel, thresholds);
  if (!handle.found) return {};
  return find_pointer({frame.base_from_panel, handle.angle_rad, handle.centre_m}, still, cloud, config.camera, config.panel);
}

bool usable(const PlaneFit& fit) { return fit.valid && fit.plane.normal.allFinite() && std::isfinite(fit.plane.offset_m); }

}  // namespace

PanelResult analyse_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud, const PanelVisionConfig& config,
                          bool* failed) {
  const TrapsOff traps_off;
  if (failed != nullptr) *failed = false;
  PanelResult result;
  result.id = request.id;
  result.measured = request.still_time;
  result.fit = request.fit;
  try {
    if (request.has_still) result.marker = observe_marker(still, request.fit, config);
    if (usable(request.fit)) {
      const PanelClusters found = find_panel_clusters(cloud, request.fit.plane, region_of(config), clusters_of(config));
      result.clusters = found.clusters;
      result.clusters_dropped = found.dropped;
    }
    if (request.has_still) result.pointer = observe_pointer(result, still, cloud, config);
    result.confidence = static_cast<float>(confidence_of(result, request.has_still, config));
  } catch (...) {
    if (failed != nullptr) *failed = true;
    result.marker = {};
    result.pointer = {};
    result.clusters.clear();
    result.confidence = 0;
  }
  return result;
}

}  // namespace lf::vision
