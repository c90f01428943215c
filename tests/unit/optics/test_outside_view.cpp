// The picture for people shows what lights it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "host_sim/optics/outside_view.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/mission_scene.hpp"

namespace lf::optics::test {
namespace {

// The lamps' light hung in the water without a lamp.
TEST(OutsideView, ShowsEachLampThatItsCameraCanSee) {
  const MissionScene mission;
  const OutsideView view;
  const OpticsConfig config = outside_view(mission.config(), view);
  Optics optics(config);
  Shot shot;
  shot.poses = mission.poses({0, 0.8, 1.2, 0, 0.1}, 0, 0);
  shot.lamps = 1;
  shot.truth = true;
  Frame frame;
  optics.render(shot, frame);
  const Pose& camera = config.cameras[0].base_from_camera;
  const CameraIntrinsics& k = config.cameras[0].intrinsics;
  ASSERT_EQ(config.lamps.size(), 2u);
  int shown = 0;
  for (const LampConfig& lamp : config.lamps) {
    const Vec3 window = camera.inverse() * (lamp.body_from_lamp * Vec3(0, 0, -0.010));
    const auto u = std::lround(k.fx * window.x() / window.z() + k.cx), v = std::lround(k.fy * window.y() / window.z() + k.cy);
    if (window.z() <= 0 || u < 0 || u >= k.width || v < 0 || v >= k.height) continue;
    const std::size_t at = static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u);
    if (frame.depth_m[at] < window.z() - 0.06) continue;  // something is before it
    ++shown;
    EXPECT_EQ(frame.object[at], 1 + int(arm5e_body::vehicle)) << u << ", " << v;
    EXPECT_NEAR(frame.depth_m[at], window.z(), 0.06);
  }
  EXPECT_GE(shown, 1);
}

}  // namespace
}  // namespace lf::optics::test
