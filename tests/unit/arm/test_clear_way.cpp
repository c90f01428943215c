#include <gtest/gtest.h>

#include <cmath>

#include "firmware/arm/clear_way.hpp"
#include "tests/unit/arm/random_joints.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20231;
constexpr double wanted_m = 0.015;

double nearest_by_sampling(const JointVector& from, const JointVector& to, const PanelShape& panel, const Pose& base_from_panel) {
  constexpr int samples = 1500;  // a metre in steps of 0.7 mm
  double least = 1e9;
  for (int i = 0; i <= samples; ++i) {
    const JointVector q = from + (to - from) * (static_cast<double>(i) / samples);
    least = std::min(least, panel.clearance(link_capsules(q, 0), base_from_panel).distance_m);
  }
  return least;
}

// A small board anywhere in the arm's reach: on the way, beside it, or just past it.
TEST(ClearWay, LetsNothingSlipBetweenTwoPoses) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  PanelLayout board;
  board.plate_min_m = Vec2(-0.05, -0.15);
  board.plate_max_m = Vec2(0.05, 0.15);
  const PanelShape panel(board);
  int clear = 0, blocked = 0, close = 0;
  for (int k = 0; k < 300; ++k) {
    const JointVector from = random.next(), to = random.next();
    Pose base_from_panel = board.nominal_base_from_panel();
    base_from_panel.translation() = Vec3(random.uniform(0.1, 0.6), random.uniform(-0.4, 0.4), random.uniform(0, 1));
    ClearWay way;
    way.begin(from, to, 0, base_from_panel, wanted_m);
    while (way.advance(panel, 4) == ClearWay::State::looking) {
    }
    const double nearest = nearest_by_sampling(from, to, panel, base_from_panel);
    if (way.state() == ClearWay::State::clear) {
      ++clear;
      ASSERT_GE(nearest, wanted_m - ClearWay::resolution_m) << "draw " << k;
    } else {
      ++blocked;
      ASSERT_LT(nearest, wanted_m + 5e-4) << "draw " << k;
    }
    close += std::abs(nearest - wanted_m) < 0.005;
  }
  EXPECT_GT(clear, 50);
  EXPECT_GT(blocked, 30);
  EXPECT_GT(close, 3) << "nothing was put to the test";
}

TEST(ClearWay, NeedsFewPosesWhereThereIsRoom) {
  const PanelLayout layout;
  const PanelShape panel(layout);
  ClearWay way;
  way.begin({0, 0.60, 1.90, 0}, {0, 0.945, 2.095, 0}, 0, layout.nominal_base_from_panel(), wanted_m);
  EXPECT_EQ(way.advance(panel, 1), ClearWay::State::looking);
  EXPECT_EQ(way.advance(panel, 30), ClearWay::State::clear);
  EXPECT_LT(way.poses(), 12);
  EXPECT_GT(way.nearest().distance_m, 0.1);
}

TEST(ClearWay, OfNoLengthIsItsOnePose) {
  const PanelLayout layout;
  const PanelShape panel(layout);
  const JointVector park{0, 0.60, 1.90, 0};
  ClearWay way;
  way.begin(park, park, 0, layout.nominal_base_from_panel(), wanted_m);
  EXPECT_EQ(way.advance(panel, 1), ClearWay::State::clear);
  way.begin(park, park, 0, layout.nominal_base_from_panel(), 1.0);
  EXPECT_EQ(way.advance(panel, 1), ClearWay::State::blocked);
}

TEST(ClearWay, OfWhatIsNoNumberIsBlocked) {
  const PanelLayout layout;
  ClearWay way;
  way.begin({0, std::nan(""), 1.90, 0}, {0, 0.6, 1.9, 0}, 0, layout.nominal_base_from_panel(), wanted_m);
  EXPECT_EQ(way.advance(PanelShape(layout), 5), ClearWay::State::blocked);
  EXPECT_EQ(way.poses(), 0);
}

}  // namespace
}  // namespace lf::arm
