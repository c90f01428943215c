// What differs from one machine and water to the next: each against a closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

TEST(ForwardScatter, AnotherPhaseFunctionLosesAsMuchLight) {
  const ForwardScatter sea;
  EXPECT_NEAR(sea.sum(), 0.976, 1e-6);
  const ForwardScatter other = sea.varied({0.7, 1.3, 0.7, 1.3, 1.0});
  EXPECT_NEAR(other.sum(), sea.sum(), 1e-6);
  // 0.7 * 0.136 + 1.3 * 0.199 + 0.7 * 0.248 + 1.3 * 0.275 + 0.118
  const double sum = 1.003;
  EXPECT_NEAR(other.core, 0.7 * 0.136 * 0.976 / sum, 1e-6);
  EXPECT_NEAR(other.terms[0].weight, 1.3 * 0.199 * 0.976 / sum, 1e-6);
  EXPECT_NEAR(other.terms[3].weight, 0.118 * 0.976 / sum, 1e-6);
  EXPECT_EQ(other.terms[2].angle_rad, sea.terms[2].angle_rad);
}

// Ten pixels from the straight edge of a bright field: the edge spread of this mixture, over what does not spread.
TEST(ForwardScatter, ThePictureHasTheMixtureOfItsWater) {
  for (const std::array<double, 5>& ratio : {std::array{1.3, 0.7, 0.7, 1.3, 1.3}, std::array{0.7, 1.3, 1.3, 0.7, 0.7}}) {
    OpticsConfig config;
    config.cameras.push_back(quiet_camera());
    config.cameras[0].read_noise_grey = 0.6;
    config.water = dark_clear_water();
    config.water.ambient_w_m2 = {0, 16, 0};
    config.water.attenuation_per_m = 1.2;
    config.water.forward = config.water.forward.varied(ratio);
    body(config.scene, arm5e_body::panel).shapes.push_back(make_shape(scene::ShapeKind::box, {0.02, 4, 8}, {0.71, 2, 0}, 0.8f));
    body(config.scene, arm5e_body::panel).shapes.push_back(make_shape(scene::ShapeKind::box, {0.02, 4, 8}, {0.71, -2, 0}, 0.0f));
    Optics optics(config);
    Shot shot;
    shot.poses = resting();
    shot.laser = 0;
    shot.gain = 4;  // the bright side clips; it is taken at a gain of 1
    Frame frame;
    const auto column = [&](std::size_t u, double gain) {
      double sum = 0;
      shot.gain = gain;
      for (std::size_t i = 0; i < 16; ++i) {
        shot.frame_number = i;
        optics.render(shot, frame);
        for (std::size_t v = 200; v < 280; ++v) sum += frame.pixels[v * 640 + u] / (80.0 * 16 * gain);
      }
      return sum;
    };
    const double dark = column(310, 4), bright = column(500, 1);
    double weights[5] = {0.136 * ratio[0], 0.199 * ratio[1], 0.248 * ratio[2], 0.275 * ratio[3], 0.118 * ratio[4]}, sum = 0;
    for (const double weight : weights) sum += weight;
    for (double& weight : weights) weight *= 0.976 / sum;
    const double depth = 0.89 * (1.2 - 0.145) * 0.7, core = std::exp(weights[0] * depth);
    const double S = (std::exp(0.976 * depth) - core) / (0.976 - weights[0]);
    double scattered = 0, all = 0, sigma = 2;
    for (int i = 1; i < 5; ++i, sigma *= 4) {
      scattered += weights[i] * 0.5 * std::erfc(9.5 / (sigma * std::sqrt(2.0)));
      all += weights[i] * (1 - 0.5 * std::erfc(180.5 / (sigma * std::sqrt(2.0))));
    }
    // Noise clipped at 0 adds nothing at this height. 3 % is the pyramid's, HaloPyramid.SpreadsALine; the plate is farther at the borders.
    EXPECT_NEAR(dark / bright, S * scattered / (core + S * all), 0.06 * S * scattered) << ratio[0];
  }
}

TEST(Water, ScattersTheDrawnPartOfWhatItsAttenuationGives) {
  WaterConfig config;
  config.attenuation_per_m = 0.8;
  config.scattering_ratio = 1.3;
  EXPECT_NEAR(Water(config).scattering_per_m, 1.3 * 0.89 * (0.8 - 0.145), 1e-6);
  EXPECT_NEAR(Water(config).water_w_m2_sr[1], 1.3 * config.water_w_m2_sr[1], 1e-5) << "its own light is scattered daylight";
  config.scattering_ratio = 1.5;
  EXPECT_NEAR(Water(config).scattering_per_m, 0.8, 1e-6) << "never more than is lost";
  config.scattering_share = 0.4, config.scattering_ratio = 0.7;
  EXPECT_NEAR(Water(config).scattering_per_m, 0.7 * 0.4 * 0.8, 1e-6);
}

