#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "firmware/arm/transmission.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 402;
constexpr double counts_per_rev = 64;

// Two screws with a sliding nut, a ball screw, and one that locks itself; friction of the size of a small motor's.
constexpr Friction sliding{0.004, 2e-5, 0.8, 0.75};
constexpr Friction locking{0.004, 2e-5, 0.45, -0.2};

Transmission transmission(std::size_t joint, const Friction& friction) {
  return Transmission(test::arm5e.joint(joint), {counts_per_rev, friction});
}

class RandomPose {
 public:
  std::size_t joint() { return std::uniform_int_distribution<std::size_t>(0, arm5e_joint::count - 1)(engine_); }
  double angle(std::size_t joint) { return within(test::arm5e.joint(joint).lower_rad, test::arm5e.joint(joint).upper_rad); }
  double within(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  bool coin() { return within(0, 1) < 0.5; }

 private:
  std::mt19937_64 engine_{seed};
};

// The motor's turn by its counts, over a small angle to either side.
TEST(Transmission, HasTheRatioOfVirtualWork) {
  RandomPose random;
  for (int i = 0; i < 2000; ++i) {
    const std::size_t joint = random.joint();
    const double q = random.angle(joint), step = 1e-5;
    const double turn =
        (exact_counts_from_rad(test::arm5e.joint(joint), q + step) - exact_counts_from_rad(test::arm5e.joint(joint), q - step)) /
        counts_per_rev * 2 * std::numbers::pi;
    const Transmission smooth = transmission(joint, {});
    ASSERT_NEAR(smooth.ratio(q), turn / (2 * step), 1e-6 * smooth.ratio(q)) << "seed " << seed << ", pose " << i;
    // Without friction the motor's work is the joint's, at each speed and at rest.
    const double load = random.within(-40, 40), speed = random.within(-0.5, 0.5);
    const double motor = smooth.motor_torque_nm(q, speed, load);
    ASSERT_NEAR(motor * turn / (2 * step), load, 1e-6 * std::abs(load) + 1e-9);
    for (const bool standing : {false, true}) {
      const TorqueEstimate back = smooth.joint_torque(q, standing ? 0 : speed, speed > 0 ? 1 : -1, standing, motor, 0);
      ASSERT_NEAR(back.nm, load, 1e-9);
      ASSERT_NEAR(back.low_nm, load, 1e-9);
      ASSERT_NEAR(back.high_nm, load, 1e-9);
    }
  }
}

TEST(Transmission, FindsTheLoadThatAMovingMotorWorksAgainst) {
  RandomPose random;
  for (int i = 0; i < 5000; ++i) {
    const std::size_t joint = random.joint();
    const double q = random.angle(joint), load = random.within(-60, 60);
    const double speed = random.within(0.01, 0.5) * (random.coin() ? 1 : -1);
    const Transmission t = transmission(joint, sliding);
    const TorqueEstimate found = t.joint_torque(q, speed, speed > 0 ? 1 : -1, false, t.motor_torque_nm(q, speed, load), 0);
    ASSERT_NEAR(found.nm, load, 1e-9) << "seed " << seed << ", pose " << i;
    ASSERT_NEAR(found.high_nm - found.low_nm, 0, 1e-9) << "nothing is in doubt";
  }
}

// Raising costs load / (ratio eta), lowering gives load eta_back / ratio back: worked out by hand for a load of 20 N m at 0.1 rad/s.
TEST(Transmission, TakesMoreTorqueToRaiseALoadThanToLowerIt) {
  const Transmission t = transmission(arm5e_joint::roll, sliding);
  const double ratio = 2 * std::numbers::pi / (64 * 3.14e-3);
  EXPECT_NEAR(t.ratio(0), ratio, 1e-9);
  EXPECT_NEAR(t.motor_torque_nm(0, 0.1, 20), 20 / ratio / 0.8 + 0.004 + 2e-5 * ratio * 0.1, 1e-12);
  EXPECT_NEAR(t.motor_torque_nm(0, -0.1, 20), 20 / ratio * 0.75 - 0.004 - 2e-5 * ratio * 0.1, 1e-12);
  EXPECT_NEAR(t.motor_torque_nm(0, -0.1, -20), -t.motor_torque_nm(0, 0.1, 20), 1e-12);
}

// Of screws with equal friction both ways, eta_back = 2 - 1 / eta: the band of loads over the ideal one, by a table of such screws.
TEST(Transmission, BoundsTheLoadAtStandstillByBothDirections) {
  struct Row {
    double efficiency, low, high;
  };
  for (const Row& row :
       {Row{0.95, 0.95, 1.06}, Row{0.90, 0.90, 1.13}, Row{0.80, 0.80, 1.33}, Row{0.70, 0.70, 1.75}, Row{0.60, 0.60, 3.0}}) {
    const Transmission t = transmission(arm5e_joint::elbow, {0, 0, row.efficiency, 2 - 1 / row.efficiency});
    const TorqueEstimate held = t.joint_torque(1, 0, 1, true, 0.01, 0);
    const double ideal = t.ratio(1) * 0.01;
    EXPECT_NEAR(held.low_nm / ideal, row.low, 0.006);
    EXPECT_NEAR(held.high_nm / ideal, row.high, 0.006);
    EXPECT_EQ(held.nm, held.low_nm) << "the line of the last motion, which raised it";
    EXPECT_NEAR(held.at_least_nm(), held.low_nm, 1e-12);
  }
}

TEST(Transmission, SaysNothingOfTheLoadThatASelfLockingScrewHolds) {
  const Transmission t = transmission(arm5e_joint::slew, locking);
  for (const int last : {-1, 0, 1}) {
    const TorqueEstimate unknown = t.joint_torque(0, 0, last, true, 0, 0);
    EXPECT_EQ(unknown.low_nm, -Transmission::breaking_nm);
    EXPECT_EQ(unknown.high_nm, Transmission::breaking_nm);
    EXPECT_EQ(unknown.at_least_nm(), 0);
  }
  // A motor that pushes harder than the friction without load is known to push: at least so much, however much more.
  const TorqueEstimate pushing = t.joint_torque(0, 0, 1, true, 0.05, 0);
  EXPECT_NEAR(pushing.low_nm, t.ratio(0) * 0.45 * (0.05 - 0.004), 1e-9);
  EXPECT_EQ(pushing.high_nm, Transmission::breaking_nm);
  // Moving against a load it is as good as any other; lowering, it has no more than its friction to tell.
  EXPECT_NEAR(t.joint_torque(0, 0.1, 1, false, t.motor_torque_nm(0, 0.1, 30), 0).nm, 30, 1e-9);
  const TorqueEstimate lowering = t.joint_torque(0, -0.1, -1, false, t.motor_torque_nm(0, -0.1, 30), 1e-6);
  EXPECT_LT(lowering.low_nm, 0.1);
  EXPECT_EQ(lowering.high_nm, Transmission::breaking_nm);
}

// The bounds hold the true load when friction, efficiencies and the reading are wrong by as much as was said, moving and at rest.
TEST(Transmission, BoundsHoldTheTrueLoad) {
  RandomPose random;
  Friction said = sliding;
  said.doubt = 0.2;
  said.efficiency_doubt = 0.05;
  for (int i = 0; i < 5000; ++i) {
    const std::size_t joint = random.joint();
    Friction true_one = said;
    true_one.coulomb_nm *= 1 + random.within(-0.2, 0.2);
    true_one.viscous_nm_s *= 1 + random.within(-0.2, 0.2);
    true_one.efficiency *= 1 + random.within(-0.05, 0.05);
    true_one.back_efficiency *= 1 + random.within(-0.05, 0.05);
    const Transmission t = transmission(joint, said), real = transmission(joint, true_one);
    const double q = random.angle(joint), load = random.within(-60, 60), speed = random.within(0.05, 0.3) * (random.coin() ? 1 : -1);
    const int way = speed > 0 ? 1 : -1;
    const TorqueEstimate moving =
        t.joint_torque(q, speed, way, false, real.motor_torque_nm(q, speed, load) + random.within(-1e-3, 1e-3), 1e-3);
    ASSERT_LE(moving.low_nm, load) << "seed " << seed << ", pose " << i;
    ASSERT_GE(moving.high_nm, load) << "seed " << seed << ", pose " << i;
    // At rest the motor's torque is anywhere between what would raise and what would lower the load.
    const double up = real.motor_torque_nm(q, 1e-12, load), down = real.motor_torque_nm(q, -1e-12, load);
    const TorqueEstimate held = t.joint_torque(q, 0, way, true, random.within(down, up) + random.within(-1e-3, 1e-3), 1e-3);
    ASSERT_LE(held.low_nm, load) << "seed " << seed << ", pose " << i;
    ASSERT_GE(held.high_nm, load) << "seed " << seed << ", pose " << i;
  }
}

TEST(TorqueObserver, RemembersTheWayOfTheLastMotion) {
  const Transmission t = transmission(arm5e_joint::elbow, sliding);
  const double rad = rad_per_count(test::arm5e.joint(arm5e_joint::elbow), 1), held = t.motor_torque_nm(1, 1e-12, 10);
  TorqueObserver observer;
  EXPECT_NEAR(observer.update(t, rad, 1, 0, held, 0).nm, t.ratio(1) * held, 1e-9) << "it never moved: as if there were no friction";
  EXPECT_NEAR(observer.update(t, rad, 1, 0.1, t.motor_torque_nm(1, 0.1, 10), 0).nm, 10, 1e-9);
  const TorqueEstimate rest = observer.update(t, rad, 1, 0, held, 0);
  EXPECT_NEAR(rest.nm, 10, 1e-9);
  EXPECT_NEAR(rest.low_nm, 10, 1e-9);
  EXPECT_GT(rest.high_nm, 15);
  EXPECT_NEAR(observer.update(t, rad, 1, -0.1, t.motor_torque_nm(1, -0.1, 10), 0).nm, 10, 1e-9);
  EXPECT_NEAR(observer.update(t, rad, 1, 0, t.motor_torque_nm(1, -1e-12, 10), 0).nm, 10, 1e-9);
}

}  // namespace
}  // namespace lf::arm
