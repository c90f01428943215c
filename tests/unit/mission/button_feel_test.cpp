#include "firmware/mission/button_feel.hpp"

#include <gtest/gtest.h>

#include <random>

namespace lf::mission {
namespace {

constexpr double period_s = 0.004, speed_m_s = 0.025, arm_n_m = 20'000, noise_n = 0.3;
constexpr unsigned seed = 20261123;

// A cap of preload, spring, click and bottom, or one that does not move, pressed by a finger that gives way: the force at each depth of the drives, in closed form.
struct Cap {
  double preload_n = 5, spring_n_m = 2000, click_m = 0.0035, drop_n = 3, stroke_m = 0.005;
  double face_m = 0;  // below where it is believed
  bool stuck = false;

  // The cap is in by x when the arm, wound up by its force, is at depth face + x + force / arm.
  double force_n(double depth_m) const {
    const double pushed_m = depth_m - face_m;
    if (pushed_m <= 0) return 0;
    if (stuck) return pushed_m * arm_n_m;
    for (const bool clicked : {false, true}) {
      const double drop = clicked ? drop_n : 0;
      const double x = (pushed_m * arm_n_m - preload_n + drop) / (arm_n_m + spring_n_m);
      if (x < 0) return pushed_m * arm_n_m;
      if (clicked ? x < stroke_m : x < click_m) return preload_n - drop + spring_n_m * x;
    }
    return (pushed_m - stroke_m) * arm_n_m;
  }
};

// Until the force passes 16 N, or 11 mm below the face.
ButtonFeel pressed(const Cap& cap, std::mt19937& random, bool& bottomed) {
  std::normal_distribution<double> noise(0, noise_n);
  ButtonFeel feel;
  bottomed = false;
  for (double depth_m = -0.02; depth_m < 0.011 && !bottomed; depth_m += speed_m_s * period_s) {
    const double force_n = cap.force_n(depth_m);
    feel.update(period_s, force_n + noise(random), depth_m);
    bottomed = force_n > 16;
  }
  return feel;
}

TEST(ButtonFeel, TellsAButtonThatWorksFromOneThatIsStuckWhereverThePanelIs) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  int clicks = 0;
  constexpr int presses = 200;
  for (int i = 0; i < presses; ++i) {
    Cap works;
    works.face_m = std::uniform_real_distribution<double>(-0.005, 0.005)(random);
    bool bottomed = false;
    const ButtonFeel good = pressed(works, random, bottomed);
    ASSERT_TRUE(bottomed);
    ASSERT_TRUE(good.touched());
    EXPECT_NEAR(good.touch_depth_m(), works.face_m, 0.0006);
    EXPECT_NEAR(good.travel_m(), works.stroke_m, 0.0007) << "face at " << works.face_m;
    clicks += good.clicked() ? 1 : 0;
    Cap jammed = works;
    jammed.stuck = true;
    const ButtonFeel bad = pressed(jammed, random, bottomed);
    ASSERT_TRUE(bottomed);
    EXPECT_LT(bad.travel_m(), 0.0005);
    EXPECT_FALSE(bad.clicked());
  }
  EXPECT_GT(clicks, presses * 9 / 10);
}

TEST(ButtonFeel, FeelsNoClickWhereThereIsNone) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  int clicks = 0;
  for (int i = 0; i < 200; ++i) {
    Cap smooth;
    smooth.drop_n = 0;
    bool bottomed = false;
    clicks += pressed(smooth, random, bottomed).clicked() ? 1 : 0;
  }
  EXPECT_LE(clicks, 4);
}

TEST(ButtonFeel, OfNothingIsNothing) {
  std::mt19937 random(seed);
  Cap gone;
  gone.face_m = 0.03;
  bool bottomed = false;
  const ButtonFeel feel = pressed(gone, random, bottomed);
  EXPECT_FALSE(bottomed);
  EXPECT_FALSE(feel.touched());
  EXPECT_EQ(feel.travel_m(), 0);
}

}  // namespace
}  // namespace lf::mission
