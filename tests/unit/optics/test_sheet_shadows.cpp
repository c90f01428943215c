// Shadows of specks in the laser's sheet: how much light they take, and by how much they move a stripe's centre.
#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/optics/camera.hpp"
#include "host_sim/optics/sheet_shadows.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

// A disc takes its area of the light that is there, whatever the size of the pixels that see its shadow.
TEST(SheetShadows, TakeAsMuchLightAsTheSpeckIsLarge) {
  constexpr float radius_tangent = 0.002f, radius_across = 0.05f, place = 0.7f;
  const SheetShadows shadows({{0.1f, place, radius_tangent, radius_across, 0.5f}}, 0.8f);
  for (const float pixel : {0.1f, 0.5f, 2.0f}) {  // over the speck's radius
    const Lanes pixel_tangent = all_lanes(pixel * radius_tangent), pixel_across = all_lanes(pixel * radius_across);
    double taken = 0;
    constexpr int steps = 200;
    constexpr double reach_tangent = 0.008, reach_across = 0.2;
    for (int i = -steps; i <= steps; ++i) {
      for (int k = -steps; k <= steps; ++k) {
        const Lanes tangent = all_lanes(0.1f + float(reach_tangent * i / steps)),
                    across = all_lanes(place + float(reach_across * k / steps));
        taken += double(shadows.taken(all_lanes(0) == 0, tangent, across, all_lanes(0.6f), pixel_tangent, pixel_across)[0]);
      }
    }
    taken *= reach_tangent / steps * reach_across / steps;
    EXPECT_NEAR(taken, pi * double(radius_tangent) * double(radius_across) * std::exp(-0.5 * double(place * place)), 0.01 * taken) << pixel;
  }
}

TEST(SheetShadows, FallOnWhatIsFartherFromTheLaser) {
  const SheetShadows shadows({{0, 0, 0.01f, 1, 0.5f}}, 0.8f);
  const auto taken = [&](float range_m) {
    return shadows.taken(all_lanes(0) == 0, Lanes{}, Lanes{}, all_lanes(range_m), all_lanes(1e-4f), all_lanes(1e-2f))[0];
  };
  EXPECT_GT(taken(0.51f), 0.99f);
  EXPECT_EQ(taken(0.49f), 0.0f);
}

// Centre of mass of the columns' light, with and without a speck a standard deviation beside the sheet's middle. Over all columns the shift is that of the light that is
// missing: its share of a column's times its place.
TEST(SheetShadows, MoveTheCentreByWhatTheyTake) {
  const Vec3 emitter(0, 0, 0.3), axis = (Vec3(0.7, 0, 0) - emitter).normalized(),
                                 normal(0.3 / std::hypot(0.3, 0.7), 0, 0.7 / std::hypot(0.3, 0.7));
  const double range_m = std::hypot(0.3, 0.7), sigma_m = 0.006, sigma_on_plate_m = sigma_m / normal.z();
  LaserConfig laser = vehicle_laser(sheet(emitter, axis, Vec3::UnitY()));
  laser.waist_sigma_m = sigma_m;
  laser.divergence_rad = 0;
  CameraConfig config = quiet_camera();
  config.blur_px = 0;
  const Camera camera(config);
  const CameraIntrinsics& k = config.intrinsics;
  const double width_px = sigma_on_plate_m * k.fy / 0.7;
  const auto centre = [&](const Bench& bench, int u) {
    double sum = 0, moment = 0;
    for (int v = static_cast<int>(k.cy) - 26; v <= static_cast<int>(k.cy) + 27; ++v) {
      const double light = double(bench.green(config, camera.rays, u, v));
      sum += light, moment += light * v;
    }
    return moment / sum;
  };
  for (const double share_of_way : {0.5, 0.9}) {
    for (const double first : {1.0, -1.0, 0.4}) {
      // What is missing of a pixel counts at its middle: the mean over places in it.
      double shift_px = 0, expected_px = 0;
      for (int place = 0; place < 8; ++place) {
        constexpr double radius_m = 0.0006;
        const double sigmas = first + place / (8 * width_px);
        Bench clear(plate_scene(0.7), dark_clear_water()), snowy(plate_scene(0.7), dark_clear_water());
        clear.add(laser), snowy.add(laser);
        snowy.shader.sheets[0].shade_by({{emitter + axis * share_of_way * range_m + normal * (sigmas * sigma_m), 2 * radius_m}});
        for (int u = static_cast<int>(k.cx) - 8; u <= static_cast<int>(k.cx) + 9; ++u) shift_px += centre(snowy, u) - centre(clear, u);
        const double column_m = 0.7 / k.fx;
        const double missing =
            pi * radius_m * radius_m / share_of_way * std::exp(-0.5 * sigmas * sigmas) / (std::sqrt(2 * pi) * sigma_m * column_m);
        expected_px -= missing * sigmas * width_px;
      }
      EXPECT_NEAR(shift_px, expected_px, 0.06 * std::abs(expected_px)) << share_of_way << " " << first;
    }
  }
}

}  // namespace
}  // namespace lf::optics::test
