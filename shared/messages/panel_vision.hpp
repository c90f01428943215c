// The panel-vision worker's question and answer: image and cloud in, marker and proud clusters out. All in the arm's base frame.
#pragma once

#include <array>
#include <cstdint>

#include "shared/geometry/pose.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf {

// A triangulated point of the laser's stripe.
struct CloudPoint {
  Eigen::Vector3f p_m = Eigen::Vector3f::Zero();  // base frame
  float amplitude = 0;                            // of the peak, grey levels
};

// Result of the plane's fit in the scan pipeline.
struct PlaneFit {
  bool valid = false;
  Plane plane;  // base frame, the normal points toward the robot
  std::uint32_t points = 0;
  std::uint32_t inliers = 0;
  double rms_m = 0;   // of the inliers
  double bend_m = 0;  // of what they have in common with their neighbours (scan::plane_bend)
  double seen_m = 0;  // shorter side of the rectangle that they fill
  // By how much the stripe's shape may have shifted all points alike, along their rays: no scatter tells of it. 0 where no stripe was seen.
  double shape_shift_m = 0;
  // By how much the points move along their rays for a radian that camera or laser are turned by, on average. 0 where no stripe was seen.
  double depth_m_per_rad = 0;
};

// From the scan pipeline to the worker. The platform adds copies of the still image and of the cloud.
struct PanelRequest {
  std::uint32_t id = 0;
  PlaneFit fit;
  bool has_still = false;
  Time still_time;  // mid-exposure of the still image
};

// One of the panel's markers in the still image.
struct MarkerObservation {
  std::int32_t id = -1;
  std::array<Vec2, 4> corners_px{Vec2::Zero(), Vec2::Zero(), Vec2::Zero(),
                                 Vec2::Zero()};  // counter-clockwise from the bottom left corner of the marker, pixel centres at integers
  Vec2 centre_px = Vec2::Zero();
  Pose camera_from_tag = Pose::Identity();
  double reprojection_rms_px = 0;
  double ambiguity = 0;  // second pose solution's error over the first's; near 1 the tilt is unsure
  double margin = 0;     // decision margin of the detector, grey levels
};

// A connected group of points that stand proud of the plane.
struct ProudCluster {
  Vec3 centroid_m = Vec3::Zero();  // base frame
  Vec3 axis = Vec3::UnitX();       // principal direction within the plane, unit, sign arbitrary
  double length_m = 0;             // extent along `axis`, 2nd to 98th percentile
  double width_m = 0;              // extent across it within the plane
  double height_m = 0;             // median height over the plane
  double height_max_m = 0;
  std::uint32_t points = 0;
};

// The pointer mark at one end of a handle's bar, which tells the handle's angle from the one half a turn on.
struct PointerObservation {
  bool seen = false;
  Vec3 direction = Vec3::UnitX();  // base frame, unit: along the bar, from its middle to the marked end
  float confidence = 0;            // 0..1: half the sum of the two readings' evidence
  // Each -1..1: for the marked end at `angle_rad` of find_handle() (positive), or half a turn on. 0: nothing seen.
  double still_evidence = 0;  // of the still image's grey levels
  double cloud_evidence = 0;  // of the laser line's brightness
};

struct PanelResult {
  static constexpr std::size_t max_clusters =
      PanelLayout::max_valves + PanelLayout::max_buttons + 8;  // edges of marker plates, and what drifts by

  std::uint32_t id = 0;  // of the request
  Time measured;         // mid-exposure of the still image
  Time answered;
  PlaneFit fit;                                                       // as in the request
  StaticVector<MarkerObservation, PanelLayout::max_markers> markers;  // those of the panel that were found
  StaticVector<ProudCluster, max_clusters> clusters;                  // largest first
  std::uint32_t clusters_dropped = 0;
  StaticVector<PointerObservation, PanelLayout::max_valves> pointers;  // by valve; what is missing at the end was not seen
  float confidence =
      0;  // 0..1: fit's inlier ratio, the best marker's margin and ambiguity, and points of the largest cluster; 0 is no answer

  PointerObservation pointer(std::size_t valve) const { return valve < pointers.size() ? pointers[valve] : PointerObservation{}; }
};

}  // namespace lf
