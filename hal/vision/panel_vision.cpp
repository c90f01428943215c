#include "hal/vision/panel_vision.hpp"

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <vector>

#include "firmware/scan/panel_frame.hpp"
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

// What belongs to the panel stands no higher than the highest bar's top and a centimetre. The layer that gives a bar's axis is half as deep as the thinnest is thick.
PanelClustersConfig clusters_of(const PanelVisionConfig& config) {
  PanelClustersConfig clusters = config.clusters;
  double highest_m = 0, layer_m = std::numeric_limits<double>::infinity();
  for (const PanelLayout::Valve& valve : config.panel.valves) {
    highest_m = std::max(highest_m, valve.front_m());
    layer_m = std::min(layer_m, valve.handle_thickness_m / 2);
  }
  for (const PanelLayout::Button& button : config.panel.buttons) highest_m = std::max(highest_m, button.height_m);
  clusters.max_height_m = highest_m + above_the_bar_m;
  if (std::isfinite(layer_m)) clusters.top_layer_m = layer_m;
  return clusters;
}

double tilt_cosine(const Pose& camera_from_tag, const Pose& base_from_camera, const Plane& plane) {
  return plane.normal.dot((base_from_camera * camera_from_tag).linear().col(2));
}

// A marker that the whole picture does not show may be found in a smaller one: noise averages out. Corners are found in the whole picture all the same.
constexpr std::array searched_decimations{1.0, 1.5, 2.0, 3.0};

// Those that are found together, in the first of these pictures that shows any.
std::vector<DetectedMarker> find_markers(ImageView still, const MarkerCalibrations& wanted, MarkerDetectorConfig config) {
  const double first = config.decimate;
  std::vector<DetectedMarker> found;
  for (const double decimate : searched_decimations) {
    config.decimate = std::min(first * decimate, 8.0);
    const auto markers = MarkerDetector(config).detect(still);
    for (const MarkerCalibration& ours : wanted) {
      const auto seen = std::find_if(markers.begin(), markers.end(), [&](const DetectedMarker& m) { return m.id == ours.id; });
      if (seen != markers.end()) found.push_back(*seen);
    }
    if (!found.empty()) break;
  }
  return found;
}

std::optional<MarkerObservation> observe(const DetectedMarker& seen, double size_m, const PlaneFit& fit, const PanelVisionConfig& config) {
  const auto pose = marker_pose(seen.corners_px, size_m, config.camera.intrinsics);
  if (!pose) return std::nullopt;
  MarkerObservation observation;
  observation.id = seen.id;
  observation.corners_px = seen.corners_px;
  observation.centre_px = seen.centre_px;
  observation.margin = seen.margin;
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

void observe_markers(ImageView still, const PanelVisionConfig& config, PanelResult& result) {
  for (const DetectedMarker& seen : find_markers(still, config.markers, config.detector)) {
    const auto ours =
        std::find_if(config.markers.begin(), config.markers.end(), [&](const MarkerCalibration& m) { return m.id == seen.id; });
    if (const auto observation = observe(seen, ours->size_m, result.fit, config)) (void)result.markers.push_back(*observation);
  }
}

// Of the marker that gives most.
double marker_confidence(const PanelResult& result, const PanelVisionConfig& config) {
  double most = 0;
  for (const MarkerObservation& marker : result.markers) {
    const double sureness = (marker.ambiguity - 1) / (config.full_ambiguity - 1);
    most = std::max(most, std::min(marker.margin / config.full_margin, 0.5 + 0.5 * std::clamp(sureness, 0.0, 1.0)));
  }
  return most;
}

double confidence_of(const PanelResult& result, bool has_still, const PanelVisionConfig& config) {
  if (!result.fit.valid || result.fit.points == 0 || result.clusters.empty()) return 0;
  if (has_still && result.markers.empty()) return 0;
  double confidence = static_cast<double>(result.fit.inliers) / result.fit.points;
  confidence = std::min(confidence, static_cast<double>(result.clusters[0].points) / config.full_cluster_points);
  if (has_still) confidence = std::min(confidence, marker_confidence(result, config));
  return std::isfinite(confidence) ? std::clamp(confidence, 0.0, 1.0) : 0;
}

// A handle is the cluster that the core itself will take.
void observe_pointers(ImageView still, std::span<const CloudPoint> cloud, const PanelVisionConfig& config, PanelResult& result) {
  const scan::PanelFrameConfig thresholds;
  const scan::PanelFrame frame = scan::find_panel_frame(result, config.markers, config.camera, thresholds);
  for (const PanelLayout::Valve& valve : config.panel.valves) {
    const scan::HandleObservation handle = scan::find_handle(result, frame, valve, thresholds);
    PointerObservation pointer;
    if (handle.found)
      pointer = find_pointer({frame.base_from_panel, handle.angle_rad, handle.centre_m}, still, cloud, config.camera, valve);
    (void)result.pointers.push_back(pointer);
  }
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
    if (request.has_still) observe_markers(still, config, result);
    if (usable(request.fit)) {
      const PanelClusters found = find_panel_clusters(cloud, request.fit.plane, region_of(config), clusters_of(config));
      result.clusters = found.clusters;
      result.clusters_dropped = found.dropped;
    }
    if (request.has_still) observe_pointers(still, cloud, config, result);
    result.confidence = static_cast<float>(confidence_of(result, request.has_still, config));
  } catch (...) {
    if (failed != nullptr) *failed = true;
    result.markers.clear();
    result.pointers.clear();
    result.clusters.clear();
    result.confidence = 0;
  }
  return result;
}

}  // namespace lf::vision
