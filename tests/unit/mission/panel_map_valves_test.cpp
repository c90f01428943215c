// A panel with two valves: what a look at one of them says of the other.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "firmware/mission/panel_map.hpp"
#include "firmware/scan/camera_model.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::mission {
namespace {

constexpr double a_tenth_rad = 0.1 * pi / 180;
constexpr PanelMap::Valves first = PanelMap::bit(0), second = PanelMap::bit(1);

class TwoValves : public testing::Test {
 protected:
  explicit TwoValves(PanelLayout::Pointer pointer = PanelLayout::Pointer::light_end) {
    PanelLayout::Valve left, right;
    left.pointer = right.pointer = pointer;
    right.at_m = Vec2(0.25, -0.15);
    right.handle_length_m = 0.14;
    layout_.valves = decltype(layout_.valves)(left, right);
    const PanelLayout::Marker& marker = layout_.markers[0];
    markers_ = MarkerCalibrations(MarkerCalibration{marker.id, marker.size_m, marker.panel_from_tag()});
  }

  PanelMap map() const { return {layout_, markers_, camera_, 3}; }

  // A look without error at handles that stand so; none: that handle's points are missing.
  PanelResult seen(std::optional<double> first_deg, std::optional<double> second_deg) const {
    const Pose base_from_panel = layout_.nominal_base_from_panel();
    PanelResult result;
    result.fit.valid = true;
    result.fit.plane.normal = base_from_panel.linear().col(2);
    result.fit.plane.offset_m = -result.fit.plane.normal.dot(base_from_panel.translation());
    result.fit.points = result.fit.inliers = 80000;
    result.confidence = 0.9f;
    result.markers = decltype(result.markers)(seen_marker(base_from_panel));
    const std::array<std::optional<double>, 2> handles_deg{first_deg, second_deg};
    for (std::size_t i = 0; i < 2; ++i) {
      const PanelLayout::Valve& valve = layout_.valves[i];
      PointerObservation pointer;
      if (handles_deg[i]) {
        const double rad = rad_from_deg(*handles_deg[i]);
        ProudCluster handle;
        handle.centroid_m = base_from_panel * valve.handle_centre_m();
        handle.axis = base_from_panel.linear() * Vec3(-std::sin(rad), std::cos(rad), 0);
        handle.length_m = valve.handle_length_m;
        handle.width_m = valve.handle_thickness_m;
        handle.height_m = handle.height_max_m = valve.handle_height_m;
        handle.points = 4000;
        EXPECT_TRUE(result.clusters.push_back(handle));
        pointer = {valve.has_pointer(), handle.axis, 0.8f};
      }
      EXPECT_TRUE(result.pointers.push_back(pointer));
    }
    return result;
  }

 private:
  MarkerObservation seen_marker(const Pose& base_from_panel) const {
    const PanelLayout::Marker& marker = layout_.markers[0];
    MarkerObservation seen;
    seen.id = marker.id;
    seen.margin = 80;
    seen.camera_from_tag = camera_.base_from_camera.inverse() * base_from_panel * marker.panel_from_tag();
    const double h = marker.size_m / 2;
    const std::array<Vec3, 4> corners{Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
    for (std::size_t i = 0; i < 4; ++i)
      seen.corners_px[i] = *scan::CameraModel(camera_.intrinsics).project(seen.camera_from_tag * corners[i]);
    return seen;
  }

  PanelLayout layout_;
  MarkerCalibrations markers_;
  CameraCalibration camera_ = test::nominal_camera();
};

class TwoValvesWithoutPointers : public TwoValves {
 protected:
  TwoValvesWithoutPointers() : TwoValves(PanelLayout::Pointer::none) {}
};

void expect_angles(const PanelMap& map, double first_deg, double second_deg) {
  EXPECT_NEAR(map.handle_rad(0), rad_from_deg(first_deg), a_tenth_rad);
  EXPECT_NEAR(map.handle_rad(1), rad_from_deg(second_deg), a_tenth_rad);
}

TEST_F(TwoValves, AreBothFoundByTheirOwnPlacesAndPointers) {
  for (const double degrees : {-100.0, -40.0, 0.0, 95.0}) {
    PanelMap map = this->map();
    ASSERT_EQ(map.update(seen(degrees, -degrees), first | second), StepFailure::none);
    expect_angles(map, degrees, -degrees);
    EXPECT_TRUE(map.handle_seen(0) && map.handle_seen(1));
    EXPECT_LT((map.handle(1).centre_m - Vec3(0.25, -0.15, 0.1)).norm(), 1e-6);
  }
}

TEST_F(TwoValves, OnlyTheWantedOneIsMissedAndTheOthersAngleStays) {
  PanelMap map = this->map();
  ASSERT_EQ(map.update(seen(20, -40), first | second), StepFailure::none);
  ASSERT_EQ(map.update(seen(50, {}), first), StepFailure::none) << "the second was not asked for";
  expect_angles(map, 50, -40);
  EXPECT_TRUE(map.handle_seen(1)) << "by the look before";
  ASSERT_EQ(map.update(seen(70, 80), first), StepFailure::none);
  expect_angles(map, 70, -40);

  EXPECT_EQ(map.update(seen(10, {}), second), StepFailure::no_handle);
  expect_angles(map, 70, -40);
  EXPECT_EQ(map.update(seen(10, {}), first | second), StepFailure::no_handle) << "one of two that are wanted";
  expect_angles(map, 70, -40);
  EXPECT_TRUE(map.handle_seen(1));

  ASSERT_EQ(map.update(seen({}, 5), second), StepFailure::none);
  expect_angles(map, 70, 5);
}

TEST_F(TwoValves, OneThatWasNeverWantedIsNotKnown) {
  PanelMap map = this->map();
  ASSERT_EQ(map.update(seen(20, -40), first), StepFailure::none);
  EXPECT_TRUE(map.handle_seen(0));
  EXPECT_FALSE(map.handle_seen(1));
  expect_angles(map, 20, 0);
}

// A job that only presses: a panel that is believed where a marker says has one of its valves where it belongs.
TEST_F(TwoValves, WhereNoneIsWantedOneHasToBeAtItsPlace) {
  PanelMap map = this->map();
  EXPECT_EQ(map.update(seen({}, {}), 0), StepFailure::no_handle);
  EXPECT_FALSE(map.known());
  EXPECT_EQ(map.update(seen({}, 30), 0), StepFailure::none);
  EXPECT_TRUE(map.known());
}

// A turn widens where its handle may be seen next, and says nothing of the other.
TEST_F(TwoValvesWithoutPointers, TheWayOfATurnIsThatOfItsOwnHandle) {
  PanelMap map = this->map();
  ASSERT_EQ(map.update(seen(0, 0), first | second), StepFailure::none);
  map.expect_handle(0, rad_from_deg(90));
  PanelMap other = map;
  ASSERT_EQ(map.update(seen(90, 3), first | second), StepFailure::none);
  expect_angles(map, 90, 3);
  EXPECT_EQ(other.update(seen(3, 90), second), StepFailure::beyond_stops) << "nobody has turned the second";
}

}  // namespace
}  // namespace lf::mission
