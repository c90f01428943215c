// Against the integrals of the strips, done by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/world/link_drag.hpp"

namespace lf::world {
namespace {

constexpr double coefficient = 1.1, length_m = 0.4, radius_m = 0.03;
constexpr double half_rho_cd = 0.5 * 1025 * coefficient;

// Along x, its near end at the frame's origin.
scene::Shape rod() {
  scene::Shape shape;
  shape.kind = scene::ShapeKind::cylinder;
  shape.size_m = Vec3(radius_m, 0, length_m);
  shape.body_from_shape.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()).toRotationMatrix();
  shape.body_from_shape.translation() = Vec3(length_m / 2, 0, 0);
  return shape;
}

TEST(LinkDrag, OfARodAcrossTheFlowIsACylindersAndAlongItNone) {
  const LinkDrag drag({rod()}, Pose::Identity());
  const LinkDrag::Wrench across = drag.at(Vec3(0, 0.3, 0), Vec3::Zero(), coefficient);
  EXPECT_LT((across.force_n - Vec3(0, -half_rho_cd * 2 * radius_m * length_m * 0.09, 0)).norm(), 1e-9);
  EXPECT_LT((across.torque_nm - Vec3(0, 0, across.force_n.y() * length_m / 2)).norm(), 1e-9);
  EXPECT_LT(drag.at(Vec3(0.3, 0, 0), Vec3::Zero(), coefficient).force_n.norm(), 1e-9);
  // Aslant the part across counts, with its own square.
  const LinkDrag::Wrench aslant = drag.at(Vec3(0.3, 0.3, 0), Vec3::Zero(), coefficient);
  EXPECT_LT((aslant.force_n - across.force_n).norm(), 1e-9);
}

// The integral of rho / 2 cd d (w x)^2 x is rho / 2 cd d w^2 l^4 / 4.
TEST(LinkDrag, OfARodThatTurnsAboutItsEndGrowsWithTheFourthPowerOfItsLength) {
  const LinkDrag drag({rod()}, Pose::Identity());
  for (const double turn_rad_s : {-0.5, 0.2, 1.0}) {
    const double expected_nm = -half_rho_cd * 2 * radius_m * turn_rad_s * std::abs(turn_rad_s) * std::pow(length_m, 4) / 4;
    const LinkDrag::Wrench drawn = drag.at(Vec3::Zero(), Vec3(0, 0, turn_rad_s), coefficient);
    EXPECT_NEAR(drawn.torque_nm.z(), expected_nm, 0.015 * std::abs(expected_nm));
    EXPECT_LT(drawn.torque_nm.head<2>().norm(), 1e-12);
  }
}

TEST(LinkDrag, OfASphereIsTheSameEveryWay) {
  scene::Shape ball;
  ball.kind = scene::ShapeKind::sphere;
  ball.size_m = Vec3(radius_m, 0, 0);
  const LinkDrag drag({ball}, Pose::Identity());
  const Vec3 velocity(0.1, -0.2, 0.2);
  const Vec3 expected = -half_rho_cd * std::numbers::pi * radius_m * radius_m * 0.3 * velocity;
  EXPECT_LT((drag.at(velocity, Vec3::Zero(), coefficient).force_n - expected).norm(), 1e-9);
}

// Of a box the longest side is the rod's, whichever it is; what does not collide is not in the water.
TEST(LinkDrag, OfABoxIsThatOfARodAlongItsLongestSide) {
  for (int longest = 0; longest < 3; ++longest) {
    scene::Shape box;
    box.size_m = Vec3::Constant(0.05);
    box.size_m[longest] = 0.3;
    scene::Shape drawn_only = box;
    drawn_only.collides = false;
    const LinkDrag drag({box, drawn_only}, Pose::Identity());
    EXPECT_LT(drag.at(0.2 * Vec3::Unit(longest), Vec3::Zero(), coefficient).force_n.norm(), 1e-9) << longest;
    const Vec3 side = Vec3::Unit((longest + 1) % 3);
    EXPECT_NEAR(drag.at(0.2 * side, Vec3::Zero(), coefficient).force_n.dot(side), -half_rho_cd * 0.05 * 0.3 * 0.04, 1e-9) << longest;
  }
}

}  // namespace
}  // namespace lf::world
