#include <gtest/gtest.h>

#include <random>

#include "tests/arm5e_bodies.hpp"
#include "tests/unit/world/world_fixture.hpp"

namespace lf::world {
namespace {

// A floating box that is pushed presses with its push, and for the window of the force's mean with its momentum: 4 kg at 0.2 m/s over 50 ms. On a rail it
// would be a wall to an arm that moves across.
TEST(Obstacle, PressesWithItsPushAndGivesWayToAnArmThatMoves) {
  constexpr double push_n = 80, momentum_n_s = 4 * 0.2, window_s = 0.05;
  const unsigned seed = 21;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto within = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  int met = 0;
  for (int k = 0; k < 40; ++k) {
    WorldConfig config = nominal_config();
    config.start_rad = {within(-0.3, 0.3), within(0.1, 1.1), within(0.6, 2.0), within(-1.5, 1.5), 0};
    config.base_from_panel.translation().x() += 1;  // out of the way
    World world(config);
    Script script(world, config.start_rad);
    script.run(0.1);
    ASSERT_EQ(world.contacts().peak_force_n, 0) << "draw " << k;
    world.push_obstacle();
    script.run(2);
    met += world.contacts().peak_force_n > 0;
    EXPECT_LT(world.contacts().peak_force_n, 1.1 * (push_n + momentum_n_s / window_s)) << "draw " << k;
    // An arm that moves against it pushes it away: against the water's 400 N s/m at up to 0.1 m/s.
    script.targets_rad[1] += within(-0.3, 0.3);
    script.targets_rad[2] += within(-0.3, 0.3);
    script.run(2);
    EXPECT_LT(world.contacts().peak_force_n, push_n + momentum_n_s / window_s + 40) << "draw " << k;
    // The panel is out of the way: what is touched is the obstacle, and nobody means to touch that.
    for (const UnintendedContact& touch : world.contacts().unintended) EXPECT_EQ(touch.b, arm5e_body::obstacle) << "draw " << k;
    EXPECT_EQ(world.contacts().unintended.empty(), world.contacts().peak_force_n == 0) << "draw " << k;
    EXPECT_NEAR(world.contacts().obstacle_force_n, world.contacts().largest_force_n, 1e-9) << "draw " << k;
  }
  EXPECT_GT(met, 20) << "seldom missed";
}

}  // namespace
}  // namespace lf::world
