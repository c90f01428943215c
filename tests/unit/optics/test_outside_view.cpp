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

// A long arm and its panel are in the picture as the default ones are.
TEST(OutsideView, HasThePanelAndTheArmsBaseInIt) {
  const MissionScene mission;
  for (const Vec3& panel_m :
       {Vec3(0.44, 0, 0.592), Vec3(0.75, 0, 0.35), Vec3(1.3, 0, 0.2), Vec3(1.6, 0, 0), Vec3(1.6, 0.3, -0.3), Vec3(0.3, 0, 0.3)}) {
    const OpticsConfig config = outside_view(mission.config(), OutsideView::of_panel(panel_m));
    const CameraIntrinsics& k = config.cameras[0].intrinsics;
    for (const Vec3& seen_m : {panel_m, Vec3(0, 0, 0)}) {
      const Vec3 at = config.cameras[0].base_from_camera.inverse() * seen_m;
      ASSERT_GT(at.z(), 0);
      EXPECT_LT(std::abs(k.fx * at.x() / at.z()), 0.5 * k.width) << panel_m.transpose();
      EXPECT_LT(std::abs(k.fy * at.y() / at.z()), 0.5 * k.height) << panel_m.transpose();
    }
  }
}

}  // namespace
}  // namespace lf::optics::test
