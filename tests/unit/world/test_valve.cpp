#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/world/bullet_world.hpp"
#include "host_sim/world/valve_body.hpp"
#include "shared/panel/panel_layout.hpp"
#include "tests/arm5e_bodies.hpp"

namespace lf::world {
namespace {

constexpr double step_s = 0.001;

// The valve alone, turned by a torque on its shaft.
struct Bench {
  BulletWorld world{30, 0, scene::bare_scene()};
  ValveBody valve;

  explicit Bench(const ValveConfig& config)
      : valve(config, PanelLayout().nominal_base_from_panel(), {}, int(arm5e_body::first_feature), step_s) {
    valve.part().enter(world.get());
  }
  ~Bench() { valve.part().leave(world.get()); }

  void run(double seconds, double torque_nm) {
    for (int i = 0; i < std::lround(seconds / step_s); ++i) {
      valve.before_step();
      valve.part().body().addJointTorque(0, torque_nm);
      world.step(step_s);
    }
  }
};

ValveConfig plain() {
  ValveConfig config;
  config.viscous_nm_s = 0;
  config.detents_rad.clear();
  return config;
}

TEST(Valve, holdsBelowItsFrictionTorqueAndTurnsAboveIt) {
  for (const double friction : {0.5, 1.5, 3.0}) {
    SCOPED_TRACE(friction);
    ValveConfig config = plain();
    config.friction_nm = friction;
    config.start_rad = -1.5;
    Bench held(config);
    held.run(1.0, 0.999 * friction);
    EXPECT_NEAR(held.valve.angle_rad(), config.start_rad, 1e-9);
    EXPECT_TRUE(held.valve.at_rest());

    Bench turned(config);
    const double excess = 0.002;
    turned.run(0.5, friction + excess);
    EXPECT_NEAR(turned.valve.speed_rad_s(), excess / config.inertia_kg_m2 * 0.5, 1e-6);
    EXPECT_NEAR(turned.valve.angle_rad() - config.start_rad, 0.5 * excess / config.inertia_kg_m2 * 0.25, 1e-3);
  }
}

TEST(Valve, slowsByItsFrictionAndStopsWithoutTurningBack) {
  ValveConfig config = plain();
  config.friction_nm = 0.5;
  Bench bench(config);
  const double speed = 5;
  bench.valve.part().body().setJointVel(0, speed);
  const double deceleration = config.friction_nm / config.inertia_kg_m2;
  const double stop_s = speed / deceleration;  // 10 ms
  bench.run(0.5 * stop_s, 0);
  EXPECT_NEAR(bench.valve.speed_rad_s(), 0.5 * speed, 1e-9);
  bench.run(0.1, 0);
  EXPECT_EQ(bench.valve.speed_rad_s(), 0);
  EXPECT_NEAR(bench.valve.angle_rad(), 0.5 * speed * stop_s, speed * step_s);
}

TEST(Valve, reachesTheSpeedWhereViscousAndDryFrictionBalanceTheTorque) {
  ValveConfig config = plain();
  config.viscous_nm_s = 0.05;
  config.start_rad = -1.5;
  Bench bench(config);
  bench.run(0.5, config.friction_nm + 0.05);
  const double time_constant_s = config.inertia_kg_m2 / config.viscous_nm_s;
  EXPECT_NEAR(bench.valve.speed_rad_s(), 1 - std::exp(-0.5 / time_constant_s), 1e-3);
}

// Twenty newton metres a radian per second brake such a shaft within 50 us, and the step has a millisecond.
TEST(Valve, turnsSteadilyWhereItsViscousFrictionIsStiffForTheStep) {
  for (const double viscous_nm_s : {2.0, 5.0, 20.0}) {
    ValveConfig config = plain();
    config.viscous_nm_s = viscous_nm_s;
    config.start_rad = -1.5;
    Bench bench(config);
    for (int i = 0; i < 100; ++i) {
      bench.run(step_s, config.friction_nm + 3);
      EXPECT_NEAR(bench.valve.speed_rad_s(), 3 / viscous_nm_s, i < 10 ? 1.5 : 1e-4) << viscous_nm_s << ", step " << i;
    }
    bench.run(0.1, 0);
    EXPECT_NEAR(bench.valve.speed_rad_s(), 0, 1e-20);
  }
}

TEST(Valve, endStopsHoldAnyTorque) {
  ValveConfig config = plain();
  Bench bench(config);
  bench.run(2.0, 50);
  EXPECT_NEAR(bench.valve.angle_rad(), config.stop_max_rad, 1e-6);
  bench.run(2.0, -50);
  EXPECT_NEAR(bench.valve.angle_rad(), config.stop_min_rad, 1e-6);
}

TEST(Valve, detentAddsToTheFrictionOnBothSidesOfItsPosition) {
  ValveConfig config = plain();
  config.friction_nm = 0.5;
  config.viscous_nm_s = 0.05;
  config.detents_rad = {0};
  config.detent_nm = 0.3;
  for (const double side : {-1.0, 1.0}) {
    Bench bench(config);
    double torque_nm = 0;
    while (std::abs(bench.valve.angle_rad()) < config.detent_width_rad && torque_nm < 10) {
      bench.run(step_s, side * torque_nm);
      if (std::abs(bench.valve.angle_rad()) < 0.5 * config.detent_width_rad)
        torque_nm += 0.05 * step_s;  // up to the detent's strongest pull
    }
    EXPECT_NEAR(torque_nm, config.friction_nm + config.detent_nm, 0.01 * (config.friction_nm + config.detent_nm));
  }
}

TEST(Valve, detentPullsIntoItsPositionOnceItOvercomesTheFriction) {
  ValveConfig config = plain();
  config.friction_nm = 0.02;
  config.viscous_nm_s = 0.02;
  config.detents_rad = {0.5};
  config.start_rad = 0.5 - 0.5 * config.detent_width_rad;
  Bench bench(config);
  bench.run(3.0, 0);
  const double held_within = std::asin(config.friction_nm / config.detent_nm) / pi * config.detent_width_rad;
  EXPECT_NEAR(bench.valve.angle_rad(), 0.5, held_within + 1e-6);
  EXPECT_TRUE(bench.valve.at_rest());
}

}  // namespace
}  // namespace lf::world
