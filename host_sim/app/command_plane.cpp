#include <memory>

#include "firmware/scan/plane.hpp"
#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/plane_doubt.hpp"
#include "host_sim/record/cloud_file.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string cloud;
  double threshold_mm = 3;
  bool json = false;
};

int plane(const Options& options) {
  const record::CloudFile cloud = record::read_cloud_file(options.cloud);
  scan::PlaneFitter::Config config;
  config.threshold_m = 1e-3 * options.threshold_mm;
  const auto fitter = std::make_unique<scan::PlaneFitter>();
  const PlaneFit fit = fitter->fit(cloud.points, config);
  if (cloud.skipped > 0)
    std::fprintf(stderr, "lanternfish: %s: %s not finite, left out\n", options.cloud.c_str(), count_of(cloud.skipped, "point").c_str());
  if (!fit.valid) {
    std::fprintf(stderr, "lanternfish: %s: no plane in %s\n", options.cloud.c_str(), count_of(cloud.points.size(), "point").c_str());
    return failed;
  }
  const std::vector<std::string> doubts = plane_doubts(cloud.points, fit, config.threshold_m);
  tell_doubts(options.cloud, doubts);
  const Vec3& n = fit.plane.normal;
  if (options.json) {
    print_json({{"normal", {n.x(), n.y(), n.z()}},
                {"offset_m", fit.plane.offset_m},
                {"inliers", fit.inliers},
                {"points", fit.points},
                {"rms_mm", 1e3 * fit.rms_m},
                {"doubts", doubts}});
  } else {
    print("normal  %.9f %.9f %.9f\noffset  %.9f m\ninliers %u of %u\nrms     %.4f mm\n", n.x(), n.y(), n.z(), fit.plane.offset_m,
          fit.inliers, fit.points, 1e3 * fit.rms_m);
  }
  return doubts.empty() ? done : failed;
}

}  // namespace

void add_plane(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("plane", "The plane that most points of a cloud lie on");
  auto options = std::make_shared<Options>();
  command->add_option("CLOUD", options->cloud, "A .pcd, .ply, .csv or .xyz file, in metres")->required();
  command->add_option("--threshold-mm", options->threshold_mm, "Inliers are nearer to the plane than this")
      ->check(within(1e-3, 1e4))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return plane(*options); }; });
}

}  // namespace lf::app
