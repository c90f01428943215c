#include <gtest/gtest.h>

#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

struct Middle {
  CameraConfig camera = quiet_camera();
  CameraRays rays{camera.intrinsics, camera.port};
  // The pixel closest to the axis looks along it to 0.11 degrees.
  float operator()(const Bench& bench) const { return bench.green(camera, rays, 320, 240); }
};

LampConfig lamp_at(const Vec3& position, const Vec3& axis) {
  LampConfig lamp;
  lamp.body_from_lamp = looking(position, axis);
  return lamp;
}

TEST(Radiometry, LampsFollowTheInverseSquareLawAndLambert) {
  const Middle middle;
  const float albedo = 0.6f;
  for (const double distance : {0.5, 0.8, 1.6}) {
    for (const double angle : {0.0, 0.6}) {
      Bench bench(plate_scene(distance, albedo), dark_clear_water());
      const Vec3 target(distance, 0, 0), from = target - 0.45 * Vec3(std::cos(angle), std::sin(angle), 0);
      bench.add(lamp_at(from, target - from));
      const double expected = albedo / pi * LampConfig{}.intensity_w_sr[1] * std::cos(angle) / (0.45 * 0.45);
      EXPECT_NEAR(middle(bench), expected, 0.01 * expected) << distance << " " << angle;
    }
  }
  Bench near(plate_scene(1.0), dark_clear_water()), far(plate_scene(2.0), dark_clear_water());
  near.add(lamp_at({0, 0, 0.001}, Vec3::UnitX()));
  far.add(lamp_at({0, 0, 0.001}, Vec3::UnitX()));
  EXPECT_NEAR(middle(near) / middle(far), 4.0, 1e-3);
}

TEST(Radiometry, LampsWaterObeysBeerAndLambertBothWays) {
  const Middle middle;
  WaterConfig water = dark_clear_water();
  water.scattering_share = 0;
  Bench clear(plate_scene(0.9), water);
  clear.add(lamp_at({0, 0, 0.001}, Vec3::UnitX()));
  water.attenuation_per_m = 0.7;
  Bench turbid(plate_scene(0.9), water);
  turbid.add(lamp_at({0, 0, 0.001}, Vec3::UnitX()));
  EXPECT_NEAR(middle(turbid) / middle(clear), std::exp(-0.7 * 2 * 0.9), 1e-5);
}

TEST(Radiometry, StripesWaterObeysBeerAndLambertOverBothPaths) {
  CameraConfig camera = quiet_camera();
  const CameraRays rays(camera.intrinsics, camera.port);
  const Vec3 from(0.1, 0, 0.4);
  const auto brightest = [&](double attenuation) {
    WaterConfig water = dark_clear_water();
    water.attenuation_per_m = attenuation;
    water.scattering_share = 0;
    Bench bench(plate_scene(0.9), water);
    bench.add(vehicle_laser(sheet(from, Vec3(0.9, 0, 0) - from, Vec3::UnitY())));
    return bench.green(camera, rays, 320, 240);
  };
  const double path = 0.9 + (Vec3(0.9, 0, 0) - from).norm();
  EXPECT_NEAR(brightest(0.8) / brightest(0.0), std::exp(-0.8 * path), 1e-3 * std::exp(-0.8 * path));
}

TEST(Radiometry, StripesPowerAcrossItIsTheFansPowerPerMetre) {
  // Summed over the pixels across the stripe, irradiance is power / (fan angle * range) * incidence, whatever its width and blur.
  CameraConfig camera = quiet_camera();
  const CameraRays rays(camera.intrinsics, camera.port);
  const Vec3 from(0, 0, 0.4), target(0.7, 0, 0);
  const LaserConfig laser = vehicle_laser(sheet(from, target - from, Vec3::UnitY()));
  const double range = (target - from).norm(), incidence = 0.7 / range;
  for (const double blur : {0.0, 0.5, 1.5}) {
    camera.blur_px = blur;
    WaterConfig water = dark_clear_water();
    Bench bench(plate_scene(0.7, 1.0f), water);
    bench.add(laser);
    double sum = 0;
    for (int v = 200; v < 280; ++v)
      sum += bench.green(camera, rays, 320, v) * pi * 0.7 / camera.intrinsics.fy;  // W/m2 times metres of plate per pixel
    // Per metre of plate across the stripe a sheet at this incidence spreads by 1 / incidence.
    const double expected = laser.power_w / (2 * laser.fan_half_angle_rad * range) * incidence / incidence;
    EXPECT_NEAR(sum, expected, 0.01 * expected) << blur;
  }
}

TEST(Radiometry, RedFadesFasterThanGreen) {
  const WaterConfig config;
  const Water water(config);
  EXPECT_NEAR(water.transmission(1, all_lanes(2.f))[0], std::exp(-0.6), 1e-6);
  EXPECT_NEAR(water.transmission(0, all_lanes(2.f))[0], std::exp(-0.6 * double(config.attenuation_ratio[0])), 1e-6);
}

