// Whole pictures, formed in nature's order, against closed forms and published figures.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

// Over 16 frames, so that the quantisation is out of the way; the noise that it needs is the camera's.
std::vector<double> mean_of(Optics& optics, Shot shot, std::size_t frames = 16) {
  std::vector<double> mean;
  Frame frame;
  for (std::size_t i = 0; i < frames; ++i) {
    shot.frame_number = i;
    optics.render(shot, frame);
    mean.resize(frame.pixels.size());
    for (std::size_t p = 0; p < mean.size(); ++p) mean[p] += double(frame.pixels[p]) / static_cast<double>(frames);
  }
  return mean;
}

Shot still_shot() {
  Shot shot;
  shot.poses = resting();
  shot.laser = 0;
  return shot;
}

CameraConfig noisy_camera() {
  CameraConfig camera = quiet_camera();
  camera.read_noise_grey = 0.6;
  return camera;
}

// Along a piece of column u. Of darkness it is 0.24: noise that clips at 0 and is rounded.
double column_mean(const std::vector<double>& picture, std::size_t u) {
  double sum = 0;
  for (std::size_t v = 200; v < 280; ++v) sum += picture[v * 640 + u] / 80;
  return sum;
}

struct FieldScene {
  FieldScene() {
    config.cameras.push_back(noisy_camera());
    config.scene = plate_scene(0.7);
    body(config.scene, arm5e_body::panel).shapes[0].size_m = {0.02, 8, 8};
    config.water = dark_clear_water();
    config.water.ambient_w_m2 = {0, 16, 0};  // the other bands fade faster
  }
  double middle() {
    Optics optics(config);
    return column_mean(mean_of(optics, still_shot()), 320);
  }
  OpticsConfig config;
};

TEST(Picture, AnEvenFieldKeepsWhatIsScatteredForward) {
  FieldScene s;
  const double clear = s.middle();
  for (const double attenuation : {0.4, 1.2, 2.2}) {
    s.config.water.attenuation_per_m = attenuation;
    const double b = 0.89 * (attenuation - 0.145);
    const double expected = clear * std::exp(-attenuation * 0.7 + 0.976 * b * 0.7);
    // Toward the picture's edges the plate is farther away, and the widest Gaussian reaches there.
    EXPECT_NEAR(s.middle(), expected, 0.03 * expected) << attenuation;
  }
}

TEST(Picture, OrderedExposureGainAndShareOfTheLightAreObeyed) {
  FieldScene s;
  s.config.lamps.push_back(LampConfig{});
  s.config.lamps[0].body_from_lamp = looking({0, 0.1, 0}, Vec3::UnitX());
  s.config.lamps[0].intensity_w_sr = {1, 1, 1};
  Optics optics(s.config);
  Shot shot = still_shot();
  const auto middle = [&] { return column_mean(mean_of(optics, shot), 320); };
  const double dark = middle();
  shot.lamps = 1;
  const double lit = middle();
  ASSERT_GT(lit, dark + 10);
  shot.lamps = 0.5;
  EXPECT_NEAR(middle(), 0.5 * (dark + lit), 0.3);
  shot.lamps = 0;
  shot.exposure = s.config.cameras[0].exposure * 2;
  EXPECT_NEAR(middle(), 2 * dark, 0.3);
  shot.exposure = s.config.cameras[0].exposure / 2;
  shot.gain = 4;
  EXPECT_NEAR(middle(), 2 * dark, 0.4);
}

// A stripe on a plate square to the camera, seen and lit through water on both sides.
struct StripeInWater {
  explicit StripeInWater(double attenuation, double albedo = 0.5) {
    config.cameras.push_back(noisy_camera());
    config.cameras[0].blur_px = 0.7;
    config.cameras[0].read_noise_grey = 0.15;  // at a gain of 4 as much as rounding needs
    config.scene = plate_scene(0.7, static_cast<float>(albedo));
    config.water = dark_clear_water();
    config.water.attenuation_per_m = attenuation;
    base_from_laser = sheet(from, toward - from, Vec3::UnitY());
    config.lasers.push_back(vehicle_laser(base_from_laser));
    config.lasers[0].waist_sigma_m = 0.0025, config.lasers[0].divergence_rad = 0;  // 1.4 px, with the lens 1.6
    config.lasers[0].power_w = 3.5;
  }
  // Column 320 over its peak, rows from the peak's.
  std::vector<double> profile(double gain) {
    Optics optics(config);
    Shot shot = still_shot();
    shot.laser = 1;
    shot.gain = gain;
    const std::vector<double> mean = mean_of(optics, shot, 60);
    std::vector<double> column;
    for (int v = 0; v < 480; ++v) column.push_back(mean[static_cast<std::size_t>(v * 640 + 320)]);
    return column;
  }
  Vec3 from{0.0, 0, 0.36}, toward{0.7, 0, 0.0};
  Pose base_from_laser;
  OpticsConfig config;
};

