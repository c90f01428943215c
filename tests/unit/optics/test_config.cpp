#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "shared/input_error.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

OpticsConfig good() {
  OpticsConfig config;
  config.cameras.push_back(quiet_camera());
  config.cameras[0].intrinsics.width = 32, config.cameras[0].intrinsics.height = 24;
  config.lasers.push_back(vehicle_laser(Pose::Identity()));
  config.lamps.push_back(LampConfig{});
  config.scene = plate_scene(0.5);
  return config;
}

TEST(OpticsConfig, EveryNonsenseIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(OpticsConfig&)>> nonsense{
      [](OpticsConfig& c) { c.cameras.clear(); },
      [](OpticsConfig& c) { c.cameras[0].intrinsics.width = 0; },
      [](OpticsConfig& c) { c.cameras[0].intrinsics.fx = -1; },
      [nan](OpticsConfig& c) { c.cameras[0].intrinsics.distortion[2] = nan; },
      [nan](OpticsConfig& c) { c.cameras[0].base_from_camera.translation().x() = nan; },
      [](OpticsConfig& c) { c.cameras[0].base_from_camera.linear() *= 2; },
      [](OpticsConfig& c) { c.cameras[0].read_noise_grey = -1; },
      [](OpticsConfig& c) { c.cameras[0].exposure = Duration::from_ns(-1); },
      [nan](OpticsConfig& c) { c.cameras[0].port = FlatPort{.distance_m = nan}; },
      [](OpticsConfig& c) { c.lasers[0].fan_half_angle_rad = 2; },
      [nan](OpticsConfig& c) { c.lasers[0].power_w = nan; },
      [](OpticsConfig& c) { c.lasers[0].body = 99; },
      [](OpticsConfig& c) {
        c.lasers[0].pattern = Pattern{.width = 4, .height = 4, .fx = 1, .fy = 1, .lit = {1, 2}};
      },
      [](OpticsConfig& c) { c.lamps[0].intensity_w_sr[0] = -1; },
      [](OpticsConfig& c) { c.water.attenuation_per_m = -0.1; },
      [](OpticsConfig& c) { c.water.asymmetry = 1; },
      [](OpticsConfig& c) { c.threads = 0; },
      [](OpticsConfig& c) { body(c.scene, arm5e_body::panel).shapes[0].albedo[1] = 1.5f; },
      [](OpticsConfig& c) { body(c.scene, arm5e_body::panel).shapes[0].marker_id = 5; },
  };
  EXPECT_NO_THROW(Optics{good()});
  for (std::size_t i = 0; i < nonsense.size(); ++i) {
    OpticsConfig config = good();
    nonsense[i](config);
    EXPECT_THROW(Optics{config}, InputError) << "case " << i;
  }
}

TEST(OpticsConfig, AShotOfNoCameraOrAtNoPlaceIsRefused) {
  Optics optics(good());
  Frame frame;
  Shot shot;
  shot.poses = resting();
  shot.camera = 1;
  EXPECT_THROW(optics.render(shot, frame), std::out_of_range);
  shot.camera = 0;
  shot.poses[3].translation().z() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(optics.render(shot, frame), InputError);
}

TEST(OpticsConfig, OddImageSizesAndColourRenderWhole) {
  for (const int width : {1, 7, 8, 33}) {
    OpticsConfig config = good();
    config.cameras[0].intrinsics.width = width;
    config.cameras[0].intrinsics.height = 5;
    config.cameras[0].colour = true;
    Optics optics(config);
    Shot shot;
    shot.poses = resting();
    shot.lamps = shot.truth = true;
    Frame frame;
    optics.render(shot, frame);
    EXPECT_EQ(frame.channels, 3);
    EXPECT_EQ(frame.pixels.size(), static_cast<std::size_t>(width * 5 * 3));
    EXPECT_EQ(frame.depth_m.size(), static_cast<std::size_t>(width * 5));
  }
}

}  // namespace
}  // namespace lf::optics::test
