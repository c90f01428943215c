#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/optics/formation/particles.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

WaterConfig snow(double per_litre) {
  WaterConfig water = dark_clear_water();
  water.particles_per_l = per_litre;
  return water;
}

// Litres between two distances before the camera, within the picture.
double litres(const CameraIntrinsics& k, double near_m, double far_m) {
  const double per_depth2 = k.width / k.fx * k.height / k.fy;
  return 1e3 * per_depth2 * (std::pow(far_m, 3) - std::pow(near_m, 3)) / 3;
}

std::vector<Particles::Speck> in_view(const std::vector<Particles::Speck>& specks, const CameraConfig& camera) {
  std::vector<Particles::Speck> seen;
  const CameraIntrinsics& k = camera.intrinsics;
  for (const Particles::Speck& speck : specks) {
    const Vec3 p = camera.base_from_camera.inverse() * speck.place_m;
    const double u = k.cx + k.fx * p.x() / p.z(), v = k.cy + k.fy * p.y() / p.z();
    if (p.z() > 0.1 && p.z() < 1.0 && u > -0.5 && u < k.width - 0.5 && v > -0.5 && v < k.height - 0.5) seen.push_back(speck);
  }
  return seen;
}

TEST(Particles, AreAsManyInALitreAndAsLargeAsTheSeasPowerLawSays) {
  const Camera camera(quiet_camera());
  std::size_t all = 0, over_1_mm = 0, over_2_mm = 0, frames = 0;
  for (const double time : {0.0, 3.3, 71.0, 400.0}) {
    const Particles particles(camera, snow(10), 5);
    const std::vector<Particles::Speck> specks = in_view(particles.at(time), camera.config);
    all += specks.size(), ++frames;
    for (const Particles::Speck& speck : specks) {
      EXPECT_GE(speck.diameter_m, Particles::least_m);
      EXPECT_LE(speck.diameter_m, Particles::most_m);
      over_1_mm += speck.diameter_m > 0.001, over_2_mm += speck.diameter_m > 0.002;
    }
  }
  const double expected = 10 * litres(camera.config.intrinsics, 0.1, 1.0) * static_cast<double>(frames);
  EXPECT_NEAR(static_cast<double>(all), expected, 4 * std::sqrt(expected));
  EXPECT_NEAR(static_cast<double>(over_1_mm), expected / 4, 4 * std::sqrt(expected / 4));
  EXPECT_NEAR(static_cast<double>(over_2_mm), expected / 16, 4 * std::sqrt(expected / 16));
}

TEST(Particles, DriftWithTheWater) {
  const Camera camera(quiet_camera());
  WaterConfig water = snow(1);
  water.current_m_s = {0.01, -0.02, 0.001};
  const Particles particles(camera, water, 5);
  const std::vector<Particles::Speck> before = in_view(particles.at(10), camera.config), after = particles.at(10.9);
  ASSERT_GT(before.size(), 100U);
  std::size_t found = 0, leaves = 0;
  for (const Particles::Speck& speck : before) {
    const Vec3 expected = speck.place_m + 0.9 * water.current_m_s;
    bool there = false;
    for (const Particles::Speck& other : after) there = there || (other.place_m - expected).norm() < 1e-9;
    found += there;
    leaves += !there;
  }
  EXPECT_EQ(leaves, 0U) << found;
}

struct Darkroom {
  explicit Darkroom(const WaterConfig& water, scene::Scene scene = scene::bare_scene()) : camera(quiet_camera()), bench(scene, water) {
    pixels.resize(camera.width(), camera.height(), 1);
    std::fill(pixels.depth_m.begin(), pixels.depth_m.end(), std::numeric_limits<float>::infinity());
  }
  Camera camera;
  Bench bench;
  PixelStore pixels;
  WorkerPool pool{2};
  double sum() const {
    double sum = 0;
    for (const float grey : pixels.grey) sum += double(grey);
    return sum;
  }
};

// Radiance times pixels of a grey disc that faces its light: irradiance albedo / pi * (pi d^2 / 4) (f / z)^2.
TEST(Particles, ShowTheLightThatAGreyDiscReflects) {
  WaterConfig water = snow(0.3);
  water.ambient_w_m2 = {0, 10, 0};
  Darkroom dark(water);
  const Particles particles(dark.camera, water, 9);
  particles.stamp(0, dark.bench.shader, dark.pixels, dark.pool);
  double expected = 0;
  const CameraIntrinsics& k = dark.camera.config.intrinsics;
  for (const Particles::Speck& speck : particles.at(0)) {
    const Vec3 p = dark.camera.config.base_from_camera.inverse() * speck.place_m;
    if (p.z() < 0.1 || p.z() > 1) continue;
    const double u = k.cx + k.fx * p.x() / p.z(), v = k.cy + k.fy * p.y() / p.z();
    if (u < -8 || v < -8 || u > k.width + 7 || v > k.height + 7) continue;
    const double f_over_z = k.fy / p.z();
    const double inside = u > 8 && v > 8 && u < k.width - 9 && v < k.height - 9 ? 1 : 0.5;  // those at the borders in part
    expected += inside * 0.55 * 10 * speck.albedo / 4 * speck.diameter_m * speck.diameter_m * f_over_z * f_over_z;
  }
  EXPECT_NEAR(dark.sum() / double(dark.camera.sensor.grey_per_radiance()), expected, 0.06 * expected);
}