TEST(Water, TurnsBackTheDrawnPart) {
  WaterConfig config;
  config.attenuation_per_m = 0.8;
  const auto back = [&](double share) {
    config.back_share = share;
    const Water water(config);
    const int steps = 20000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const double angle = pi / 2 * (1 + (i + 0.5) / steps);
      sum += double(water.scattering(all_lanes(static_cast<float>(std::cos(angle))))[0]) * 2 * pi * std::sin(angle) * pi / 2 / steps;
    }
    return sum / double(water.scattering_per_m);
  };
  // Behind lie (1 - g^2) / (2 g) (1 / sqrt(1 + g^2) - 1 / (1 + g)) of a lobe after Henyey and Greenstein.
  const auto behind = [](double g) { return (1 - g * g) / (2 * g) * (1 / std::sqrt(1 + g * g) - 1 / (1 + g)); };
  for (const double share : {0.007, 0.010, 0.013})
    EXPECT_NEAR(back(share), (1 - share) * behind(0.935) + share * behind(-0.14), 1e-4) << share;
}

// A stripe on a plate square to the camera, 0.7 m away.
struct LaserBench {
  explicit LaserBench(const LaserConfig& config) : laser(config), bench(plate_scene(0.7), dark_clear_water()) { bench.add(laser); }
  std::vector<double> column(int u) const {
    std::vector<double> rows;
    for (int v = 180; v < 300; ++v) rows.push_back(bench.green(camera, rays, u, v));
    return rows;
  }
  LaserConfig laser;
  Bench bench;
  CameraConfig camera = quiet_camera();
  CameraRays rays{camera.intrinsics, camera.port};
};

struct Moments {
  double sum = 0, mean = 0, variance = 0, third = 0;
};
Moments moments(const std::vector<double>& values) {
  Moments m;
  double squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) m.sum += values[i], m.mean += values[i] * double(i), squares += values[i] * double(i * i);
  m.mean /= m.sum;
  m.variance = squares / m.sum - m.mean * m.mean;
  for (std::size_t i = 0; i < values.size(); ++i) m.third += values[i] * std::pow(double(i) - m.mean, 3) / m.sum;
  return m;
}

const Vec3 emitter(0, 0, 0.36), middle(0.7, 0, 0);

LaserConfig wide_laser() {
  LaserConfig laser = vehicle_laser(sheet(emitter, middle - emitter, Vec3::UnitY()));
  laser.waist_sigma_m = 0.0035, laser.divergence_rad = 0;  // 2 px
  return laser;
}

TEST(Laser, ASideLobeIsAFaintSecondLineOfTheSamePower) {
  const Moments one = moments(LaserBench(wide_laser()).column(320));
  for (const double sigmas : {2.5, -3.0}) {
    LaserConfig laser = wide_laser();
    laser.lobe_share = 0.03, laser.lobe_sigmas = sigmas;
    const Moments both = moments(LaserBench(laser).column(320));
    EXPECT_NEAR(both.sum, one.sum, 1e-3 * one.sum) << "the power is the same";
    // Where the sheet would stand that much toward its +x: on the plate it moves by that over the cosine of the incidence, down the picture where z grows.
    const Vec3 x = laser.body_from_laser.linear().col(0);
    const double incidence = 0.7 / (middle - emitter).norm(), move_m = sigmas * 0.0035 / incidence * (x.z() > 0 ? 1 : -1);
    const double move_px = move_m * CameraIntrinsics{}.fy / 0.7;
    EXPECT_NEAR(both.mean, one.mean, 0.02 * std::abs(0.03 * move_px)) << sigmas << ": the centre of mass stays in the sheet";
    // Two bells of shares p and 1 - p that lie D apart: D^2 p (1 - p) more variance, and a third moment of D^3 p (1 - p) (1 - 2 p).
    const double p = 0.03 / 1.03;
    EXPECT_NEAR(both.variance - one.variance, move_px * move_px * p * (1 - p), 0.05 * move_px * move_px * p) << sigmas;
    EXPECT_NEAR(both.third - one.third, std::pow(move_px, 3) * p * (1 - p) * (1 - 2 * p), 0.05 * std::abs(std::pow(move_px, 3)) * p)
        << sigmas << ": and the lobe is on its side";
  }
}

TEST(Laser, IsNarrowestAtItsWaist) {
  const double range = (middle - emitter).norm();
  LaserConfig plain = wide_laser();
  const double waist = moments(LaserBench(plain).column(320)).variance;
  for (const double off_m : {0.0, 0.18, -0.18}) {
    LaserConfig laser = plain;
    laser.divergence_rad = 0.008;
    laser.waist_at_m = range + off_m;
    // Across the stripe on the plate, in pixels.
    const double px_per_m = CameraIntrinsics{}.fy / 0.7 * range / 0.7, widening = 0.008 * off_m * px_per_m;
    EXPECT_NEAR(moments(LaserBench(laser).column(320)).variance, waist + widening * widening, 0.02 * waist) << off_m;
  }
}

