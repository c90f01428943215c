#include <gtest/gtest.h>

#include <algorithm>

#include "host_sim/optics/sensor.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

struct Moments {
  double mean, variance;
};

Moments exposed(const CameraConfig& camera, float grey, std::uint64_t key) {
  const std::size_t count = 200'000;
  const std::vector<float> in(count, grey);
  std::vector<std::uint8_t> out(count);
  Sensor(camera).expose(in.data(), out.data(), count, 0, key);
  double sum = 0, squares = 0;
  for (const std::uint8_t value : out) sum += value, squares += double(value) * value;
  return {sum / count, squares / count - sum / count * sum / count};
}

TEST(Sensor, NoiseHasTheMeanAndVarianceThatWereAskedFor) {
  CameraConfig camera;
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
  CameraConfig camera;
  camera.electrons_per_grey = 0;
  camera.read_noise_grey = 1.5;
  camera.gain = 2;
  EXPECT_NEAR(exposed(camera, 100, 5).variance, 9 + 1.0 / 12, 0.2);
  CameraConfig single = camera;
  single.gain = 1;
  EXPECT_FLOAT_EQ(Sensor(camera).grey_per_radiance(), 2 * Sensor(single).grey_per_radiance());
}

TEST(Sensor, ClipsAtBothEnds) {
  CameraConfig camera;
  EXPECT_DOUBLE_EQ(exposed(camera, 400, 1).mean, 255);
  EXPECT_DOUBLE_EQ(exposed(camera, -50, 1).mean, 0);
}

TEST(Sensor, NeighbouringPixelsAndFramesAreUncorrelated) {
  CameraConfig camera;
  camera.read_noise_grey = 3;
  camera.electrons_per_grey = 0;
  const std::size_t count = 200'000;
  const std::vector<float> in(count, 128.f);
  std::vector<std::uint8_t> a(count), b(count);
  Sensor(camera).expose(in.data(), a.data(), count, 0, noise_key(3, 0, 10));
  Sensor(camera).expose(in.data(), b.data(), count, 0, noise_key(3, 0, 11));
  double along = 0, between = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    along += (a[i] - 128.0) * (a[i + 1] - 128.0);
    between += (a[i] - 128.0) * (b[i] - 128.0);
  }
  EXPECT_LT(std::abs(along / count / 9), 0.01);  // 4.5 sigma of the estimate
  EXPECT_LT(std::abs(between / count / 9), 0.01);
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
  body(config.scene, scene::BodyId::handle).shapes.push_back(make_shape(scene::ShapeKind::cylinder, {0.03, 0, 0.3}, {0.55, 0.05, 0}));
  config.lasers.push_back(vehicle_laser(sheet({0, 0.2, 0.4}, Vec3(0.7, -0.2, -0.4), Vec3::UnitY())));
  config.lamps.push_back(LampConfig{});
  config.lamps[0].body_from_lamp = looking({0, 0.3, 0}, {1, -0.4, 0});
  config.seed = 42;
  config.threads = threads;
  return config;
}

Frame shoot(Optics& optics, std::uint64_t frame_number) {
  Shot shot;
  shot.poses = resting();
  shot.lamps = true;
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
