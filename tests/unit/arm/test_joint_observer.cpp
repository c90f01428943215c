#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/arm/joint_observer.hpp"

namespace lf::arm {
namespace {

constexpr double dt_s = 0.004;

TEST(JointObserver, FindsAConstantSpeedExactly) {
  JointObserver observer;
  observer.reset(0);
  for (int i = 1; i <= 500; ++i) observer.update(0.3 * i * dt_s, dt_s);
  EXPECT_NEAR(observer.velocity_rad_s(), 0.3, 1e-9);
  EXPECT_NEAR(observer.position_rad(), 0.3 * 500 * dt_s, 1e-9);
}

TEST(JointObserver, SettlesWithinAFifthOfASecond) {
  JointObserver observer;
  observer.reset(0);
  for (int i = 1; i <= 50; ++i) observer.update(0.3 * i * dt_s, dt_s);
  EXPECT_NEAR(observer.velocity_rad_s(), 0.3, 0.03);
}

TEST(JointObserver, MakesLessOfACountThanADifferenceDoes) {
  constexpr double count_rad = 3.7e-4;  // the elbow's coarsest
  JointObserver observer;
  observer.reset(0);
  double worst = 0;
  for (int i = 1; i <= 2000; ++i) {
    observer.update(std::floor(0.065 * i * dt_s / count_rad) * count_rad, dt_s);
    if (i > 200) worst = std::max(worst, std::abs(observer.velocity_rad_s() - 0.065));
  }
  EXPECT_LT(worst, 0.006);
  EXPECT_GT(worst, 1e-5);  // it is an observer of counts, not an oracle
  EXPECT_GT(count_rad / dt_s, 0.09);
}

}  // namespace
}  // namespace lf::arm
