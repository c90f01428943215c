#include <pcl/ModelCoefficients.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "firmware/scan/plane.hpp"
#include "tests/bench/scan/scan_bench.hpp"

namespace lf::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t count = 100'000;
constexpr double threshold_m = 0.003;

struct Scene {
  std::vector<CloudPoint> points;
  pcl::PointCloud<pcl::PointXYZ>::Ptr pcl_points{new pcl::PointCloud<pcl::PointXYZ>};
  Vec3 normal;
};

// A panel of 0.8 x 0.6 m with 1 mm of noise in the order of a sweep, outliers in the box about it.
Scene make_scene(std::uint64_t seed, double outliers) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, 0.001);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  Scene scene;
  scene.normal = Vec3(-1, 0.2 * unit(random), 0.2 * unit(random)).normalized();
  const Vec3 across = scene.normal.cross(Vec3::UnitZ()).normalized(), down = across.cross(scene.normal), centre(0.45, 0, 0.65);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / count - 0.5;
    const bool outlier = unit(random) + 0.5 < outliers;
    const Vec3 p = outlier ? Vec3(centre + Vec3(0.6 * unit(random), 0.8 * unit(random), 0.6 * t))
                           : Vec3(centre + 0.8 * unit(random) * across + 0.6 * t * down + noise(random) * scene.normal);
    scene.points.push_back({.p_m = p.cast<float>()});
    scene.pcl_points->push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  }
  return scene;
}

double angle_deg(const Vec3& a, const Vec3& b) { return deg_from_rad(std::atan2(a.cross(b).norm(), std::abs(a.dot(b)))); }

Vec3 pcl_normal(const Scene& scene) {
  pcl::SACSegmentation<pcl::PointXYZ> segmentation;
  segmentation.setModelType(pcl::SACMODEL_PLANE);
  segmentation.setMethodType(pcl::SAC_RANSAC);
  segmentation.setDistanceThreshold(threshold_m);
  segmentation.setMaxIterations(10'000);  // at 85 % outliers PCL's default of 50 finds nothing
  segmentation.setOptimizeCoefficients(true);
  segmentation.setInputCloud(scene.pcl_points);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients plane;
  segmentation.segment(inliers, plane);
  return plane.values.size() == 4 ? Vec3(plane.values[0], plane.values[1], plane.values[2]) : Vec3::Zero();
}

void add_rows(double outliers, int runs, std::vector<Row>& rows) {
  auto fitter = std::make_unique<scan::PlaneFitter>();
  std::vector<double> ours_ms, peer_ms;
  double ours_worst_deg = 0, peer_worst_deg = 0;
  for (int run = 0; run < runs; ++run) {
    const Scene scene = make_scene(static_cast<std::uint64_t>(run) + 1, outliers);
    Clock::time_point start = Clock::now();
    const PlaneFit fit = fitter->fit(scene.points, {.threshold_m = threshold_m, .seed = static_cast<std::uint64_t>(run) + 1});
    ours_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    ours_worst_deg = std::max(ours_worst_deg, fit.valid ? angle_deg(fit.plane.normal, scene.normal) : 90.0);
    start = Clock::now();
    const Vec3 normal = pcl_normal(scene);
    peer_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    peer_worst_deg = std::max(peer_worst_deg, normal.norm() > 0 ? angle_deg(normal, scene.normal) : 90.0);
  }
  std::sort(ours_ms.begin(), ours_ms.end());
  std::sort(peer_ms.begin(), peer_ms.end());
  const std::size_t middle = ours_ms.size() / 2;
  const std::string name = "plane " + std::to_string(std::lround(100 * outliers)) + " % outliers";
  const std::string peer = "PCL SACSegmentation";
  rows.push_back({name, ours_ms[middle], peer_ms[middle], peer, peer_ms[middle] / ours_ms[middle], "ms",
                  "100,000 points in sweep order, 3 mm, refined"});
  rows.push_back({name + " worst angle", ours_worst_deg, peer_worst_deg, peer, peer_worst_deg / ours_worst_deg, "deg",
                  std::to_string(runs) + " clouds"});
}

}  // namespace

std::vector<Row> run_plane_bench() {
  std::vector<Row> rows;
  add_rows(0.30, 15, rows);
  add_rows(0.85, 3, rows);  // PCL takes seconds for each
  return rows;
}

}  // namespace lf::bench
