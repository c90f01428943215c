#include <gtest/gtest.h>

#include <algorithm>

#include "host_sim/optics/sensor.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

constexpr int rows = 400, columns = 500;

CameraConfig plain_camera() {
  CameraConfig camera = lossless({});
  camera.intrinsics.width = columns, camera.intrinsics.height = rows;
  return camera;
}

std::vector<std::uint8_t> picture(const CameraConfig& camera, float grey, const Exposing& exposing) {
  const std::vector<float> in(columns, grey);
  std::vector<std::uint8_t> out(static_cast<std::size_t>(rows) * columns);
  const Sensor sensor(camera);
  for (int v = 0; v < rows; ++v) sensor.expose(in.data(), v, exposing, out.data() + static_cast<std::size_t>(v) * columns);
  return out;
}

struct Moments {
  double mean = 0, variance = 0;
};

Moments moments(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double value : values) sum += value, squares += value * value;
  const auto count = static_cast<double>(values.size());
  return {sum / count, squares / count - sum / count * sum / count};
}

Moments exposed(const CameraConfig& camera, float grey, std::uint64_t key) {
  const std::vector<std::uint8_t> out = picture(camera, grey, {.key = key});
  return moments({out.begin(), out.end()});
}

// The mean of many frames of an even field: what is left is the fixed pattern.
std::vector<double> mean_picture(const CameraConfig& camera, float grey, std::uint64_t seed = 1) {
  constexpr std::uint64_t frames = 30;
  std::vector<double> mean(static_cast<std::size_t>(rows) * columns);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const std::vector<std::uint8_t> out = picture(camera, grey, {.key = noise_key(seed, 0, frame)});
    for (std::size_t i = 0; i < out.size(); ++i) mean[i] += double(out[i]) / frames;
  }
  return mean;
}

