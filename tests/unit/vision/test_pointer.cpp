#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hal/vision/pointer.hpp"
#include "tests/unit/scan/docked_scene.hpp"
#include "tests/unit/vision/drawn_handle.hpp"

namespace lf::vision {
namespace {

// What the core asks for before it believes a pointer (mission/panel_map.cpp).
constexpr float believed = 0.3f;

// Marker and cloud give the bar's place with errors of their own.
BarPlace place_of(const test::DrawnHandle& scene, std::mt19937& random) {
  std::uniform_real_distribution<double> share(-1, 1);
  BarPlace place;
  place.base_from_panel = scene.base_from_panel;
  place.base_from_panel.translation() += 0.0015 * Vec3(share(random), share(random), share(random));
  place.angle_rad = wrap(scene.angle_rad, pi / 2) + rad_from_deg(1) * share(random);
  return place;
}

bool toward_the_mark(const PointerObservation& pointer, const test::DrawnHandle& scene) {
  const Vec3 mark = scene.base_from_panel.linear() * Vec3(-std::sin(scene.angle_rad), std::cos(scene.angle_rad), 0);
  return pointer.direction.dot(mark) > 0;
}

PointerObservation read(const test::DrawnHandle& scene, std::mt19937& random, std::span<const CloudPoint> cloud = {}) {
  const test::GreyPicture picture = test::draw_handle(scene);
  return find_pointer(place_of(scene, random), picture.view(), cloud, scene.camera, scene.valve);
}

test::DrawnHandle any_handle(std::mt19937& random) {
  const auto within = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  test::DrawnHandle scene;
  scene.camera = lf::test::nominal_camera();
  scene.base_from_panel = lf::test::docked_panel(random, 0.020, rad_from_deg(2));
  scene.angle_rad = within(-pi, pi);
  scene.bar_grey = within(50, 110);
  scene.paint_grey = scene.bar_grey * within(1.4, 2.0);
  scene.background_grey = within(40, 150);
  scene.side_over_front = within(0.5, 1.8);
  scene.fall_off = within(-0.4, 0.4);
  scene.veil_grey = within(0, 50);
  scene.blur_px = within(0.5, 2);
  scene.gamma = within(0.7, 1.3);
  scene.noise_grey = within(1, 3);
  scene.seed = static_cast<std::uint32_t>(random());
  return scene;
}

TEST(PointerInADrawnPicture, IsReadAtEveryAngleUnderOtherLightThanOurRenderers) {
  constexpr std::uint32_t seed = 4711;
  std::mt19937 random(seed);
  constexpr int pictures = 120;
  int clear = 0;
  for (int i = 0; i < pictures; ++i) {
    const test::DrawnHandle scene = any_handle(random);
    const PointerObservation pointer = read(scene, random);
    const bool is_clear = std::abs(pointer.still_evidence) >= 2 * believed;
    EXPECT_FALSE(is_clear && !toward_the_mark(pointer, scene))
        << "seed " << seed << ", picture " << i << ", " << deg_from_rad(scene.angle_rad) << " deg, evidence " << pointer.still_evidence;
    clear += is_clear ? 1 : 0;
  }
  // 96 of these are clear: the rest have little contrast in much noise, and are not believed by the still alone.
  EXPECT_GE(clear, pictures * 3 / 4) << "seed " << seed;
}

TEST(PointerInADrawnPicture, IsNotBelievedOnAnUnpaintedBar) {
  std::mt19937 random(4712);
  for (int i = 0; i < 60; ++i) {
    test::DrawnHandle scene = any_handle(random);
    scene.painted = false;
    const std::vector<CloudPoint> cloud = test::draw_bar_points(scene, 1);
    const PointerObservation pointer = read(scene, random, cloud);
    EXPECT_LT(pointer.confidence, believed) << "picture " << i << ", still " << pointer.still_evidence << ", cloud "
                                            << pointer.cloud_evidence;
  }
}

TEST(PointerInADrawnPicture, IsReadWhenTheMarkIsDark) {
  std::mt19937 random(4713);
  int right = 0;
  constexpr int pictures = 40;
  for (int i = 0; i < pictures; ++i) {
    test::DrawnHandle scene = any_handle(random);
    scene.valve.pointer = PanelLayout::Pointer::dark_end;
    scene.paint_grey = 0.2 * scene.bar_grey;
    const PointerObservation pointer = read(scene, random, test::draw_bar_points(scene, 0.3));
    right += pointer.confidence >= believed && toward_the_mark(pointer, scene) ? 1 : 0;
    EXPECT_FALSE(pointer.confidence >= believed && !toward_the_mark(pointer, scene)) << "picture " << i;
  }
  EXPECT_GE(right, pictures * 9 / 10);
}

// The laser's brightness does not know of a shadow. A shade over the unmarked end's neighbour that turns the still image round leaves the two readings
// at odds, and nothing is believed; one that only weakens it leaves it right.
TEST(PointerInTheShade, IsNeverReadTheWrongWayRound) {
  std::mt19937 random(4714);
  for (int i = 0; i < 120; ++i) {
    test::DrawnHandle scene = any_handle(random);
    scene.fall_off = 0;
    scene.shade = std::uniform_real_distribution(0.3, 0.8)(random);
    scene.shade_edge_m = std::uniform_real_distribution(-0.04, 0.04)(random);
    if (i % 2 == 0) scene.shade = 1 / scene.shade;  // then it is the marked end that is in the shade
    const PointerObservation pointer = read(scene, random, test::draw_bar_points(scene, 1.35));
    EXPECT_FALSE(pointer.confidence >= believed && !toward_the_mark(pointer, scene))
        << "picture " << i << ": shade " << scene.shade << " at " << scene.shade_edge_m << ", still " << pointer.still_evidence
        << ", cloud " << pointer.cloud_evidence;
  }
}

TEST(Pointer, IsNotLookedForWhereThereIsNoneAndNeedsNeitherPictureNorCloud) {
  std::mt19937 random(4715);
  test::DrawnHandle scene = any_handle(random);
  const std::vector<CloudPoint> cloud = test::draw_bar_points(scene, 1.4);
  const BarPlace place = place_of(scene, random);
  EXPECT_FALSE(find_pointer(place, ImageView{}, {}, scene.camera, scene.valve).seen);
  const PointerObservation by_laser = find_pointer(place, ImageView{}, cloud, scene.camera, scene.valve);
  EXPECT_EQ(by_laser.still_evidence, 0);
  EXPECT_TRUE(by_laser.seen && toward_the_mark(by_laser, scene));
  scene.valve.pointer = PanelLayout::Pointer::none;
  EXPECT_FALSE(find_pointer(place, ImageView{}, cloud, scene.camera, scene.valve).seen);
  scene.valve.pointer = PanelLayout::Pointer::light_end;
  scene.valve.pointer_length_m = scene.valve.handle_length_m / 2;
  EXPECT_FALSE(find_pointer(place, ImageView{}, cloud, scene.camera, scene.valve).seen) << "half of the bar tells nothing";
}

// A straight line explains everything on both sides; a step is one-sided evidence. It is less than 1: the model's edge is blurred, the step's is not.
TEST(StepEvidence, IsZeroForALineAndOneSidedForAStep) {
  std::vector<BarSample> line, up, wrong_way;
  for (double s = -0.042; s <= 0.042; s += 0.001) {
    line.push_back({s, 100 + 300 * s, 1});
    up.push_back({s, s > 0.0183 ? 160.0 : 100.0, 1});
    wrong_way.push_back({s, s > 0.0183 ? 60.0 : 100.0, 1});
  }
  EXPECT_NEAR(step_evidence(line, 0.0183, 1, 1), 0, 1e-6);
  EXPECT_GT(step_evidence(up, 0.0183, 1, 1), 0.7);
  EXPECT_LT(step_evidence(up, -0.0183, 1, 1), -0.7);
  EXPECT_LE(step_evidence(wrong_way, 0.0183, 1, 1), 0) << "paint is lighter, not darker";
  EXPECT_GT(step_evidence(wrong_way, 0.0183, -1, 1), 0.7);
}

}  // namespace
}  // namespace lf::vision
