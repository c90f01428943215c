#include "hal/vision/panel_clusters.hpp"

#include <pcl/filters/radius_outlier_removal.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "hal/vision/bar_axis.hpp"

namespace lf::vision {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

// A frame on the fitted plane: the region's x and y axes turned into it, z the plane's normal. Not finite where its normal is along the region's x axis, within half a
// degree: what is left of that axis is rounding.
Pose base_from_plane(const Plane& plane, const Pose& base_from_region) {
  constexpr double least_in_plane = 0.01;
  Pose pose = Pose::Identity();
  const Vec3 z = plane.normal.normalized();
  const Vec3 in_plane = base_from_region.linear().col(0) - z * z.dot(base_from_region.linear().col(0));
  const Vec3 x = in_plane / (in_plane.norm() > least_in_plane ? in_plane.norm() : std::numeric_limits<double>::quiet_NaN());
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  const Vec3 origin = base_from_region.translation();
  pose.translation() = origin - z * plane.signed_distance_m(origin);
  return pose;
}

// Coordinates on the plane, z the height over it.
PclCloud::Ptr proud_points(std::span<const CloudPoint> cloud, const Pose& plane_from_base, const PanelRegion& region,
                           const PanelClustersConfig& config) {
  PclCloud::Ptr proud(new PclCloud);
  for (const CloudPoint& point : cloud) {
    if (!point.p_m.allFinite()) continue;
    const Vec3 p = plane_from_base * point.p_m.cast<double>();
    const bool inside = p.x() >= region.min_m.x() && p.x() <= region.max_m.x() && p.y() >= region.min_m.y() && p.y() <= region.max_m.y();
    if (inside && p.z() >= config.min_height_m && p.z() <= config.max_height_m) {
      proud->push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
    }
  }
  return proud;
}

PclCloud::Ptr without_lone_points(const PclCloud::Ptr& points, const PanelClustersConfig& config) {
  PclCloud::Ptr kept(new PclCloud);
  if (points->empty()) return kept;
  pcl::RadiusOutlierRemoval<pcl::PointXYZ> removal;
  removal.setInputCloud(points);
  removal.setRadiusSearch(config.lone_radius_m);
  removal.setMinNeighborsInRadius(static_cast<int>(config.lone_neighbours));
  removal.filter(*kept);
  return kept;
}

// Groups in the plane, whatever the height: a bar and what is seen of the stem below it are one.
std::vector<pcl::PointIndices> groups_of(const PclCloud& points, const PanelClustersConfig& config) {
  std::vector<pcl::PointIndices> groups;
  if (points.empty()) return groups;
  PclCloud::Ptr flat(new PclCloud(points));
  for (pcl::PointXYZ& point : *flat) point.z = 0;
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(config.join_distance_m);
  extraction.setMinClusterSize(static_cast<int>(config.min_points));
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(flat);
  extraction.extract(groups);
  return groups;
}

// `share` of the way through the sorted values; reorders them.
double percentile(std::vector<double>& values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

double extent(std::vector<double> values) {
  const double low = percentile(values, 0.02);
  return percentile(values, 0.98) - low;
}

ProudCluster describe(const PclCloud& points, const pcl::PointIndices& group, const Pose& base_from_plane_frame,
                      const PanelClustersConfig& config) {
  std::vector<double> heights;
  for (const int i : group.indices) heights.push_back(static_cast<double>(points[static_cast<std::size_t>(i)].z));
  ProudCluster cluster;
  cluster.points = static_cast<std::uint32_t>(heights.size());
  cluster.height_m = percentile(heights, 0.5);
  const double top_m = percentile(heights, 0.95);
  cluster.height_max_m = percentile(heights, 1);

  std::vector<Vec2> top;
  double top_height_sum = 0;
  for (const int i : group.indices) {
    const pcl::PointXYZ& p = points[static_cast<std::size_t>(i)];
    if (std::abs(static_cast<double>(p.z) - top_m) > config.top_layer_m) continue;
    top.emplace_back(p.x, p.y);
    top_height_sum += static_cast<double>(p.z);
  }
  const BarAxis bar = bar_axis(top);
  std::vector<double> along, across;
  for (const Vec2& p : top) {
    along.push_back(bar.direction.dot(p - bar.centre));
    across.push_back(bar.direction.x() * (p - bar.centre).y() - bar.direction.y() * (p - bar.centre).x());
  }
  cluster.length_m = extent(std::move(along));
  cluster.width_m = extent(std::move(across));
  cluster.axis = base_from_plane_frame.linear() * Vec3(bar.direction.x(), bar.direction.y(), 0);
  cluster.centroid_m = base_from_plane_frame * Vec3(bar.centre.x(), bar.centre.y(), top_height_sum / static_cast<double>(top.size()));
  return cluster;
}

}  // namespace

PanelClusters find_panel_clusters(std::span<const CloudPoint> cloud, const Plane& plane, const PanelRegion& region,
                                  const PanelClustersConfig& config) {
  PanelClusters result;
  const Pose frame = base_from_plane(plane, region.base_from_region);
  if (!frame.matrix().allFinite()) return result;
  const PclCloud::Ptr proud = proud_points(cloud, frame.inverse(), region, config);
  const PclCloud::Ptr kept = without_lone_points(proud, config);
  result.proud_points = static_cast<std::uint32_t>(proud->size());
  result.lone_points = static_cast<std::uint32_t>(proud->size() - kept->size());

  std::vector<pcl::PointIndices> groups = groups_of(*kept, config);
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.indices.size() > b.indices.size(); });
  for (const pcl::PointIndices& group : groups) {
    if (!result.clusters.push_back(describe(*kept, group, frame, config))) ++result.dropped;
  }
  return result;
}

}  // namespace lf::vision
