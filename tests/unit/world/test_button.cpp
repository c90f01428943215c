#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/world/bullet_world.hpp"
#include "host_sim/world/button_body.hpp"
#include "tests/arm5e_bodies.hpp"

namespace lf::world {
namespace {

constexpr double step_s = 0.001;

// A button alone, pressed by a force on its cap.
struct Bench {
  BulletWorld world{30, 0, scene::bare_scene()};
  ButtonConfig config;
  ButtonBody button{config, Pose::Identity(), {}, int(arm5e_body::first_feature + 2), step_s};

  Bench() { button.part().enter(world.get()); }
  ~Bench() { button.part().leave(world.get()); }

  void step(double force_n) {
    button.before_step();
    button.part().body().addJointTorque(0, force_n);
    world.step(step_s);
    button.after_step();
  }
  void run(double seconds, double force_n) {
    for (int i = 0; i < std::lround(seconds / step_s); ++i) step(force_n);
  }
};

TEST(Button, staysOutBelowItsPreload) {
  Bench bench;
  bench.run(1, 0.999 * bench.config.preload_n);
  EXPECT_NEAR(bench.button.state().depth_m, 0, 1e-9);
  EXPECT_TRUE(bench.button.at_rest());
}

TEST(Button, clicksAtTheForceOfItsPreloadAndSpringWithinOnePercent) {
  Bench bench;
  double force_n = 0;
  const double rate_n_s = 2;
  while (!bench.button.state().pressed && force_n < 100) {
    bench.step(force_n);
    force_n += rate_n_s * step_s;
  }
  const double expected_n = bench.config.preload_n + bench.config.spring_n_m * bench.config.click_depth_m;
  EXPECT_NEAR(force_n, expected_n, 0.01 * expected_n);
  EXPECT_EQ(bench.button.state().presses, 1u);
}

TEST(Button, settlesAtTheDepthWhereTheSpringBalancesThePress) {
  Bench bench;
  bench.run(2, 8);
  EXPECT_NEAR(bench.button.state().depth_m, (8 - bench.config.preload_n) / bench.config.spring_n_m, 1e-6);
  bench.run(2, 14);  // clicked: lighter by the drop, so deeper
  const double bottom =
      std::min(bench.config.stroke_m, (14 + bench.config.click_drop_n - bench.config.preload_n) / bench.config.spring_n_m);
  EXPECT_NEAR(bench.button.state().depth_m, bottom, 1e-6);
}

TEST(Button, neverPassesItsStroke) {
  Bench bench;
  for (int i = 0; i < 500; ++i) {
    bench.step(200);
    ASSERT_LE(bench.button.state().depth_m, bench.config.stroke_m + 1e-6);
  }
}

TEST(Button, countsOnePressUntilItHasComeBackPastTheReleaseDepth) {
  Bench bench;
  bench.run(0.5, 14);
  EXPECT_EQ(bench.button.state().presses, 1u);
  // Back to between release and click, and in again: still the same press.
  const double between_n = bench.config.preload_n - bench.config.click_drop_n + bench.config.spring_n_m * 0.003;
  bench.run(0.5, between_n);
  EXPECT_NEAR(bench.button.state().depth_m, 0.003, 1e-5);
  EXPECT_TRUE(bench.button.state().pressed);
  bench.run(0.5, 14);
  EXPECT_EQ(bench.button.state().presses, 1u);
  bench.run(0.5, 0);
  EXPECT_FALSE(bench.button.state().pressed);
  EXPECT_NEAR(bench.button.state().depth_m, 0, 1e-9);
  bench.run(0.5, 14);
  EXPECT_EQ(bench.button.state().presses, 2u);
}

}  // namespace
}  // namespace lf::world
