// Light that water scatters from lamps and from the sheet: against closed forms, and against integrals that this file takes in double precision.
#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

// Simpson's rule, halved where it and its halves differ.
double integral(const std::function<double(double)>& f, double a, double b, double tolerance, int depth = 40) {
  const auto simpson = [&](double low, double high) { return (high - low) / 6 * (f(low) + 4 * f(0.5 * (low + high)) + f(high)); };
  const double middle = 0.5 * (a + b), whole = simpson(a, b), halves = simpson(a, middle) + simpson(middle, b);
  if (depth == 0 || std::abs(halves - whole) < 15 * tolerance) return halves + (halves - whole) / 15;
  return integral(f, a, middle, tolerance / 2, depth - 1) + integral(f, middle, b, tolerance / 2, depth - 1);
}

// Per steradian, of light that turns by an angle of this cosine.
double henyey_greenstein(double g, double cosine) { return (1 - g * g) / (4 * pi * std::pow(1 + g * g - 2 * g * cosine, 1.5)); }

LampConfig bulb(const Vec3& position) {
  LampConfig lamp;
  lamp.body_from_lamp = looking(position, Vec3::UnitX());
  lamp.cone_half_angle_rad = pi, lamp.edge_rad = 0;
  lamp.intensity_w_sr = {5, 5, 5};
  return lamp;
}

double haze(const WaterConfig& config, const LampConfig& lamp, int u, int v, double range) {
  const CameraConfig camera = quiet_camera();
  const CameraRays rays(camera.intrinsics, camera.port);
  const LampHaze haze(rays, CameraPlace(camera.base_from_camera), 640, 480, {SpotLight(lamp, Pose::Identity())}, Water(config));
  RgbLanes radiance{};
  LampHaze::add(haze.row(v), static_cast<float>(u), 0.f, all_lanes(static_cast<float>(range)), radiance);
  return double(radiance[1][0]);
}

Vec3 direction_of(int u, int v) {
  const CameraIntrinsics k;
  // Right and down in the picture are the base's y and z.
  return Vec3(1, (u - k.cx) / k.fx, (v - k.cy) / k.fy).normalized();
}

// Its 23 steps are taken by their middles: of the bell over the ray, 0.3 m wide at least, that errs by some per cent.
constexpr double steps_error = 0.05;

// Even scattering by water that loses nothing: b I / (4 pi h) (atan((R - s) / h) + atan(s / h)), the lamp h beside the ray and s along it.
TEST(LampHaze, OfWaterThatScattersEvenlyIsAnAngle) {
  WaterConfig water = dark_clear_water();
  water.attenuation_per_m = 0.01, water.scattering_share = 1, water.asymmetry = 0, water.back_share = 0;
  for (const Vec3& place : {Vec3(0.05, 0.5, 0.1), Vec3(0.4, -0.6, 0.0)}) {
    for (const auto& [u, v] : {std::pair{320, 240}, std::pair{500, 100}, std::pair{80, 400}}) {
      const Vec3 ray = direction_of(u, v);
      const double s = place.dot(ray), h = (place - s * ray).norm();
      for (const double range : {0.4, 0.8, 2.0}) {
        const double expected = 0.01 * 5 / (4 * pi * h) * (std::atan((range - s) / h) + std::atan(s / h));
        EXPECT_NEAR(haze(water, bulb(place), u, v, range), expected, steps_error * expected) << u << " " << v << " " << range;
      }
    }
  }
}

// Of sea water: I b p(angle) exp(-(c - 0.976 b) (r + s)) / r^2 along the ray. What is scattered forward is not lost to light that comes from all around.
TEST(LampHaze, OfSeaWaterIsTheIntegralOfWhatTurnsTowardTheCamera) {
  for (const double c : {0.4, 0.8, 2.2}) {
    WaterConfig water = dark_clear_water();
    water.attenuation_per_m = c;
    const double b = 0.89 * (c - 0.145);
    for (const Vec3& place : {Vec3(0.02, 0.45, 0.02), Vec3(0.02, -0.62, 0.02)}) {
      for (const auto& [u, v] : {std::pair{320, 240}, std::pair{400, 200}, std::pair{60, 400}}) {
        const Vec3 ray = direction_of(u, v);
        const auto light = [&](double s) {
          const Vec3 beam = s * ray - place;
          const double r = beam.norm(), cosine = -beam.dot(ray) / r;
          const double phase = 0.99 * henyey_greenstein(0.935, cosine) + 0.01 * henyey_greenstein(-0.14, cosine);
          return 5 * b * phase * std::exp(-(c - 0.976 * b) * (r + s)) / (r * r);
        };
        for (const double range : {0.4, 0.8, 2.0}) {
          const double expected = integral(light, 0, range, 1e-9);
          EXPECT_NEAR(haze(water, bulb(place), u, v, range), expected, steps_error * expected) << c << " " << u << " " << v << " " << range;
        }
      }
    }
  }
}