// Skirt over the peak, both ways 1.4 m together, core sigma 1.6 px: a table computed with Petzold's phase function, not with the mixture (image-formation figures).
TEST(Picture, ScatteredLightMakesTheSkirtThatPetzoldsPhaseFunctionGives) {
  const struct {
    double c;
    double at[3];  // 10, 20, 50 px: nearer the core itself is still there
  } rows[] = {{0.40, {.013, .006, .002}}, {0.80, {.042, .020, .006}}};
  for (const auto& row : rows) {
    StripeInWater s(row.c);
    // The peak is taken at an exposure at which it does not clip, the skirt at eight times of it.
    const std::vector<double> low = s.profile(0.25), high = s.profile(4);
    const auto top = std::max_element(low.begin(), low.end());
    ASSERT_LT(*top, 250);
    ASSERT_GT(*top, 100);
    const double peak = *top * 16;
    const auto v = top - low.begin();
    const int px[] = {10, 20, 50};
    for (std::size_t i = 0; i < 3; ++i) {
      // The mixture is within 4 to 15 % of the phase function, and range and incidence differ beside the stripe.
      const double mean = 0.5 * (high[static_cast<std::size_t>(v - px[i])] + high[static_cast<std::size_t>(v + px[i])]);
      ASSERT_LT(mean, 250);
      EXPECT_NEAR(mean / peak, row.at[i], 0.25 * row.at[i] + 0.0008) << row.c << " " << px[i];
    }
  }
}

TEST(Picture, DarkPaintNearBrightTakesItsLight) {
  // Half of the view white, half black: in clear water black stays black, in turbid water it takes a share of its bright neighbour's light.
  const auto black = [](double attenuation) {
    OpticsConfig config;
    config.cameras.push_back(noisy_camera());
    config.water = dark_clear_water();
    config.water.ambient_w_m2 = {0, 16, 0};  // the other bands fade faster
    config.water.attenuation_per_m = attenuation;
    body(config.scene, arm5e_body::panel).shapes.push_back(make_shape(scene::ShapeKind::box, {0.02, 4, 8}, {0.71, 2, 0}, 0.8f));
    body(config.scene, arm5e_body::panel).shapes.push_back(make_shape(scene::ShapeKind::box, {0.02, 4, 8}, {0.71, -2, 0}, 0.0f));
    Optics optics(config);
    const std::vector<double> mean = mean_of(optics, still_shot());
    return std::pair(column_mean(mean, 310), column_mean(mean, 500));
  };
  EXPECT_NEAR(black(0).first, 0.24, 0.05);  // the noise's own mean above 0
  const auto [dark, bright] = black(1.2);
  // Ten pixels from a straight edge: the mixture's edge spread, of what scatters once and again, over what does not spread.
  const double depth = 0.89 * (1.2 - 0.145) * 0.7, core = std::exp(0.136 * depth), S = (std::exp(0.976 * depth) - core) / 0.84;
  double scattered = 0, all = 0;
  for (const auto& [weight, sigma] : {std::pair{.199, 2.0}, std::pair{.248, 8.0}, std::pair{.275, 32.0}, std::pair{.118, 128.0}}) {
    scattered += weight * 0.5 * std::erfc(9.5 / (sigma * std::sqrt(2.0)));
    all += weight * (1 - 0.5 * std::erfc(180.5 / (sigma * std::sqrt(2.0))));
  }
  EXPECT_NEAR((dark - 0.24) / bright, S * scattered / (core + S * all), 0.06 * S * scattered);
}

TEST(Picture, StrayLightIsItsShareBesideABrightField) {
  OpticsConfig config;
  config.cameras.push_back(noisy_camera());
  config.cameras[0].stray_share = 0.05;
  config.cameras[0].stray_px = 6;
  config.water = dark_clear_water();
  config.water.ambient_w_m2 = {0, 16, 0};  // the other bands fade faster
  body(config.scene, arm5e_body::panel).shapes.push_back(make_shape(scene::ShapeKind::box, {0.02, 4, 8}, {0.71, 2, 0}, 0.8f));
  Optics optics(config);
  const std::vector<double> mean = mean_of(optics, still_shot());
  const double bright = column_mean(mean, 500);
  EXPECT_NEAR(column_mean(mean, 314) - 0.24, bright * 0.05 * 0.5 * std::erfc(5.5 / (6 * std::sqrt(2.0))), 0.2);
}

