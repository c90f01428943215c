#include <gtest/gtest.h>

#include <cmath>

#include "firmware/arm/clear_way.hpp"
#include "firmware/arm/gripper.hpp"
#include "tests/arm5e.hpp"
#include "tests/unit/arm/random_joints.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20231;
constexpr double wanted_m = 0.015;
constexpr Distances wanted{wanted_m, wanted_m, wanted_m};

Room room_at(const Pose& base_from_panel, double jaw_low_rad = 0, double jaw_high_rad = 0) {
  Room room;
  room.base_from_panel = base_from_panel;
  room.jaw = {jaw_low_rad, jaw_high_rad};
  return room;
}

const VehicleShape no_vehicle;

Surroundings before(const PanelLayout& layout, const Room& room, const VehicleShape& vehicle = no_vehicle) {
  Surroundings surroundings(test::arm5e, layout, vehicle);
  surroundings.enter(room);
  return surroundings;
}

ClearWay::State look_along(ClearWay& way, const JointVector& from, const JointVector& to, const Surroundings& surroundings) {
  way.begin(from, surroundings, wanted);
  way.add(to);
  while (way.advance(surroundings, 4) == ClearWay::State::looking) {
  }
  return way.state();
}

// At every way's place and every angle of the jaw.
double nearest_by_sampling(const JointVector& from, const JointVector& to, const PanelShape& panel, const VehicleShape& vehicle,
                           const Room& room) {
  constexpr int samples = 1200, openings = 24;  // a metre in steps of 0.8 mm; a finger's 40 mm in steps of 1.7
  double least = 1e9;
  for (int i = 0; i <= samples; ++i) {
    const JointVector q = from + (to - from) * (static_cast<double>(i) / samples);
    for (int k = 0; k <= openings; ++k) {
      if (k > 0 && room.jaw.low_rad == room.jaw.high_rad) break;
      const LinkCapsules capsules = test::arm5e.link_capsules(q, std::lerp(room.jaw.low_rad, room.jaw.high_rad, k / double{openings}));
      least = std::min({least, panel.clearance(capsules, room.base_from_panel).distance_m, clearance_to_vehicle(capsules, vehicle),
                        clearance_to_itself(capsules)});
    }
  }
  return least;
}

// A small board anywhere in the arm's reach, and a lamp: on the way, beside it, or just past it. Every other way is gone with the jaw in motion.
TEST(ClearWay, LetsNothingSlipBetweenTwoPoses) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  PanelLayout board;
  board.plate_min_m = Vec2(-0.05, -0.15);
  board.plate_max_m = Vec2(0.05, 0.15);
  const PanelShape panel(board);
  int clear = 0, blocked_by_panel = 0, blocked_by_vehicle = 0, given_up = 0, close = 0;
  for (int k = 0; k < 300; ++k) {
    const JointVector from = random.next(), to = random.next();
    Pose base_from_panel = board.nominal_base_from_panel();
    base_from_panel.translation() = Vec3(random.uniform(0.1, 0.6), random.uniform(-0.4, 0.4), random.uniform(0, 1));
    VehicleShape vehicle;
    const Vec3 lamp(random.uniform(0.1, 0.5), random.uniform(-0.6, 0.2), random.uniform(0, 1));
    ASSERT_TRUE(vehicle.rods.push_back({lamp, lamp + Vec3(0, 0, 0.05), 0.03}));
    const Room room = room_at(base_from_panel, -0.05, k % 2 == 0 ? -0.05 : jaw_from_gap(test::jaw5e, 0.06));
    ClearWay way;
    const ClearWay::State state = look_along(way, from, to, before(board, room, vehicle));
    const double nearest = nearest_by_sampling(from, to, panel, vehicle, room);
    if (state == ClearWay::State::clear) {
      ++clear;
      ASSERT_GE(nearest, wanted_m - ClearWay::resolution_m) << "draw " << k;
    } else if (way.poses() == ClearWay::max_poses) {
      ++given_up;
    } else {
      (way.barrier() == Barrier::panel ? blocked_by_panel : blocked_by_vehicle) += 1;
      ASSERT_LT(nearest, wanted_m + 5e-4) << "draw " << k << ": " << static_cast<int>(way.barrier()) << ", " << way.poses() << " poses, "
                                          << way.least_slack_m();
    }
    close += std::abs(nearest - wanted_m) < 0.005;
  }
  EXPECT_GT(clear, 50);
  EXPECT_GT(blocked_by_panel, 20);
  EXPECT_GT(blocked_by_vehicle, 4);
  EXPECT_LT(given_up, 4) << "a long way close by, with the jaw in motion";
  EXPECT_GT(close, 3) << "nothing was put to the test";
}

// Out of a place that is too near, and back to it: what the way has gained it keeps half of.
TEST(ClearWay, MayLeaveAPlaceThatIsTooNearAndNotComeBackToIt) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  const PanelLayout board;
  const Room room = room_at(board.nominal_base_from_panel());
  const Surroundings surroundings = before(board, room);
  int left = 0;
  for (int k = 0; k < 20000 && left < 20; ++k) {
    const JointVector from = random.next(), to = random.next();
    const Distances here = surroundings.distances(from, 0), there = surroundings.distances(to, 0);
    const bool too_near = here.panel_m > 0.002 && here.panel_m < 0.010 && std::min(here.vehicle_m, here.itself_m) > wanted_m;
    if (!too_near || there.panel_m < 3 * wanted_m) continue;
    ClearWay way;
    const auto look = [&] {
      while (way.advance(surroundings, 4) == ClearWay::State::looking) {
      }
      return way.state();
    };
    way.begin(from, surroundings, {here.panel_m - 0.001, wanted_m, wanted_m}, wanted);
    way.add(to);
    if (look() != ClearWay::State::clear) continue;
    ++left;
    way.add(from);
    EXPECT_EQ(look(), ClearWay::State::blocked) << "draw " << k;
    EXPECT_EQ(way.barrier(), Barrier::panel) << "draw " << k;
  }
  EXPECT_EQ(left, 20);
}