// A sheet that comes from above at 27 degrees onto a plate 0.7 m away.
struct GlowScene {
  explicit GlowScene(double attenuation) {
    water.attenuation_per_m = attenuation;
    laser = vehicle_laser(sheet(emitter, Vec3(0.7, 0, 0) - emitter, Vec3::UnitY()));
    laser.waist_sigma_m = 0.0025, laser.divergence_rad = 0;  // with the lens 1.6 px
  }
  // Green radiance of the sheet's glow, before a plate 0.7 m away.
  double glow(int u, int v) const {
    scene::Scene plate = plate_scene(0.7);
    Bench bench(plate, water);
    bench.add(laser);
    bench.shader.sheets[0].meet(bench.scene);
    const RayPacket ray = rays.around(CameraPlace(camera.base_from_camera), u, v, Lanes{}, Lanes{});
    const Glow glow = bench.shader.sheets[0].glow(ray, bench.water);
    return glow.parameter[0] < bench.scene.all(ray).parameter[0] ? double(glow.radiance[1][0]) : 0;
  }
  const Vec3 emitter{0, 0, 0.36};
  WaterConfig water = dark_clear_water();
  LaserConfig laser;
  CameraConfig camera = quiet_camera();
  CameraRays rays{camera.intrinsics, camera.port};
};

// The sheet with its thickness: what each place of the ray in it turns toward the camera, by single scattering.
TEST(SheetGlow, IsTheIntegralAcrossTheSheet) {
  for (const double c : {0.4, 0.8, 2.2}) {
    const GlowScene s(c);
    const double b = 0.89 * (c - 0.145), sigma = 0.0025;
    const Pose laser_from_base = s.laser.body_from_laser.inverse();
    for (const auto& [u, v] : {std::pair{320, 250}, std::pair{320, 280}, std::pair{320, 340}, std::pair{200, 300}, std::pair{450, 320}}) {
      const Vec3 ray = direction_of(u, v);
      const auto light = [&](double t) {
        const Vec3 p = laser_from_base * Vec3(t * ray), turned = laser_from_base.linear() * ray;
        const double r = std::hypot(p.y(), p.z()), cosine = -(p.y() * turned.y() + p.z() * turned.z()) / r;
        const double phase = 0.99 * henyey_greenstein(0.935, cosine) + 0.01 * henyey_greenstein(-0.14, cosine);
        const double irradiance = s.laser.power_w / (2 * s.laser.fan_half_angle_rad * r) * std::exp(-p.x() * p.x() / (2 * sigma * sigma)) /
                                  (sigma * std::sqrt(2 * pi));
        return irradiance * b * phase * std::exp(-c * (r + t));
      };
      // About the place where the ray crosses the sheet.
      const Vec3 start = laser_from_base.translation(), along = laser_from_base.linear() * ray;
      const double crossing = -start.x() / along.x(), reach = 8 * sigma / std::abs(along.x());
      const double expected = integral(light, crossing - reach, crossing + reach, 1e-10);
      // Over the sheet's thickness the light changes by its curvature, sigma^2 / range^2: below 1e-3.
      EXPECT_NEAR(s.glow(u, v), expected, 2e-3 * expected) << c << " " << u << " " << v;
    }
  }
}

// Over the peak of a stripe of the default beam, 1.9 mm, on albedo 0.5: image-formation figures, computed with Petzold's table. They have two digits at most and hold for
// an emitter some 0.3 m off: a third.
TEST(SheetGlow, HasThePublishedHeightOnOneSideOnly) {
  for (const auto& [c, published] : {std::pair{0.4, 4.5e-5}, std::pair{0.8, 1.2e-4}, std::pair{2.2, 4e-4}}) {
    const GlowScene s(c);
    const double range = (Vec3(0.7, 0, 0) - s.emitter).norm(), incidence = 0.7 / range;
    const double sigma_m = 0.0019;
    const double peak = 0.5 / pi * s.laser.power_w / (2 * s.laser.fan_half_angle_rad * range) * incidence / (sigma_m * std::sqrt(2 * pi)) *
                        std::exp(-c * (range + 0.7));
    for (const int px : {6, 10}) {
      EXPECT_NEAR(s.glow(320, 240 + px) / peak, published, published / 3) << c << " " << px;
      EXPECT_EQ(s.glow(320, 239 - px), 0) << "behind the plate";
    }
    if (c > 2) {
      EXPECT_NEAR(s.glow(320, 340) / peak, 1e-3, 1e-3 / 3) << "brighter toward the emitter";
    }
  }
}

}  // namespace
}  // namespace lf::optics::test
