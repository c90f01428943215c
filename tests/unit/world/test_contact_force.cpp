#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "host_sim/world/contact_force.hpp"
#include "host_sim/world/contact_sensor.hpp"
#include "host_sim/world/fixed_base_solver.hpp"
#include "shared/input_error.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/world/sliding_rig.hpp"

namespace lf::world {
namespace {

using scene::BodyId;

constexpr int iterations = 200;
constexpr double gravity_m_s2 = 9.81;
constexpr auto handle = arm5e_body::first_feature;

struct Collision {
  double restitution, window_s, step_s;
};

// The largest windowed force, and the time integral of all of it.
struct Measured {
  double peak_n = 0;
  double impulse_n_s = 0;
};

// Bodies that stick leave at the speed that takes them out of their overlap; those that bounce, exactly.
double slack_m_s(double restitution) { return restitution > 0 ? 1e-7 : 1.001 * FixedBaseSolver::push_out_m_s; }

class StepRates : public testing::TestWithParam<double> {};

template <typename BeforeStep>
Measured measure(BulletWorld& world, const Collision& collision, double seconds, BodyId body, BeforeStep before_step) {
  ForceWindow window(collision.window_s, collision.step_s);
  std::vector<ContactImpulse> impulses;
  Measured measured;
  for (int i = 0; i < std::lround(seconds / collision.step_s); ++i) {
    before_step();
    world.step(collision.step_s);
    take_contact_impulses(*world.get().getDispatcher(), impulses);
    Wrench step;
    for (const ContactImpulse& contact : impulses) step.force_n += contact.a == body ? contact.impulse_n_s : Vec3(-contact.impulse_n_s);
    window.add(step);
    measured.impulse_n_s += step.force_n.norm();
    measured.peak_n = std::max(measured.peak_n, window.mean().force_n.norm());
  }
  return measured;
}

// A 189 kg vehicle at 0.2 m/s onto a fixed structure: m dv / t is 1890 N over 20 ms and 756 N over 50 ms when nothing bounces.
TEST_P(StepRates, collisionWithAFixedStructureGivesMassTimesSpeedChangeOverTheWindow) {
  const double step_s = 1 / GetParam();
  for (const double window_s : {0.020, 0.050}) {
    for (const double restitution : {0.0, 0.5, 1.0}) {
      SCOPED_TRACE(testing::Message() << GetParam() << " Hz, window " << window_s << " s, e " << restitution);
      const double mass_kg = 189;
      const double speed_m_s = 0.2;
      BulletWorld world(iterations, restitution, scene::bare_scene());
      Sled sled(world, mass_kg, box_body(Vec3(0.4, 0.4, 0.4)), Pose::Identity());
      Wall wall(world, box_body(Vec3(1, 1, 0.2)), Pose(Eigen::Translation3d(0, 0, -0.3 - 0.0113)));
      sled.set_speed(Vec3(0, 0, -speed_m_s));
      const Measured measured = measure(world, {restitution, window_s, step_s}, 0.2, arm5e_body::finger_a, [] {});
      const double impulse_n_s = (1 + restitution) * mass_kg * speed_m_s;
      const double slack = slack_m_s(restitution);
      EXPECT_NEAR(measured.impulse_n_s, impulse_n_s, mass_kg * slack);
      EXPECT_NEAR(measured.peak_n, impulse_n_s / window_s, mass_kg * slack / window_s);
      EXPECT_NEAR(sled.speed_m_s().z(), restitution * speed_m_s, slack);
    }
  }
}

TEST_P(StepRates, collisionOfTwoBodiesGivesTheReducedMassTimesSpeedChangeOverTheWindow) {
  const double step_s = 1 / GetParam();
  for (const double restitution : {0.0, 0.5, 1.0}) {
    SCOPED_TRACE(testing::Message() << GetParam() << " Hz, e " << restitution);
    const double m1 = 3, m2 = 5, v1 = 0.3, v2 = -0.1;
    BulletWorld world(iterations, restitution, scene::bare_scene());
    Sled first(world, m1, box_body(Vec3(0.1, 0.1, 0.1)), Pose::Identity(), arm5e_body::finger_a);
    Sled second(world, m2, box_body(Vec3(0.1, 0.1, 0.1)), Pose(Eigen::Translation3d(0.1153, 0, 0)), handle);
    first.set_speed(Vec3(v1, 0, 0));
    second.set_speed(Vec3(v2, 0, 0));
    const Measured measured = measure(world, {restitution, 0.020, step_s}, 0.2, arm5e_body::finger_a, [] {});
    const double impulse_n_s = (1 + restitution) * (v1 - v2) / (1 / m1 + 1 / m2);
    const double slack = slack_m_s(restitution);
    EXPECT_NEAR(measured.peak_n, impulse_n_s / 0.020, m1 * slack / 0.020);
    EXPECT_NEAR(first.speed_m_s().x(), v1 - impulse_n_s / m1, slack);
    EXPECT_NEAR(second.speed_m_s().x(), v2 + impulse_n_s / m2, slack);
  }
}

// A lever of inertia I at speed w meets a wall at the distance r of its axis: the torque's impulse is (1 + e) I w, the force's that over r.
TEST_P(StepRates, collisionOfALeverUsesItsInertia) {
  const double step_s = 1 / GetParam();
  for (const double restitution : {0.0, 0.5, 1.0}) {
    SCOPED_TRACE(testing::Message() << GetParam() << " Hz, e " << restitution);
    const double inertia = 0.8, speed_rad_s = 0.5, arm_m = 0.45;
    BulletWorld world(iterations, restitution, scene::bare_scene());
    MultibodyPart lever(1, Pose::Identity());
    lever.body().setupRevolute(0, 1, btVector3(inertia, inertia, inertia), -1, btQuaternion::getIdentity(), btVector3(0, 0, 1),
                               btVector3(0, 0, 0), btVector3(0, 0, 0), false);
    lever.finish_links();
    lever.add_collider(-1, make_collision_shape({}, Pose::Identity()), no_body, Friction::anchored);
    scene::Body tip;
    tip.shapes.resize(1);
    tip.shapes[0].kind = scene::ShapeKind::sphere;
    tip.shapes[0].size_m = Vec3(0.02, 0, 0);
    tip.shapes[0].friction = 0;
    tip.shapes[0].body_from_shape.translation() = Vec3(arm_m, 0, 0);
    lever.add_collider(0, make_collision_shape(tip, Pose::Identity()), int(arm5e_body::finger_a), Friction::anchored);
    lever.update_poses();
    lever.enter(world.get());
    Wall wall(world, box_body(Vec3(1, 0.1, 1), Pose::Identity(), 0), Pose(Eigen::Translation3d(arm_m, 0.07 + 0.002, 0)));
    lever.body().setJointVel(0, speed_rad_s);
    const Measured measured = measure(world, {restitution, 0.020, step_s}, 0.1, arm5e_body::finger_a, [] {});
    const double force_n = (1 + restitution) * inertia * speed_rad_s / arm_m / 0.020;
    EXPECT_NEAR(measured.peak_n, force_n, 3e-3 * force_n);  // push-out, and the tip meets the wall 2 mm round the circle: r cos(0.0044 rad)
    EXPECT_NEAR(lever.body().getJointVel(0), -restitution * speed_rad_s, 2e-3 * speed_rad_s + slack_m_s(restitution) / arm_m);
    lever.leave(world.get());
  }
}

TEST_P(StepRates, weightAtRestReadsAsWeight) {
  const double step_s = 1 / GetParam();
  for (const double restitution : {0.0, 0.5}) {
    SCOPED_TRACE(testing::Message() << GetParam() << " Hz, e " << restitution);
    BulletWorld world(iterations, restitution, scene::bare_scene());
    Sled sled(world, 20, box_body(Vec3(0.4, 0.4, 0.4)), Pose::Identity());
    Wall wall(world, box_body(Vec3(1, 1, 0.2)), Pose(Eigen::Translation3d(0, 0, -0.3)));
    const auto weigh = [&] { sled.push(Vec3(0, 0, -20 * gravity_m_s2)); };
    measure(world, {restitution, 0.020, step_s}, 0.3, arm5e_body::finger_a, weigh);
    const Measured measured = measure(world, {restitution, 0.020, step_s}, 0.1, arm5e_body::finger_a, weigh);
    EXPECT_NEAR(measured.peak_n, 20 * gravity_m_s2, 0.002);
  }
}

// A body that falls from h bounces to e^2 h, and then to e^4 h. It is met within a step of the surface, v dt deep at most, and starts from there.
TEST_P(StepRates, aDroppedBodyBouncesToTheSquareOfTheRestitution) {
  const double step_s = 1 / GetParam();
  for (const double restitution : {0.4, 0.7, 0.9}) {
    SCOPED_TRACE(testing::Message() << GetParam() << " Hz, e " << restitution);
    const double height_m = 0.4, mass_kg = 3, bottom_m = -0.05;
    BulletWorld world(iterations, restitution, scene::bare_scene());
    Sled sled(world, mass_kg, box_body(Vec3(0.1, 0.1, 0.1)), Pose::Identity());
    Wall wall(world, box_body(Vec3(1, 1, 0.2)), Pose(Eigen::Translation3d(0, 0, bottom_m - height_m - 0.1)));
    std::vector<double> tops_m;
    double speed_m_s = 0;
    for (int i = 0; i < std::lround(3 / step_s) && tops_m.size() < 2; ++i) {
      sled.push(Vec3(0, 0, -mass_kg * gravity_m_s2));
      world.step(step_s);
      const double before_m_s = speed_m_s;
      speed_m_s = sled.speed_m_s().z();
      if (before_m_s > 0 && speed_m_s <= 0) tops_m.push_back(height_m + sled.position_m().z());
    }
    ASSERT_EQ(tops_m.size(), 2U);
    const double step_m = std::sqrt(2 * gravity_m_s2 * height_m) * step_s;
    EXPECT_NEAR(tops_m[0], std::pow(restitution, 2) * height_m, step_m);
    EXPECT_NEAR(tops_m[1], std::pow(restitution, 4) * height_m, 2 * step_m);
  }
}

// What begins inside a wall, or was driven into it, comes out and does not jump. The last of it, as deep as a blow of one step, comes out at
// the push-out's speed; what is deeper, in some `recovery_s`.
TEST_P(StepRates, aBodyInPenetrationComesOutWithAnyRestitution) {
  const double step_s = 1 / GetParam();
  const double seconds = 10 * FixedBaseSolver::recovery_s + 1.2 * FixedBaseSolver::blow_m_s * step_s / FixedBaseSolver::push_out_m_s;
  for (const double restitution : {0.0, 0.5, 1.0}) {
    for (const double depth_m : {0.0002, 0.005}) {
      SCOPED_TRACE(testing::Message() << GetParam() << " Hz, e " << restitution << ", " << depth_m << " m deep");
      BulletWorld world(iterations, restitution, scene::bare_scene());
      Sled sled(world, 3, box_body(Vec3(0.1, 0.1, 0.1)), Pose::Identity());
      Wall wall(world, box_body(Vec3(1, 1, 0.2)), Pose(Eigen::Translation3d(0, 0, depth_m - 0.15)));
      double highest_m = 0;
      for (int i = 0; i < std::lround(seconds / step_s); ++i) {
        sled.push(Vec3(0, 0, -3 * gravity_m_s2));
        world.step(step_s);
        highest_m = std::max(highest_m, sled.position_m().z());
      }
      EXPECT_NEAR(sled.position_m().z(), depth_m, 1e-5);
      EXPECT_LE(highest_m, depth_m + 1e-5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(From200HzTo2kHz, StepRates, testing::Values(200.0, 500.0, 1000.0, 2000.0));

// Slope angles about a direction that is not one of the friction rows', so that a pyramid would be found out.
TEST(FrictionCone, holdsBelowItsAngleAndSlidesWithTheRestAboveIt) {
  const double mu = 0.5, mass_kg = 2, gravity = 9.81, step_s = 0.001;
  for (const double heading_deg : {0.0, 22.5, 45.0, 70.0}) {
    for (const double slope_deg : {15.0, 25.0, 28.0, 35.0}) {  // the cone's: 26.6
      SCOPED_TRACE(testing::Message() << "slope " << slope_deg << " deg toward " << heading_deg << " deg");
      BulletWorld world(iterations, 0, scene::bare_scene());
      Sled sled(world, mass_kg, box_body(Vec3(0.2, 0.2, 0.1), Pose::Identity(), mu), Pose::Identity());
      Wall wall(world, box_body(Vec3(4, 4, 0.2), Pose::Identity(), 1.0), Pose(Eigen::Translation3d(0, 0, -0.15)));
      const double slope = rad_from_deg(slope_deg);
      const Vec3 downhill(std::cos(rad_from_deg(heading_deg)), std::sin(rad_from_deg(heading_deg)), 0);
      const Vec3 weight = mass_kg * gravity * (std::sin(slope) * downhill - std::cos(slope) * Vec3::UnitZ());
      const double seconds = 0.5;
      measure(world, {0, 0.020, step_s}, seconds, arm5e_body::finger_a, [&] { sled.push(weight); });
      const double expected = std::max(0.0, gravity * (std::sin(slope) - mu * std::cos(slope))) * seconds;
      EXPECT_NEAR(sled.speed_m_s().dot(downhill), expected, 0.01 * expected + 1e-4);
      EXPECT_NEAR(sled.speed_m_s().cross(downhill).head<2>().norm(), 0, 1e-3);
    }
  }
}

// Two feet of a body and two plates of a floor, each of its own friction: what touches decides.
TEST(FrictionOfAShape, isThatOfTheTwoShapesThatTouch) {
  const double slope = rad_from_deg(35), mass_kg = 2, step_s = 0.001, seconds = 0.5;
  const std::array<double, 2> feet{0.9, 0.3}, plates{0.2, 0.7};
  for (std::size_t down = 0; down < 2; ++down) {
    for (std::size_t over = 0; over < 2; ++over) {
      SCOPED_TRACE(testing::Message() << "foot of " << feet[down] << " on a plate of " << plates[over]);
      const auto at = [](double y, double z) { return Pose(Eigen::Translation3d(0, y, z)); };
      scene::Body body, floor;
      for (std::size_t i = 0; i < 2; ++i) {
        body.shapes.push_back(box_body(Vec3(0.1, 0.1, 0.05), at(0, i == down ? -0.025 : 0.025), feet[i]).shapes.front());
        floor.shapes.push_back(box_body(Vec3(4, 1, 0.2), at(i == over ? 0 : 1, 0), plates[i]).shapes.front());
      }
      BulletWorld world(iterations, 0, scene::bare_scene());
      Sled sled(world, mass_kg, body, Pose::Identity());
      Wall wall(world, floor, at(0, -0.15));
      const Vec3 weight = mass_kg * gravity_m_s2 * Vec3(std::sin(slope), 0, -std::cos(slope));
      measure(world, {0, 0.020, step_s}, seconds, arm5e_body::finger_a, [&] { sled.push(weight); });
      const double expected = gravity_m_s2 * (std::sin(slope) - feet[down] * plates[over] * std::cos(slope)) * seconds;
      EXPECT_NEAR(sled.speed_m_s().x(), expected, 0.01 * expected);
    }
  }
}

// A blow of 5 N s within 20 ms: a sensor of 20 ms shows 250 N, over the 50 ms that are judged it is 100.
TEST(ContactSensor, averagesWrenchesAndJudgedForcesOverTheirOwnWindows) {
  using scene::BodyId;
  ContactSensor sensor(0.02, 0.05, 0.001, Vec3::Zero(), scene::bare_scene());
  for (int i = 0; i < 20; ++i)
    sensor.take({{arm5e_body::wrist, arm5e_body::panel, Vec3::Zero(), Vec3(0.25, 0, 0)}}, Pose::Identity(), i * 0.001);
  EXPECT_NEAR(sensor.report().base_wrench.force_n.norm(), 250, 1e-9);
  EXPECT_NEAR(sensor.report().largest_force_n, 100, 1e-9);
  EXPECT_NEAR(sensor.report().peak_force_n, 100, 1e-9);
  EXPECT_NEAR(sensor.report().unintended.front().peak_force_n, 100, 1e-9);
  for (int i = 20; i < 40; ++i) sensor.take({}, Pose::Identity(), i * 0.001);
  EXPECT_EQ(sensor.report().base_wrench.force_n.norm(), 0);
  EXPECT_NEAR(sensor.report().largest_force_n, 100, 1e-9) << "40 ms after the first of it";
}

// What presses from two sides presses, though nothing is left of it at the base; a squeezed bar is carried by the fingers.
TEST(ContactSensor, opposedForcesDoNotCancelAndASqueezeDoes) {
  using scene::BodyId;
  const auto seen = [](std::vector<ContactImpulse> impulses) {
    ContactSensor sensor(0.05, 0.05, 0.001, Vec3::Zero(), scene::bare_scene());
    for (int i = 0; i < 50; ++i) sensor.take(impulses, Pose::Identity(), i * 0.001);
    return sensor.report();
  };
  const Vec3 impulse(0.1, 0, 0);  // 100 N for a millisecond
  const ContactReport between =
      seen({{arm5e_body::forearm, arm5e_body::panel, Vec3::Zero(), impulse}, {arm5e_body::finger_a, handle, Vec3::Zero(), -impulse}});
  EXPECT_NEAR(between.base_wrench.force_n.norm(), 0, 1e-9);
  EXPECT_NEAR(between.largest_force_n, 100, 1e-9);
  EXPECT_NEAR(between.peak_force_n, 100, 1e-9);
  const ContactReport own = seen({{arm5e_body::forearm, arm5e_body::vehicle, Vec3::Zero(), impulse}});
  EXPECT_NEAR(own.base_wrench.force_n.norm(), 0, 1e-9);
  EXPECT_NEAR(own.largest_force_n, 100, 1e-9);
  const ContactReport squeeze =
      seen({{arm5e_body::finger_a, handle, Vec3::Zero(), 2 * impulse}, {handle, arm5e_body::finger_b, Vec3::Zero(), 1.8 * impulse}});
  EXPECT_NEAR(squeeze.largest_force_n, 20, 1e-9);
  EXPECT_EQ(seen({{arm5e_body::finger_a, arm5e_body::finger_b, Vec3::Zero(), 3 * impulse}}).largest_force_n, 0) << "a jaw that is closed";
}

TEST(ForceWindow, averagesTheLastStepsAndReturnsToExactlyZero) {
  ForceWindow window(0.020, 0.001);
  EXPECT_DOUBLE_EQ(window.window_s(), 0.020);
  window.add({Vec3(0.1, 0.2, 0.3), Vec3(1, 2, 3)});
  for (int i = 0; i < 19; ++i) {
    EXPECT_NEAR(window.mean().force_n.x(), 5, 1e-12);
    EXPECT_NEAR(window.mean().torque_nm.z(), 150, 1e-12);
    window.add({});
  }
  window.add({});
  EXPECT_EQ(window.mean().force_n, Vec3::Zero());
}

TEST(ForceWindow, refusesStepsAndWindowsThatMakeNoSense) {
  EXPECT_THROW(ForceWindow(0.02, 0), InputError);
  EXPECT_THROW(ForceWindow(0.001, 0.002), InputError);
  EXPECT_THROW(ForceWindow(std::numeric_limits<double>::quiet_NaN(), 0.001), InputError);
  EXPECT_THROW(ForceWindow(std::numeric_limits<double>::infinity(), 0.001), InputError);
}

}  // namespace
}  // namespace lf::world
