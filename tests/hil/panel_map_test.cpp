// What the mission makes of an answer of panel vision: which of two angles half a turn apart a bar has, and why an answer is not taken.
#include "firmware/mission/panel_map.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "tests/hil/known_sight.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::test {
namespace {

using mission::PanelMap;

struct Panel {
  PanelLayout layout;
  MarkerCalibrations markers;
  CameraCalibration camera = nominal_camera();

  explicit Panel(PanelLayout::Pointer pointer = PanelLayout::Pointer::light_end) {
    layout.valves[0].pointer = pointer;
    const PanelLayout::Marker& marker = layout.markers[0];
    (void)markers.push_back({marker.id, marker.size_m, marker.panel_from_tag()});
  }
  PanelMap map(std::size_t laser_joints = 3) const { return {layout, markers, camera, laser_joints}; }
  PanelResult seen(double handle_deg, const Vec3& shift_m = Vec3::Zero()) const {
    Pose pose = layout.nominal_base_from_panel();
    pose.translation() += shift_m;
    return panel_as_it_is(pose, std::array{rad_from_deg(handle_deg)}, layout, markers, camera);
  }
};

constexpr double a_tenth_deg = 0.1;
constexpr PanelMap::Valves first = PanelMap::bit(0);

TEST(PanelMap, TellsEveryAngleBetweenTheStopsByItsPointer) {
  const Panel panel;
  for (double degrees = -105; degrees <= 105; degrees += 5) {
    PanelMap map = panel.map();
    ASSERT_EQ(map.update(panel.seen(degrees), first), StepFailure::none) << degrees;
    EXPECT_NEAR(deg_from_rad(map.handle_rad(0)), degrees, a_tenth_deg);
  }
}

TEST(PanelMap, APlaneThatIsNoNumberIsNoPanel) {
  const Panel panel;
  PanelMap map = panel.map();
  PanelResult result = panel.seen(20);
  result.fit.plane.offset_m = std::nan("");
  EXPECT_EQ(map.update(result, first), StepFailure::no_panel);
  EXPECT_FALSE(map.known());
}

TEST(PanelMap, WithoutAPointerTakesWhatTheStopsMakeUniqueAndRefusesTheRestByName) {
  const Panel panel(PanelLayout::Pointer::none);
  for (double degrees = -104; degrees <= 105; degrees += 1) {
    PanelMap map = panel.map();
    const StepFailure failure = map.update(panel.seen(degrees), first);
    if (std::abs(degrees) <= 71) {
      EXPECT_EQ(failure, StepFailure::none) << degrees;
      EXPECT_NEAR(deg_from_rad(map.handle_rad(0)), degrees, a_tenth_deg);
    } else if (std::abs(degrees) >= 73) {
      EXPECT_EQ(failure, StepFailure::half_turn_open) << degrees;
      EXPECT_FALSE(map.known()) << "nothing is guessed";
    }
  }
}

TEST(PanelMap, WithoutAPointerKnowsTheHandleOnTheWayOfItsOwnTurn) {
  const Panel panel(PanelLayout::Pointer::none);
  for (const double found : {0.0, 45.0, 90.0, 95.0}) {  // it followed all the way, half of it, or not at all
    PanelMap map = panel.map();
    ASSERT_EQ(map.update(panel.seen(0), first), StepFailure::none);
    map.expect_handle(0, rad_from_deg(50));
    map.expect_handle(0, rad_from_deg(90));
    ASSERT_EQ(map.update(panel.seen(found), first), StepFailure::none) << found;
    EXPECT_NEAR(deg_from_rad(map.handle_rad(0)), found, a_tenth_deg);
  }
}

// From -70 to 90 both ends look alike to within the margins: a handle that slipped at once would be taken for one that followed.
TEST(PanelMap, WithoutAPointerDoesNotTellAHandleThatStayedFromOneThatTurnedHalfATurn) {
  const Panel panel(PanelLayout::Pointer::none);
  PanelMap map = panel.map();
  ASSERT_EQ(map.update(panel.seen(-70), first), StepFailure::none);
  map.expect_handle(0, rad_from_deg(100));
  EXPECT_EQ(map.update(panel.seen(-75), first), StepFailure::half_turn_open);
  EXPECT_LT(map.longest_turn_rad(0), rad_from_deg(170)) << "so long a turn is made in two";
}

struct Poor {
  const char* name;
  std::function<void(PanelResult&)> spoil;
  StepFailure why;
};
void PrintTo(const Poor& poor, std::ostream* out) { *out << poor.name; }

class PoorVision : public testing::TestWithParam<Poor> {};

TEST_P(PoorVision, IsNamedByItsCauseAndChangesNothing) {
  const Panel panel;
  PanelMap map = panel.map();
  ASSERT_EQ(map.update(panel.seen(10), first), StepFailure::none);
  PanelResult poor = panel.seen(40);
  GetParam().spoil(poor);
  EXPECT_EQ(map.update(poor, first), GetParam().why) << name(map.update(poor, first));
  EXPECT_NEAR(deg_from_rad(map.handle_rad(0)), 10, a_tenth_deg);
  EXPECT_STRNE(name(GetParam().why), "unknown");
  EXPECT_STRNE(remedy(GetParam().why), "");
}

INSTANTIATE_TEST_SUITE_P(
    Causes, PoorVision,
    testing::Values(Poor{"NoPlane", [](PanelResult& r) { r.fit.valid = false; }, StepFailure::no_panel},
                    Poor{"FewPoints", [](PanelResult& r) { r.fit.points = 100; }, StepFailure::too_few_points},
                    Poor{"CloudOffThePlane", [](PanelResult& r) { r.fit.inliers = r.fit.points / 5; }, StepFailure::plane_unsure},
                    Poor{"LineMisshapen", [](PanelResult& r) { r.fit.shape_shift_m = 0.0031; }, StepFailure::line_misshapen},
                    Poor{"LineOfNoShape", [](PanelResult& r) { r.fit.shape_shift_m = std::numeric_limits<double>::quiet_NaN(); },
                         StepFailure::line_misshapen},
                    Poor{"NoMarker", [](PanelResult& r) { r.markers.clear(); }, StepFailure::no_marker},
                    Poor{"MarkerTooSmall",
                         [](PanelResult& r) {
                           for (Vec2& c : r.markers[0].corners_px) c = r.markers[0].centre_px + 0.7 * (c - r.markers[0].centre_px);
                         },
                         StepFailure::marker_wrong},
                    Poor{"MarkerElsewhere", [](PanelResult& r) { r.markers[0].camera_from_tag.translation().z() += 0.1; },
                         StepFailure::marker_disagrees},
                    Poor{"MarkerTilted",
                         [](PanelResult& r) {
                           r.markers[0].camera_from_tag.linear() =
                               r.markers[0].camera_from_tag.linear() * Eigen::AngleAxisd(0.7, Vec3::UnitX());
                         },
                         StepFailure::marker_disagrees},
                    Poor{"NoHandle", [](PanelResult& r) { r.clusters.clear(); }, StepFailure::no_handle},
                    Poor{"HandleOfFewPoints",
                         [](PanelResult& r) {
                           r.clusters[0].points = 25;
                           r.clusters[0].length_m = 0.06;
                           r.clusters[0].width_m = 0.012;
                         },
                         StepFailure::handle_unsure},
                    Poor{"NoConfidence", [](PanelResult& r) { r.confidence = 0; }, StepFailure::vision_failed}),
    [](const auto& cause) { return cause.param.name; });

TEST(PanelMap, DoubtsThePanelsPlaceByTheLinesShape) {
  const Panel panel;
  PanelMap plain = panel.map(), skewed = panel.map();
  PanelResult result = panel.seen(10);
  result.fit.shape_shift_m = 0;
  ASSERT_EQ(plain.update(result, first), StepFailure::none);
  result.fit.shape_shift_m = 0.0024;
  ASSERT_EQ(skewed.update(result, first), StepFailure::none);
  EXPECT_NEAR(skewed.doubt().shift_m - plain.doubt().shift_m, 0.0024, 1e-9);
  EXPECT_GT(skewed.doubt().turn_rad, plain.doubt().turn_rad + 0.002);
}

// What calibration errs by weighs by the light's way and by the angle at which the camera looks at the laser's sheet, and with each joint that carries the laser.
TEST(PanelMap, DoubtsAPanelThatIsSeenFromFarByMore) {
  const Panel panel;
  PanelMap near = panel.map(), far = panel.map(), longer = panel.map(5);
  PanelResult result = panel.seen(10);
  for (const double depth_m_per_rad : {0.0, 1.0, 1.25}) {
    result.fit.depth_m_per_rad = depth_m_per_rad;
    ASSERT_EQ(near.update(result, first), StepFailure::none);
    EXPECT_EQ(near.deeper_m(), 0) << depth_m_per_rad;
    EXPECT_EQ(near.doubt().shift_m, near.doubt_where_touched().shift_m);
  }
  result.fit.depth_m_per_rad = 2.5;
  ASSERT_EQ(far.update(result, first), StepFailure::none);
  ASSERT_EQ(longer.update(result, first), StepFailure::none);
  EXPECT_NEAR(far.deeper_m(), 0.0021, 1e-12);
  EXPECT_NEAR(longer.deeper_m(), 1.8 * 0.0021, 1e-12) << "7 parts in place of 5, twice as far";
  EXPECT_NEAR(far.doubt().shift_m - near.doubt().shift_m, 0.0021, 1e-12);
  EXPECT_EQ(far.doubt_where_touched().shift_m, near.doubt().shift_m);
  EXPECT_EQ(far.doubt().turn_rad, near.doubt().turn_rad);
}

TEST(PanelMap, DoubtsThePanelsPlaceByThePlanesBendAndNotByItsPointsScatter) {
  const Panel panel;
  PanelMap plain = panel.map(), bent = panel.map(), speckled = panel.map();
  PanelResult result = panel.seen(10);
  ASSERT_EQ(plain.update(result, first), StepFailure::none);
  PanelResult bends = result, scatters = result;
  bends.fit.bend_m += 0.001;
  scatters.fit.rms_m += 0.001;
  ASSERT_EQ(bent.update(bends, first), StepFailure::none);
  ASSERT_EQ(speckled.update(scatters, first), StepFailure::none);
  EXPECT_NEAR(bent.doubt().shift_m - plain.doubt().shift_m, 0.002, 1e-9);
  EXPECT_NEAR(bent.doubt().turn_rad - plain.doubt().turn_rad, 0.002 / result.fit.seen_m, 1e-9);
  bends.fit.seen_m = 0.12;
  ASSERT_EQ(bent.update(bends, first), StepFailure::none);
  EXPECT_NEAR(bent.doubt().turn_rad,
              plain.doubt().turn_rad + (bent.doubt().shift_m - 0.0021) / 0.12 - (plain.doubt().shift_m - 0.0021) / result.fit.seen_m, 1e-9)
      << "a strip of the panel tells less of its tilt";
  EXPECT_EQ(speckled.doubt().shift_m, plain.doubt().shift_m);
}

TEST(PanelMap, TellsWhatItsLookLeavesOver) {
  const Panel panel;
  PanelMap map = panel.map();
  EXPECT_FALSE(map.fit().known);
  ASSERT_EQ(map.update(panel.seen(0), first), StepFailure::none);
  ASSERT_TRUE(map.fit().known);
  EXPECT_NEAR(map.fit().marker_side_error, 0, 1e-6);
  EXPECT_NEAR(map.fit().marker_corners_m, 0, 1e-7);
  EXPECT_TRUE(std::isnan(map.fit().panel_shift_m)) << "there was none before";
  EXPECT_NEAR(map.fit().marker_size_m, panel.layout.markers[0].size_m, 1e-7);

  // The marker's plane a hundredth farther than it is: the rays of its corners meet it in a square so much larger.
  PanelResult far = panel.seen(0);
  const double camera_m = far.fit.plane.signed_distance_m(panel.camera.base_from_camera.translation());
  far.fit.plane.offset_m += 0.01 * (camera_m - panel.layout.markers[0].panel_from_tag().translation().z());
  far.fit.bend_m = 0.0004;
  ASSERT_EQ(map.update(far, first), StepFailure::none);
  EXPECT_NEAR(map.fit().marker_side_error, 0.01, 1e-6);
  EXPECT_NEAR(map.fit().marker_corners_m, 0, 1e-7);
  EXPECT_NEAR(map.fit().plane_bend_m, 0.0004, 1e-9);
  EXPECT_NEAR(map.fit().panel_shift_m, (map.base_from_panel().translation() - panel.layout.nominal_base_from_panel().translation()).norm(),
              1e-6);

  // One corner off by a fiftieth of the side: no square.
  PanelResult skewed = panel.seen(0);
  const double side_px = (skewed.markers[0].corners_px[1] - skewed.markers[0].corners_px[0]).norm();
  skewed.markers[0].corners_px[2].x() += 0.02 * side_px;
  (void)map.update(skewed, first);
  EXPECT_GT(map.fit().marker_corners_m, 0.005 * panel.layout.markers[0].size_m);

  PanelResult no_marker = panel.seen(0);
  no_marker.markers.clear();
  (void)map.update(no_marker, first);
  EXPECT_FALSE(map.fit().known);
}

TEST(PanelMap, NamesAPointerThatItDidNotRecogniseWhereTheStopsLeaveItOpen) {
  const Panel panel;
  PanelResult faint = panel.seen(90);
  faint.pointers[0].confidence = 0.1f;
  EXPECT_EQ(panel.map().update(faint, first), StepFailure::pointer_unsure);
  PanelResult clear_by_stops = panel.seen(30);
  clear_by_stops.pointers[0].confidence = 0.1f;
  EXPECT_EQ(panel.map().update(clear_by_stops, first), StepFailure::none);
}

TEST(PanelMap, NamesAHandleThatStandsWhereItsStopsDoNotLetIt) {
  const Panel panel;
  EXPECT_EQ(panel.map().update(panel.seen(150), first), StepFailure::beyond_stops);
  EXPECT_EQ(panel.map().update(panel.seen(106), first), StepFailure::none) << "a look errs by a degree";
}

TEST(PanelMap, HoldsEveryLookAgainstTheFirstSoThatAShiftSeenTwiceIsNamedTwice) {
  const Panel panel;
  PanelMap map = panel.map();
  ASSERT_EQ(map.update(panel.seen(0), first), StepFailure::none);
  EXPECT_EQ(map.update(panel.seen(0, Vec3(0, 0.03, 0)), first), StepFailure::panel_moved);
  EXPECT_EQ(map.update(panel.seen(0, Vec3(0, 0.03, 0)), first), StepFailure::panel_moved);
  EXPECT_EQ(map.update(panel.seen(0, Vec3(0, 0.001, 0)), first), StepFailure::none);
}

}  // namespace
}  // namespace lf::test