// Shares of the scattered light within an angle, and what turns back: Petzold's mean phase function for particles, as published.
TEST(Radiometry, ScatteringFollowsPetzoldsMeanPhaseFunction) {
  WaterConfig config;
  config.attenuation_per_m = 0.8;
  const Water water(config);
  const auto within = [&](double degrees) {
    const int steps = 40000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const double angle = rad_from_deg(degrees) * (i + 0.5) / steps;
      sum += double(water.scattering(all_lanes(static_cast<float>(std::cos(angle))))[0]) * 2 * pi * std::sin(angle) *
             rad_from_deg(degrees) / steps;
    }
    return sum / double(water.scattering_per_m);
  };
  EXPECT_NEAR(water.scattering_per_m, 0.58, 0.01);  // of a harbour-like 0.8 1/m
  EXPECT_NEAR(within(180), 1, 2e-3);
  for (const auto& [degrees, share] : {std::pair{10.0, 0.668}, std::pair{20.0, 0.812}, std::pair{45.0, 0.932}})
    EXPECT_NEAR(within(degrees), share, 0.02) << degrees;
  EXPECT_NEAR(1 - within(90), 0.018, 0.004);
  EXPECT_NEAR(water.scattering(all_lanes(static_cast<float>(std::cos(rad_from_deg(160)))))[0] / water.scattering_per_m, 2.7e-3, 0.3e-3);
}

TEST(Radiometry, WaterScattersAsMuchAsPetzoldsThreeWaters) {
  for (const auto& [attenuation, scattering] : {std::pair{0.151, 0.037}, std::pair{0.398, 0.219}, std::pair{2.190, 1.824}})
    EXPECT_NEAR(sea_scattering_per_m(attenuation), scattering, 0.01 + 0.02 * scattering) << attenuation;
}

// Lit from all sides a field loses only what is absorbed and what turns back.
TEST(Radiometry, AWideFieldLosesOnlyWhatIsAbsorbedAndTurnsBack) {
  WaterConfig config;
  config.attenuation_per_m = 0.8;
  const Water water(config);
  const double b = double(water.scattering_per_m);
  for (const double range : {0.3, 0.9, 2.0}) {
    const double expected = std::exp(-0.8 * range + 0.976 * b * range);
    EXPECT_NEAR(water.broad_transmission(1, all_lanes(static_cast<float>(range)))[0], expected, 1e-5);
  }
}

TEST(Radiometry, AnAbsorberIsDark) {
  const Middle middle;
  WaterConfig water;
  water.attenuation_per_m = 2;
  water.scattering_share = 0;
  scene::Scene nothing = scene::bare_scene();
  Bench bench(nothing, water);
  bench.add(vehicle_laser(sheet({0.3, 0, 0.4}, {0.2, 0, -1}, Vec3::UnitY())));
  EXPECT_EQ(middle(bench), 0);
}

TEST(Radiometry, OpenWaterGathersTowardItsOwnColour) {
  const Middle middle;
  WaterConfig water;
  scene::Scene nothing = scene::bare_scene();
  Bench bench(nothing, water);
  EXPECT_NEAR(middle(bench), water.water_w_m2_sr[1], 0.01 * water.water_w_m2_sr[1]);
}

TEST(Radiometry, LampHazeEqualsTheIntegralOfScatteringAlongTheRay) {
  CameraConfig camera = quiet_camera();
  const CameraRays rays(camera.intrinsics, camera.port);
  const CameraPlace place(camera.base_from_camera);
  const Water water(WaterConfig{});
  const std::vector<SpotLight> lamps{SpotLight(lamp_at({0.0, 0.3, 0.0}, {1, -0.3, 0}), Pose::Identity())};
  const LampHaze haze(rays, place, 640, 480, lamps, water);
  for (const double range : {0.3, 0.8, 2.0}) {
    const int u = 400, v = 200;
    const RayPacket ray = rays.around(place, u, v, Lanes{}, Lanes{});
    const Lanes slope = CameraRays::slope(ray);
    const Lanes3 direction = ray.direction * (1.f / slope);
    double expected = 0;
    const int steps = 4000;
    for (int i = 0; i < steps; ++i) {
      const Lanes at = all_lanes(static_cast<float>((i + 0.5) * range / steps));
      expected += lamps[0].scattered(ray.origin + direction * at, direction, at, water)[1][0] * range / steps;
    }
    RgbLanes radiance{};
    LampHaze::add(haze.row(v), static_cast<float>(u), 0.f, all_lanes(static_cast<float>(range)), radiance);
    EXPECT_NEAR(radiance[1][0], expected, 0.05 * expected) << range;
  }
}

TEST(Radiometry, ExponentialAndNormalDistributionMatchTheLibrarys) {
  for (float x = -20.f; x < 20.f; x += 0.037f) {
    EXPECT_NEAR(exp(all_lanes(x))[0] / std::exp(static_cast<double>(x)), 1.0, 2e-6) << x;
    EXPECT_NEAR(normal_cdf(all_lanes(x))[0], 0.5 * std::erfc(-x / std::sqrt(2.0)), 3e-7) << x;
  }
}

}  // namespace
}  // namespace lf::optics::test
