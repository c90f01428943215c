// What stands proud of the panel: handle, buttons, and what drifts by, as connected groups of the cloud's points.
//
// PCL removes lone points and groups the rest by distance. The direction of each group is found in its topmost layer only: a bar's stem and
// flanks are seen from one side and would pull the axis.
#pragma once

#include <cstdint>
#include <span>

#include "shared/geometry/pose.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf::vision {

// The part of the panel that is looked at: a rectangle on the plane, around `base_from_region`'s origin projected onto it.
struct PanelRegion {
  Pose base_from_region = Pose::Identity();  // x right, y up, z out of the panel; nominal docking will do
  Vec2 min_m = Vec2(-0.4, -0.4);
  Vec2 max_m = Vec2(0.4, 0.4);
};

struct PanelClustersConfig {
  double min_height_m = 0.008;     // over the plane: 9 sigma of the cloud in turbid water, above the 2 mm marker plate
  double max_height_m = 0.116;     // of a bar whose top is at 106 mm; what stands further out is the arm's own hand, or drifts by
  double join_distance_m = 0.012;  // points closer than this belong together: 4 stripes of 2.6 mm; buttons are 24 mm apart
  double lone_radius_m = 0.008;    // a point with fewer than `lone_neighbours` in this radius is noise
  std::uint32_t lone_neighbours = 3;
  std::uint32_t min_points = 15;  // of a group; a button gets about 300
  double top_layer_m = 0.006;     // depth of the layer that gives the axis: half the handle's thickness
};

struct PanelClusters {
  StaticVector<ProudCluster, PanelResult::max_clusters> clusters;  // most points first
  std::uint32_t dropped = 0;                                       // groups beyond the capacity
  std::uint32_t proud_points = 0;                                  // within the region and the heights
  std::uint32_t lone_points = 0;                                   // of these, removed as noise
};

// `cloud` and `plane` are in the base frame, the normal toward the robot. Points that are not finite are ignored. Deterministic; one thread.
PanelClusters find_panel_clusters(std::span<const CloudPoint> cloud, const Plane& plane, const PanelRegion& region,
                                  const PanelClustersConfig& config = {});

}  // namespace lf::vision