TEST(Laser, HasItsProfilesPowerAlongTheFan) {
  LaserConfig laser = wide_laser();
  laser.fan_profile = {0.5f, 1.0f, 1.5f, 1.2f, 0.8f};
  const LaserBench even(wide_laser()), uneven(laser);
  const double half = std::tan(laser.fan_half_angle_rad);
  for (const int u : {100, 180, 250, 320, 401, 555}) {
    const Moments a = moments(even.column(u)), b = moments(uneven.column(u));
    // Along the stripe the plate's y grows with u; the laser's y is the sheet's own.
    const double y = 0.7 * (u - CameraIntrinsics{}.cx) / CameraIntrinsics{}.fx;
    const double along = y * (laser.body_from_laser.linear().col(1).y() > 0 ? 1 : -1);
    const double place = (along / (middle - emitter).norm() / half + 1) / 2 * 4;
    const auto left = static_cast<std::size_t>(place);
    const double power = laser.fan_profile[left] + (place - double(left)) * (laser.fan_profile[left + 1] - laser.fan_profile[left]);
    EXPECT_NEAR(b.sum / a.sum, power, 2e-3) << u;
  }
}

// The ghost is the stripe again, further down, with its share of the light.
TEST(Camera, AGhostHasItsShareAndItsPlace) {
  OpticsConfig config;
  config.cameras.push_back(quiet_camera());
  config.cameras[0].read_noise_grey = 0.15;
  config.scene = plate_scene(0.7);
  config.water = dark_clear_water();
  config.lasers.push_back(wide_laser());
  config.lasers[0].power_w = 3.2;
  config.cameras[0].ghost_share = 0.01, config.cameras[0].ghost_px = 23;
  Optics optics(config);
  const auto column = [&](double gain) {
    std::vector<double> sum(480);
    Shot shot;
    shot.poses = resting();
    shot.gain = gain;
    Frame frame;
    for (std::size_t i = 0; i < 60; ++i) {
      shot.frame_number = i;
      optics.render(shot, frame);
      for (std::size_t v = 0; v < 480; ++v) sum[v] += frame.pixels[v * 640 + 320] / (60 * gain);
    }
    return sum;
  };
  const std::vector<double> low = column(0.25), high = column(4);
  const std::size_t top = static_cast<std::size_t>(std::max_element(low.begin(), low.end()) - low.begin());
  ASSERT_LT(low[top] * 0.25, 250);
  const auto part = [](const std::vector<double>& picture, std::size_t middle_v) {
    return moments(
        {picture.begin() + static_cast<std::ptrdiff_t>(middle_v) - 10, picture.begin() + static_cast<std::ptrdiff_t>(middle_v) + 11});
  };
  const Moments stripe = part(low, top), ghost = part(high, top + 23);
  ASSERT_LT(
      *std::max_element(high.begin() + static_cast<std::ptrdiff_t>(top) + 13, high.begin() + static_cast<std::ptrdiff_t>(top) + 34) * 4,
      250);
  // A level of 8 bits is 0.25 here, and read noise rounds it out to a few hundredths.
  EXPECT_NEAR(ghost.sum / stripe.sum, 0.01, 0.0004);
  EXPECT_NEAR(ghost.mean - stripe.mean, 0, 0.05);
  EXPECT_LT(part(high, top - 23).sum, 0.2 * ghost.sum) << "there is none above";
}

TEST(Camera, ExposuresDifferAsMuchAsTheirJitterSays) {
  OpticsConfig config;
  config.cameras.push_back(quiet_camera());
  config.cameras[0].intrinsics.width = 64, config.cameras[0].intrinsics.height = 48;
  config.cameras[0].intrinsics.cx = 31.5, config.cameras[0].intrinsics.cy = 23.5;
  config.cameras[0].read_noise_grey = 0.6;
  config.scene = plate_scene(0.7);
  config.water = dark_clear_water();
  config.water.ambient_w_m2 = {0, 16, 0};
  const auto light_of = [&](double jitter, std::size_t frame_number) {
    config.cameras[0].exposure_jitter = jitter;
    Optics optics(config);
    Shot shot;
    shot.poses = resting();
    shot.laser = 0;
    shot.frame_number = frame_number;
    Frame frame;
    optics.render(shot, frame);
    double sum = 0;
    for (const std::uint8_t pixel : frame.pixels) sum += pixel;
    return sum / static_cast<double>(frame.pixels.size());
  };
  const double ordered = light_of(0, 0);
  ASSERT_GT(ordered, 30);
  const std::size_t frames = 400;
  double mean = 0, squares = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    const double ratio = light_of(0.01, i) / ordered - 1;
    mean += ratio / double(frames), squares += ratio * ratio / double(frames);
  }
  // Four of their own standard deviations; the picture's mean has a noise of 0.6 / sqrt(3072) grey, 4e-4 of it.
  EXPECT_NEAR(mean, 0, 4 * 0.01 / std::sqrt(double(frames)));
  EXPECT_NEAR(std::sqrt(squares - mean * mean), 0.01, 4 * 0.01 / std::sqrt(2.0 * double(frames)));
}

}  // namespace
}  // namespace lf::optics::test