TEST(ClearWay, NeedsFewPosesWhereThereIsRoom) {
  const PanelLayout layout;
  const Surroundings surroundings = before(layout, room_at(layout.nominal_base_from_panel()));
  ClearWay way;
  way.begin(planar_joints(0, 0.60, 1.90, 0), surroundings, wanted);
  way.add(planar_joints(0, 0.945, 2.095, 0));
  EXPECT_EQ(way.advance(surroundings, 1), ClearWay::State::looking);
  EXPECT_EQ(way.advance(surroundings, 30), ClearWay::State::clear);
  EXPECT_LT(way.poses(), 30);
  EXPECT_GT(way.least_slack_m(), 0.02);
}

// What the last pose of a stretch vouches for is good for the next one, too.
TEST(ClearWay, OfManyShortStretchesTakesNoMorePosesThanOneLongOne) {
  const PanelLayout layout;
  const Surroundings surroundings = before(layout, room_at(layout.nominal_base_from_panel()));
  const JointVector from = planar_joints(0, 0.60, 1.90, 0), to = planar_joints(0, 1.1, 1.5, 0);
  ClearWay whole, pieces;
  ASSERT_EQ(look_along(whole, from, to, surroundings), ClearWay::State::clear);
  pieces.begin(from, surroundings, wanted);
  for (int i = 1; i <= 50; ++i) {
    pieces.add(from + (to - from) * (i / 50.0));
    while (pieces.advance(surroundings, 1) == ClearWay::State::looking) {
    }
    ASSERT_EQ(pieces.state(), ClearWay::State::clear);
  }
  EXPECT_LE(pieces.poses(), whole.poses() + 1);
  EXPECT_NEAR(pieces.least_slack_m(), whole.least_slack_m(), 0.01);
}

TEST(ClearWay, OfNoLengthIsItsOnePose) {
  const PanelLayout layout;
  const JointVector park = planar_joints(0, 0.60, 1.90, 0);
  Surroundings surroundings = before(layout, room_at(layout.nominal_base_from_panel()));
  ClearWay way;
  EXPECT_EQ(look_along(way, park, park, surroundings), ClearWay::State::clear);
  EXPECT_EQ(way.poses(), 1);
  way.begin(park, surroundings, {1.0, 0, 0});
  EXPECT_EQ(way.advance(surroundings, 1), ClearWay::State::blocked);
  EXPECT_EQ(way.barrier(), Barrier::panel);
  way.begin(park, surroundings, {0, 0, 1.0});
  EXPECT_EQ(way.advance(surroundings, 1), ClearWay::State::blocked);
  EXPECT_EQ(way.barrier(), Barrier::itself);
}

// A pin where a finger's pad passes: clear of it closed, and clear of it open.
TEST(ClearWay, OfTheJawAloneIsSweptFromEndToEnd) {
  const JointVector q = planar_joints(0, 1.1, 1.3, 0);
  constexpr double open_rad = 1.2;
  VehicleShape vehicle;
  const LinkCapsules half = test::arm5e.link_capsules(q, open_rad / 2);
  const Capsule& pad = half[half.size() - 1];
  ASSERT_TRUE(vehicle.rods.push_back({pad.a_m, pad.b_m, 0.001}));
  ASSERT_GT(clearance_to_vehicle(test::arm5e.link_capsules(q, 0), vehicle), 0.005);
  ASSERT_GT(clearance_to_vehicle(test::arm5e.link_capsules(q, open_rad), vehicle), 0.005);
  const auto state = [&](double high_rad) {
    PanelLayout layout;
    Pose away = layout.nominal_base_from_panel();
    away.translation().x() += 2;
    Surroundings surroundings = before(layout, room_at(away, 0, high_rad), vehicle);
    ClearWay way;
    way.begin(q, surroundings, {0, 0, 0});
    while (way.advance(surroundings, 1) == ClearWay::State::looking) {
    }
    return way.state();
  };
  EXPECT_EQ(state(0), ClearWay::State::clear);
  EXPECT_EQ(state(open_rad), ClearWay::State::blocked);
}

TEST(ClearWay, OfWhatIsNoNumberIsBlocked) {
  const PanelLayout layout;
  const Surroundings surroundings = before(layout, room_at(layout.nominal_base_from_panel()));
  ClearWay way;
  way.begin(planar_joints(0, std::nan(""), 1.90, 0), surroundings, wanted);
  way.add(planar_joints(0, 0.6, 1.9, 0));
  EXPECT_EQ(way.advance(surroundings, 5), ClearWay::State::blocked);
  EXPECT_EQ(way.poses(), 0);
  way.begin(planar_joints(0, 0.6, 1.9, 0), surroundings, wanted);
  way.add(planar_joints(0, 0.6, std::nan(""), 0));
  EXPECT_EQ(way.advance(surroundings, 5), ClearWay::State::blocked);
  const Surroundings no_jaw = before(layout, room_at(layout.nominal_base_from_panel(), 0, std::nan("")));
  way.begin(planar_joints(0, 0.6, 1.9, 0), no_jaw, wanted);
  EXPECT_EQ(way.advance(no_jaw, 5), ClearWay::State::blocked);
}

}  // namespace
}  // namespace lf::arm