TEST(Particles, ThoseBehindASurfaceAreHidden) {
  WaterConfig water = snow(5);
  water.ambient_w_m2 = {0, 10, 0};
  Darkroom dark(water);
  std::fill(dark.pixels.depth_m.begin(), dark.pixels.depth_m.end(), 0.09f);
  Particles(dark.camera, water, 9).stamp(0, dark.bench.shader, dark.pixels, dark.pool);
  EXPECT_EQ(dark.sum(), 0);
}

TEST(Particles, InTheSheetAreBrightAndBesideItDark) {
  const WaterConfig water = snow(20);
  Darkroom dark(water);
  dark.bench.add(vehicle_laser(sheet({0.5, 0, 0.4}, -Vec3::UnitZ(), Vec3::UnitY())));
  const Particles particles(dark.camera, water, 3);
  particles.stamp(0, dark.bench.shader, dark.pixels, dark.pool);
  std::size_t lit = 0;
  const CameraIntrinsics& k = dark.camera.config.intrinsics;
  const auto grey_at = [&](const Vec3& place) {
    const Vec3 p = dark.camera.config.base_from_camera.inverse() * place;
    const int u = static_cast<int>(std::lround(k.cx + k.fx * p.x() / p.z())),
              v = static_cast<int>(std::lround(k.cy + k.fy * p.y() / p.z()));
    return u < 0 || v < 0 || u >= k.width || v >= k.height ? 0.f : dark.pixels.grey[dark.pixels.index(u, v)];
  };
  for (const Particles::Speck& speck : particles.at(0)) {
    if (std::abs(speck.place_m.x() - 0.5) < 0.001 && speck.place_m.z() < 0.3) lit += grey_at(speck.place_m) > 1;
  }
  EXPECT_GT(lit, 3U);
  // Light stays near the sheet: five standard deviations off it nothing is added by a speck of its own.
  Darkroom other(water);
  other.bench.add(vehicle_laser(sheet({-5, 0, 0.4}, -Vec3::UnitZ(), Vec3::UnitY())));
  Particles(other.camera, water, 3).stamp(0, other.bench.shader, other.pixels, other.pool);
  EXPECT_LT(other.sum(), 1e-6);
}

// Of the specks in the sheet, some large one takes light from the stripe on the plate behind it.
TEST(Particles, InTheSheetShadeThePlateBehindThem) {
  const Vec3 emitter(0, 0, -0.3), way = (Vec3(0.7, 0, 0) - emitter).normalized();
  OpticsConfig config;
  config.cameras.push_back(quiet_camera());
  config.scene = plate_scene(0.7);
  config.lasers.push_back(vehicle_laser(sheet(emitter, way, Vec3::UnitY())));
  config.lasers[0].power_w = 0.3;
  config.water = snow(20);
  config.seed = 4;
  const CameraIntrinsics& k = config.cameras[0].intrinsics;
  const Camera camera(config.cameras[0]);
  const Vec3 normal = sheet(emitter, way, Vec3::UnitY()).linear().col(0);
  Shot shot;
  shot.poses = resting();
  Frame snowy, clear;
  Optics(config).render(shot, snowy);
  config.water.particles_per_l = 0;
  Optics(config).render(shot, clear);
  const auto light = [&](const Frame& frame, int u) {
    double sum = 0;
    for (int v = static_cast<int>(k.cy) - 4; v <= static_cast<int>(k.cy) + 5; ++v)
      sum += frame.pixels[static_cast<std::size_t>(v * k.width + u)];
    return sum;
  };
  int shaded = 0;
  for (const Particles::Speck& speck : Particles(camera, snow(20), 4).at(0)) {
    const Vec3 from = speck.place_m - emitter;
    const double share_of_way = from.dot(way) / (0.7 / way.x());
    if (speck.diameter_m < 0.0015 || std::abs(from.dot(normal)) > 0.001 || share_of_way < 0.2 || share_of_way > 0.95) continue;
    const double y_m = from.y() / share_of_way;
    const int u = static_cast<int>(std::lround(k.cx + k.fx * y_m / 0.7));
    if (u < 10 || u > k.width - 10) continue;
    ++shaded;
    const double least = std::min({light(snowy, u - 1), light(snowy, u), light(snowy, u + 1)});
    EXPECT_LT(least, 0.9 * light(clear, u)) << "a speck of " << speck.diameter_m << " m, column " << u;
  }
  EXPECT_GE(shaded, 1);
}

}  // namespace
}  // namespace lf::optics::test
