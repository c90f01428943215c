// The glow of a row of tiles, against the glow of each pixel by itself.
#include <gtest/gtest.h>

#include "host_sim/optics/glow_rows.hpp"
#include "host_sim/optics/tiles.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

struct Differences {
  double worst_radiance = 0, worst_parameter = 0;  // over the exact
  int pixels = 0, not_alike = 0;                   // in some bit
};

// Over the whole picture. Two pixels that differ in where the sheet ends differ by all of their light.
Differences compare(const CameraConfig& config, const Bench& bench) {
  const Camera camera(config);
  const Tiles tiles(camera);
  Differences found;
  for (int tile_row = 0; tile_row < tiles.rows(); ++tile_row) {
    const GlowRows rows(camera, bench.shader, tiles.first_row(tile_row), tiles.end_row(tile_row));
    for (int v = tiles.first_row(tile_row); v < tiles.end_row(tile_row); ++v) {
      for (int u = 0; u < camera.width(); u += lane_count) {
        const Glow by_rows = rows.at(0, u, v), exact = bench.shader.sheets[0].glow(camera.lines(u, v), bench.water);
        for (int lane = 0; lane < lane_count && u + lane < camera.width(); ++lane) {
          const double is = double(by_rows.radiance[1][lane]), wanted = double(exact.radiance[1][lane]);
          if (is == 0 && wanted == 0) continue;
          ++found.pixels;
          if (is != wanted) ++found.not_alike;
          found.worst_radiance = std::max(found.worst_radiance, std::abs(is - wanted) / std::max(is, wanted));
          found.worst_parameter = std::max(found.worst_parameter, double(std::abs(by_rows.parameter[lane] / exact.parameter[lane] - 1)));
        }
      }
    }
  }
  return found;
}

// A plate 0.7 m away, lit from above at 27 degrees, and a thin rod in the sheet.
struct LitWater {
  explicit LitWater(double attenuation, double rod_m) {
    water.attenuation_per_m = attenuation;
    bodies = plate_scene(0.7);
    if (rod_m > 0)
      body(bodies, arm5e_body::panel).shapes.push_back(make_shape(scene::ShapeKind::box, {0.2, rod_m, 0.01}, {0.35, 0.03, 0.18}));
    laser = vehicle_laser(sheet({0, 0, 0.36}, Vec3(0.7, 0, -0.36), Vec3::UnitY()));
    bench.emplace(bodies, water);
    bench->add(laser);
    bench->shader.sheets[0].meet(bench->scene);
  }
  scene::Scene bodies;
  WaterConfig water = dark_clear_water();
  LaserConfig laser;
  std::optional<Bench> bench;
};

TEST(GlowRows, AreWithinHalfAPerCentOfEachPixels) {
  for (const double attenuation : {0.3, 1.0, 2.5}) {
    const LitWater lit(attenuation, 0);
    const Differences found = compare(quiet_camera(), *lit.bench);
    EXPECT_GT(found.pixels, 30'000);
    EXPECT_GT(found.not_alike, found.pixels / 2) << "interpolated";
    EXPECT_LT(found.worst_radiance, 5e-3) << attenuation;
    EXPECT_LT(found.worst_parameter, 1e-4) << attenuation;
  }
}

TEST(GlowRows, HaveEachShadowsBorderWhereItIs) {
  for (const double rod_m : {0.02, 0.002, 0.0005}) {
    const LitWater lit(1.0, rod_m);
    const Differences found = compare(quiet_camera(), *lit.bench);
    EXPECT_GT(found.not_alike, found.pixels / 4);
    EXPECT_LT(found.worst_radiance, 5e-3) << rod_m;
  }
}

// The fan's end and the emitter itself in the picture, the camera close to the sheet, a lens that distorts, a port, and a height that no tile divides.
TEST(GlowRows, HoldForOtherCameras) {
  const LitWater lit(0.8, 0.005);
  CameraConfig low = quiet_camera();
  low.base_from_camera = looking({-0.3, 0.02, 0.43}, Vec3(1, 0, -0.45));
  CameraConfig bent = quiet_camera();
  bent.intrinsics.distortion = {-0.06, 0.02, 5e-4, -5e-4, 0};
  bent.intrinsics.height = 477;
  CameraConfig ported = quiet_camera();
  ported.intrinsics.fx = ported.intrinsics.fy = 700;
  ported.port = FlatPort{};
  for (const CameraConfig& camera : {low, bent, ported}) {
    const Differences found = compare(camera, *lit.bench);
    EXPECT_GT(found.pixels, 5'000);
    EXPECT_LT(found.worst_radiance, 5e-3);
    EXPECT_LT(found.worst_parameter, 5e-4);
  }
}

}  // namespace
}  // namespace lf::optics::test
