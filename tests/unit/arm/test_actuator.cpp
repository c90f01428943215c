#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "firmware/arm/actuator.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::arm {
namespace {

constexpr PerJoint<std::size_t> joints{arm5e_joint::slew, arm5e_joint::shoulder, arm5e_joint::elbow, arm5e_joint::roll, arm5e_joint::jaw};

double at_fraction(std::size_t joint, int i, int n) {
  return test::arm5e.joint(joint).lower_rad + (test::arm5e.joint(joint).upper_rad - test::arm5e.joint(joint).lower_rad) * i / n;
}

TEST(Actuator, CountsRiseWithTheAngleOverTheWholeStroke) {
  for (const std::size_t joint : joints)
    for (int i = 1; i <= 10'000; ++i)
      ASSERT_GT(exact_counts_from_rad(test::arm5e.joint(joint), at_fraction(joint, i, 10'000)),
                exact_counts_from_rad(test::arm5e.joint(joint), at_fraction(joint, i - 1, 10'000)))
          << "joint " << static_cast<int>(joint) << " step " << i;
}

// The published angle per encoder tick, smallest and largest over the stroke.
TEST(Actuator, TicksAreAsCoarseAsPublished) {
  const PerJoint<std::array<double, 2>> published{
      {{1.3e-4, 3.6e-4}, {0.6e-4, 1.8e-4}, {1.0e-4, 3.7e-4}, {3.14e-3, 3.14e-3}, {5.37e-4, 5.37e-4}}};
  for (std::size_t k = 0; k < arm5e_joint::count; ++k) {
    double finest = 1, coarsest = 0;
    for (int i = 0; i <= 10'000; ++i) {
      const double tick = rad_per_count(test::arm5e.joint(joints[k]), at_fraction(joints[k], i, 10'000));
      finest = std::min(finest, tick);
      coarsest = std::max(coarsest, tick);
    }
    EXPECT_NEAR(finest, published[k][0], 0.005 * published[k][0]) << k;
    EXPECT_NEAR(coarsest, published[k][1], 0.005 * published[k][1]) << k;
  }
}

TEST(Actuator, TickIsTheInverseSlopeOfTheCounts) {
  for (const std::size_t joint : joints)
    for (int i = 1; i < 100; ++i) {
      const double q = at_fraction(joint, i, 100);
      const double slope =
          (exact_counts_from_rad(test::arm5e.joint(joint), q + 1e-6) - exact_counts_from_rad(test::arm5e.joint(joint), q - 1e-6)) / 2e-6;
      EXPECT_NEAR(rad_per_count(test::arm5e.joint(joint), q) * slope, 1, 1e-6);
    }
}

TEST(Actuator, CountsAndAnglesAreInverse) {
  for (const std::size_t joint : joints) {
    for (int i = 0; i <= 1000; ++i) {
      const double q = at_fraction(joint, i, 1000);
      const std::int32_t counts = counts_from_rad(test::arm5e.joint(joint), q);
      EXPECT_LE(std::abs(rad_from_counts(test::arm5e.joint(joint), counts) - q), 0.51 * rad_per_count(test::arm5e.joint(joint), q) + 1e-7);
      EXPECT_EQ(counts_from_rad(test::arm5e.joint(joint), rad_from_counts(test::arm5e.joint(joint), counts)), counts);
    }
    EXPECT_EQ(counts_from_rad(test::arm5e.joint(joint), 0), 0);
  }
}

// The law of cosines written down once more: the elbow's screw between pivots 0.26 m and 0.06 m.
TEST(Actuator, ScrewIsTheTrianglesThirdSide) {
  const auto length = [](double q) { return std::sqrt(0.26 * 0.26 + 0.06 * 0.06 - 2 * 0.26 * 0.06 * std::cos(q + 0.2115)); };
  EXPECT_NEAR(exact_counts_from_rad(test::arm5e.joint(arm5e_joint::elbow), 1.151), 166667 * (length(1.151) - length(0)), 1e-8);
}

TEST(Actuator, WithstandsNonsense) {
  for (const std::size_t joint : joints) {
    EXPECT_EQ(counts_from_rad(test::arm5e.joint(joint), std::numeric_limits<double>::quiet_NaN()), 0);
    EXPECT_EQ(counts_from_rad(test::arm5e.joint(joint), std::numeric_limits<double>::infinity()),
              counts_from_rad(test::arm5e.joint(joint), test::arm5e.joint(joint).upper_rad + 0.1));
    EXPECT_EQ(counts_from_rad(test::arm5e.joint(joint), -1e300),
              counts_from_rad(test::arm5e.joint(joint), test::arm5e.joint(joint).lower_rad - 0.1));
    EXPECT_NEAR(rad_from_counts(test::arm5e.joint(joint), std::numeric_limits<std::int32_t>::max()),
                test::arm5e.joint(joint).upper_rad + 0.1, 1e-12);
    EXPECT_NEAR(rad_from_counts(test::arm5e.joint(joint), std::numeric_limits<std::int32_t>::min()),
                test::arm5e.joint(joint).lower_rad - 0.1, 1e-12);
    EXPECT_TRUE(std::isfinite(rad_per_count(test::arm5e.joint(joint), std::numeric_limits<double>::quiet_NaN())));
  }
}

}  // namespace
}  // namespace lf::arm
