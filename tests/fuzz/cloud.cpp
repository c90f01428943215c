// Files of clouds, and what is made of their points: each reader gets every input, and takes it or refuses it with an InputError. Points of a file that is taken
// go on to the plane's fit and to the clusters.
#include <cmath>

#include "firmware/scan/plane.hpp"
#include "hal/vision/panel_clusters.hpp"
#include "host_sim/record/cloud_reading.hpp"
#include "shared/input_error.hpp"
#include "tests/fuzz/input.hpp"

namespace lf::fuzz {
namespace {

void use(const record::CloudFile& cloud) {
  for (const CloudPoint& point : cloud.points) expect(point.p_m.allFinite(), "a point that is kept is finite");
  static scan::PlaneFitter fitter;
  scan::PlaneFitter::Config config;
  config.hypotheses = 64;
  config.tight_sigmas = 3;
  const PlaneFit fit = fitter.fit(cloud.points, config);
  expect(fit.inliers <= fit.points && fit.points <= cloud.points.size(), "inliers are points");
  expect(!fit.valid || (std::abs(fit.plane.normal.norm() - 1) < 1e-6 && std::isfinite(fit.rms_m)), "a plane that is valid has a normal");
  vision::PanelRegion region;
  region.min_m = Vec2(-100, -100);
  region.max_m = Vec2(100, 100);
  vision::PanelClustersConfig clusters;
  clusters.min_points = 3;
  clusters.lone_neighbours = 1;
  for (const ProudCluster& cluster :
       vision::find_panel_clusters(cloud.points, fit.valid ? fit.plane : Plane{}, region, clusters).clusters) {
    expect(cluster.centroid_m.allFinite() && std::abs(cluster.axis.norm() - 1) < 1e-6, "a cluster has a place and an axis");
  }
}

}  // namespace
}  // namespace lf::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const auto read : {lf::record::read_pcd, lf::record::read_ply, lf::record::read_csv, lf::record::read_xyz}) {
    try {
      lf::fuzz::use(read("fuzz", bytes));
    } catch (const lf::InputError& refused) {
      lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
    }
  }
  return 0;
}