// The wide side of a stripe that falls on a slant: scatter toward the far side lands farther and thinner. Ratios at an incidence of 27 degrees.
TEST(Picture, SkirtIsThinnerOnTheFarSide) {
  StripeInWater s(2.2);
  Bench bench(s.config.scene, s.config.water);
  bench.add(s.config.lasers[0]);
  const auto skirt = [&](double off_rad) {
    // The place on the plate that the emitter sees this far off its sheet.
    const Vec3 z = s.base_from_laser.linear().col(2);
    const double angle = std::atan2(-z.z(), z.x()) - off_rad;  // below the horizontal: upward is negative
    const Vec3 p = s.from + Vec3(0.7, 0, -0.7 * std::tan(angle));
    CameraConfig camera = quiet_camera();
    const CameraRays rays(camera.intrinsics, camera.port);
    const auto image = rays.project(camera.base_from_camera.inverse() * p);
    const int u = static_cast<int>(std::lround(image->x())), v = static_cast<int>(std::floor(image->y()));
    const auto at = [&](int row) {
      const RayPacket packet = rays.around(CameraPlace(camera.base_from_camera), u, row, Lanes{}, Lanes{});
      const Light light = bench.shader.stripes(packet, bench.scene.all(packet), 1.f);
      const Lanes back = bench.shader.water().transmission(1, make_surface(packet, bench.scene.all(packet)).range);
      return double(light.radiance[1][0] / back[0]);
    };
    const double past = image->y() - v;
    return at(v) * (1 - past) + at(v + 1) * past;
  };
  for (const auto& [px, ratio] : {std::pair{12.0, 0.91}, std::pair{40.0, 0.74}}) {
    const double a = px * 0.00277;
    const double far_over_near = std::min(skirt(a), skirt(-a)) / std::max(skirt(a), skirt(-a));
    EXPECT_NEAR(far_over_near, ratio, 0.03) << px;
  }
}

TEST(Picture, GlowEndsWhereTheSheetMeetsSomething) {
  // A wall that stops the sheet halfway: beyond it no water is lit.
  const auto lit_water = [](bool wall) {
    scene::Scene bodies = scene::bare_scene();
    if (wall) body(bodies, arm5e_body::panel).shapes.push_back(make_shape(scene::ShapeKind::box, {0.3, 0.3, 0.01}, {0.6, 0, 0.2}));
    WaterConfig water;
    water.attenuation_per_m = 1;
    water.ambient_w_m2 = water.water_w_m2_sr = {0, 0, 0};
    Bench bench(bodies, water);
    bench.add(vehicle_laser(sheet({0.6, 0, 0.4}, -Vec3::UnitZ(), Vec3::UnitY())));
    bench.shader.sheets[0].meet(bench.scene);
    const CameraConfig camera = quiet_camera();
    const CameraRays rays(camera.intrinsics, camera.port);
    const auto glow = [&](int v) {
      return double(bench.shader.sheets[0]
                        .glow(rays.around(CameraPlace(camera.base_from_camera), 320, v, Lanes{}, Lanes{}), bench.water)
                        .radiance[1][0]);
    };
    return std::pair(glow(239 + 180), glow(239));  // above and below the wall, seen from its side
  };
  const auto [before, after] = lit_water(false);
  EXPECT_GT(before, 0);
  EXPECT_GT(after, 0);
  EXPECT_DOUBLE_EQ(lit_water(true).first, before);
  EXPECT_EQ(lit_water(true).second, 0);
}

TEST(Picture, SpeckleGivesTheLasersLightItsContrast) {
  StripeInWater s(0);
  s.config.lasers[0].waist_sigma_m = 0.02;  // ten pixels: an even field about its middle
  const auto contrast = [&](double speckle) {
    s.config.lasers[0].speckle = speckle;
    Optics optics(s.config);
    Shot shot = still_shot();
    shot.laser = 1;
    shot.gain = 0.5;
    const std::vector<double> mean = mean_of(optics, shot, 30);
    const auto row = static_cast<std::size_t>(240 * 640);
    double sum = 0, squares = 0;
    for (std::size_t u = 200; u < 440; ++u) sum += mean[row + u] / 240, squares += mean[row + u] * mean[row + u] / 240;
    EXPECT_GT(sum, 40);
    return std::sqrt(std::max(squares - sum * sum, 0.0)) / sum;
  };
  EXPECT_LT(contrast(0), 0.05);  // of the fan, and of rounding
  EXPECT_NEAR(contrast(0.18), 0.18, 0.03);
}

}  // namespace
}  // namespace lf::optics::test