TEST(Sensor, NoiseHasTheMeanAndVarianceThatWereAskedFor) {
  CameraConfig camera = plain_camera();
  camera.gain = 1;
  for (const double read : {1.0, 2.0, 3.0}) {
    for (const float grey : {30.f, 120.5f, 200.f}) {
      camera.read_noise_grey = read;
      camera.electrons_per_grey = 40;
      const Moments m = exposed(camera, grey, 77);
      const double variance = read * read + grey / 40 + 1.0 / 12;  // rounding adds 1/12
      EXPECT_NEAR(m.mean, grey, 4 * std::sqrt(variance / 200'000));
      EXPECT_NEAR(m.variance, variance, 0.02 * variance);
    }
  }
}

TEST(Sensor, GainScalesSignalAndReadNoiseAlike) {
  CameraConfig camera = plain_camera();
  camera.electrons_per_grey = 0;
  camera.read_noise_grey = 1.5;
  camera.gain = 2;
  EXPECT_NEAR(exposed(camera, 100, 5).variance, 9 + 1.0 / 12, 0.2);
  CameraConfig single = camera;
  single.gain = 1;
  EXPECT_FLOAT_EQ(Sensor(camera).grey_per_radiance(), 2 * Sensor(single).grey_per_radiance());
  // Ordered for one picture it does the same.
  const std::vector<std::uint8_t> ordered = picture(single, 50, {.light = 2, .gain = 2, .key = 5});
  const Moments m = moments({ordered.begin(), ordered.end()});
  EXPECT_NEAR(m.mean, 100, 0.05);
  EXPECT_NEAR(m.variance, 9 + 1.0 / 12, 0.2);
}

TEST(Sensor, ALongerExposureHasMoreLightAndNoMoreReadNoise) {
  CameraConfig camera = plain_camera();
  camera.read_noise_grey = 1.5;
  camera.electrons_per_grey = 40;
  const std::vector<std::uint8_t> longer = picture(camera, 50, {.light = 2, .key = 5});
  const Moments m = moments({longer.begin(), longer.end()});
  EXPECT_NEAR(m.mean, 100, 0.05);
  EXPECT_NEAR(m.variance, 2.25 + 100.0 / 40 + 1.0 / 12, 0.15);
}

TEST(Sensor, ClipsAtBothEnds) {
  EXPECT_DOUBLE_EQ(exposed(plain_camera(), 400, 1).mean, 255);
  EXPECT_DOUBLE_EQ(exposed(plain_camera(), -50, 1).mean, 0);
}

TEST(Sensor, NeighbouringPixelsAndFramesAreUncorrelated) {
  CameraConfig camera = plain_camera();
  camera.read_noise_grey = 3;
  camera.electrons_per_grey = 0;
  const std::vector<std::uint8_t> a = picture(camera, 128, {.key = noise_key(3, 0, 10)}),
                                  b = picture(camera, 128, {.key = noise_key(3, 0, 11)});
  double along = 0, between = 0;
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    along += (a[i] - 128.0) * (a[i + 1] - 128.0);
    between += (a[i] - 128.0) * (b[i] - 128.0);
  }
  EXPECT_LT(std::abs(along / double(a.size()) / 9), 0.01);  // 4.5 sigma of the estimate
  EXPECT_LT(std::abs(between / double(a.size()) / 9), 0.01);
}

TEST(Sensor, FixedPatternHasItsSpreadAndStaysWithTheCamera) {
  CameraConfig camera = plain_camera();
  camera.read_noise_grey = 1.5;
  camera.prnu = 0.01;
  const std::vector<double> bright = mean_picture(camera, 180);
  EXPECT_NEAR(std::sqrt(moments(bright).variance), 1.8, 0.1);  // a hundredth, and what 30 frames leave of the noise
  camera.prnu = 0;
  camera.dsnu_grey = 1;
  const std::vector<double> dark = mean_picture(camera, 20);
  EXPECT_NEAR(std::sqrt(moments(dark).variance), 1, 0.1);
  camera.serial = 2;
  const std::vector<double> other = mean_picture(camera, 20, 2);
  double both = 0;
  for (std::size_t i = 0; i < dark.size(); ++i) both += (dark[i] - 20) * (other[i] - 20);
  EXPECT_LT(std::abs(both / double(dark.size())), 0.02);
}

TEST(Sensor, RowNoiseIsCommonToARowAndNewInEachFrame) {
  CameraConfig camera = plain_camera();
  camera.read_noise_grey = 1;
  camera.row_noise_grey = 0.8;
  std::vector<double> means[2];
  for (std::uint64_t frame = 0; frame < 2; ++frame) {
    const std::vector<std::uint8_t> out = picture(camera, 100, {.key = noise_key(1, 0, frame)});
    for (int v = 0; v < rows; ++v) {
      double sum = 0;
      for (int u = 0; u < columns; ++u) sum += out[static_cast<std::size_t>(v) * columns + static_cast<std::size_t>(u)];
      means[frame].push_back(sum / columns - 100);
    }
    EXPECT_NEAR(std::sqrt(moments(means[frame]).variance), 0.8, 0.1);
  }
  double both = 0;
  for (std::size_t v = 0; v < rows; ++v) both += means[0][v] * means[1][v] / rows;
  EXPECT_LT(std::abs(both), 0.1);
}

TEST(Sensor, HotPixelsAreAsManyAsAskedFor) {
  CameraConfig camera = plain_camera();
  camera.hot_pixels = 1e-3;
  const std::vector<std::uint8_t> out = picture(camera, 20, {.key = 1});
  EXPECT_NEAR(std::count_if(out.begin(), out.end(), [](std::uint8_t grey) { return grey > 36; }), 200 * 0.98,
              45);  // 3 sigma of a count of 200
}

TEST(Sensor, CornersHaveTheLensesShareOfTheLight) {
  CameraConfig camera = plain_camera();
  camera.read_noise_grey = 0.5;
  camera.corner_light = 0.6;
  const std::vector<double> mean = mean_picture(camera, 200);
  EXPECT_NEAR(mean.front(), 120, 1.5);
  EXPECT_NEAR(mean[static_cast<std::size_t>(rows / 2) * columns + columns / 2], 200, 1.5);
}

TEST(Sensor, KeyDependsOnSeedCameraAndFrame) {
  const std::vector<std::uint64_t> keys{noise_key(1, 0, 0), noise_key(2, 0, 0), noise_key(1, 1, 0), noise_key(1, 0, 1), noise_key(0, 1, 0)};
  for (std::size_t i = 0; i < keys.size(); ++i) EXPECT_EQ(std::count(keys.begin(), keys.end(), keys[i]), 1);
}

OpticsConfig busy_config(int threads) {
  OpticsConfig config;
  config.cameras.push_back(CameraConfig{});
  config.cameras[0].base_from_camera = looking(Vec3::Zero(), Vec3::UnitX());
  config.scene = plate_scene(0.7);
  config.scene[arm5e_body::first_feature].shapes.push_back(make_shape(scene::ShapeKind::cylinder, {0.03, 0, 0.3}, {0.55, 0.05, 0}));
  config.lasers.push_back(vehicle_laser(sheet({0, 0.2, 0.4}, Vec3(0.7, -0.2, -0.4), Vec3::UnitY())));
  config.lamps.push_back(LampConfig{});
  config.lamps[0].body_from_lamp = looking({0, 0.3, 0}, {1, -0.4, 0});
  config.seed = 42;
  config.water.particles_per_l = 2;
  config.threads = threads;
  return config;
}

Frame shoot(Optics& optics, std::uint64_t frame_number) {
  Shot shot;
  shot.poses = resting();
  shot.lamps = 1;
  shot.truth = true;
  shot.frame_number = frame_number;
  Frame frame;
  optics.render(shot, frame);
  return frame;
}

bool same_floats(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(Determinism, OneTwoAndThreeThreadsAndASecondRunGiveTheSameBytes) {
  Optics one(busy_config(1)), two(busy_config(2)), three(busy_config(3));
  const Frame reference = shoot(one, 9);
  for (Optics* other : {&two, &three, &one}) {
    const Frame frame = shoot(*other, 9);
    EXPECT_EQ(frame.pixels, reference.pixels);
    EXPECT_TRUE(same_floats(frame.depth_m, reference.depth_m));
    EXPECT_TRUE(same_floats(frame.stripe_v, reference.stripe_v));
  }
}

TEST(Determinism, AnotherFrameNumberOrSeedGivesOtherNoise) {
  Optics optics(busy_config(1));
  const Frame reference = shoot(optics, 9);
  EXPECT_NE(shoot(optics, 10).pixels, reference.pixels);
  OpticsConfig other = busy_config(1);
  other.seed = 43;
  Optics reseeded(other);
  EXPECT_NE(shoot(reseeded, 9).pixels, reference.pixels);
}

}  // namespace
}  // namespace lf::optics::test
