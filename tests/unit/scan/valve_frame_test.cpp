#include "firmware/scan/valve_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "firmware/scan/camera_model.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::scan {
namespace {

const PanelLayout layout;

MarkerCalibration nominal_marker() {
  MarkerCalibration marker;
  marker.id = layout.marker_id;
  marker.size_m = layout.marker_size_m;
  marker.panel_from_tag = layout.panel_from_tag();
  return marker;
}

double angle_deg(const Vec3& a, const Vec3& b) { return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b))); }

// What a perfect panel vision would answer, and its errors on top: `corner_px` rms on the corners, `plane_rad` on the plane's normal.
template <class Random>
PanelResult seen(const Pose& base_from_panel, double handle_rad, Random& random, double corner_px, double plane_rad) {
  std::normal_distribution<double> normal(0, 1);
  const CameraCalibration camera = test::nominal_camera();
  const CameraModel model(camera.intrinsics);
  const Pose camera_from_tag = camera.base_from_camera.inverse() * base_from_panel * layout.panel_from_tag();
  PanelResult result;
  result.fit.valid = true;
  result.fit.plane.normal = (base_from_panel.linear() * Vec3(plane_rad * normal(random), plane_rad * normal(random), 1)).normalized();
  result.fit.plane.offset_m = -result.fit.plane.normal.dot(base_from_panel.translation());
  result.marker.found = true;
  result.marker.id = layout.marker_id;
  result.marker.camera_from_tag = camera_from_tag;
  const double h = layout.marker_size_m / 2;
  const Vec3 corners[] = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
  for (int i = 0; i < 4; ++i)
    result.marker.corners_px[i] = *model.project(camera_from_tag * corners[i]) + corner_px * Vec2(normal(random), normal(random));

  ProudCluster handle;
  handle.centroid_m = base_from_panel * Vec3(0.001, -0.001, 0.103);
  handle.axis = base_from_panel.linear() * Vec3(-std::sin(handle_rad), std::cos(handle_rad), 0);
  handle.length_m = 0.095;
  handle.width_m = 0.0126;
  handle.height_m = 0.103;
  handle.points = 180;
  EXPECT_TRUE(result.clusters.push_back(handle));
  for (const Vec2& button : layout.buttons_m) {
    ProudCluster cap;
    cap.centroid_m = base_from_panel * Vec3(button.x() + 0.002, button.y() - 0.001, 0.030);
    cap.length_m = 0.04;
    cap.width_m = 0.038;
    cap.height_m = 0.030;
    cap.points = 250;
    EXPECT_TRUE(result.clusters.push_back(cap));
  }
  return result;
}

TEST(ValveFrameTest, IsExactWhereNothingErrs) {
  std::mt19937_64 random(30);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 30");
    const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
    const ValveFrame frame = find_valve_frame(seen(truth, 0.3, random, 0, 0), nominal_marker(), test::nominal_camera(), {});
    ASSERT_EQ(frame.outcome, ValveFrameOutcome::ok);
    EXPECT_LT((frame.base_from_panel.matrix() - truth.matrix()).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_NEAR(frame.marker_size_m, layout.marker_size_m, 1e-9);
    EXPECT_LT(frame.centre_disagreement_m, 1e-9);
    EXPECT_LT(frame.normal_disagreement_rad, 1e-7);
  }
}

TEST(ValveFrameTest, ValveBaseIsWithinAMillimetreAtCornerErrorsOfATenthPixel) {
  std::mt19937_64 random(31);
  std::vector<double> base_mm, normal_deg;
  for (int trial = 0; trial < 400; ++trial) {
    const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
    const ValveFrame frame =
        find_valve_frame(seen(truth, 0, random, 0.1, rad_from_deg(0.05)), nominal_marker(), test::nominal_camera(), {});
    ASSERT_EQ(frame.outcome, ValveFrameOutcome::ok) << "trial " << trial << " of seed 31";
    base_mm.push_back(1e3 * (frame.base_from_panel.translation() - truth.translation()).norm());
    normal_deg.push_back(angle_deg(frame.base_from_panel.linear().col(2), truth.linear().col(2)));
  }
  std::sort(base_mm.begin(), base_mm.end());
  EXPECT_LT(base_mm[380], 1.6);  // p95
  EXPECT_GT(base_mm[380], 0.3);
}

TEST(ValveFrameTest, SaysWhyThereIsNone) {
  std::mt19937_64 random(32);
  const Pose truth = layout.nominal_base_from_panel();
  const CameraCalibration camera = test::nominal_camera();
  const PanelResult good = seen(truth, 0, random, 0, 0);
  const auto outcome = [&](const PanelResult& result) { return find_valve_frame(result, nominal_marker(), camera, {}).outcome; };
  EXPECT_EQ(outcome(good), ValveFrameOutcome::ok);

  PanelResult bad = good;
  bad.fit.valid = false;
  EXPECT_EQ(outcome(bad), ValveFrameOutcome::no_plane);
  bad = good;
  bad.marker.found = false;
  EXPECT_EQ(outcome(bad), ValveFrameOutcome::no_marker);
  bad = good;
  bad.marker.id = layout.marker_id + 1;
  EXPECT_EQ(outcome(bad), ValveFrameOutcome::no_marker);
  bad = good;
  bad.marker.corners_px[2] += Vec2(12, 8);
  EXPECT_EQ(outcome(bad), ValveFrameOutcome::bad_marker);
  bad = good;
  bad.fit.plane.offset_m += 0.04;  // a plane 40 mm off makes the square larger, too
  EXPECT_NE(outcome(bad), ValveFrameOutcome::ok);
  bad = good;
  bad.marker.camera_from_tag.translation().z() += 0.05;
  EXPECT_EQ(outcome(bad), ValveFrameOutcome::poses_disagree);
  bad = good;
  bad.marker.corners_px[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(outcome(bad), ValveFrameOutcome::not_a_number);
  bad = good;
  bad.fit.plane.normal.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(outcome(bad), ValveFrameOutcome::not_a_number);
  // A plane through the camera.
  bad = good;
  bad.fit.plane.offset_m = -bad.fit.plane.normal.dot(camera.base_from_camera.translation());
  EXPECT_EQ(outcome(bad), ValveFrameOutcome::no_plane);
}

TEST(Handle, AngleIsAboutThePanelsNormalFromUpwardCounterClockwise) {
  std::mt19937_64 random(33);
  std::uniform_real_distribution<double> any(-pi / 2, pi / 2);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 33");
    const double angle = any(random);
    PanelResult result = seen(test::docked_panel(random, 0.020, rad_from_deg(2)), angle, random, 0, 0);
    if (trial % 2) result.clusters[0].axis = -result.clusters[0].axis;  // the axis has no sign
    const ValveFrame frame = find_valve_frame(result, nominal_marker(), test::nominal_camera(), {});
    const HandleObservation handle = find_handle(result, frame, layout, {});
    ASSERT_TRUE(handle.found);
    EXPECT_NEAR(wrap(handle.angle_rad - angle, pi / 2), 0, 1e-9);
    EXPECT_LT((handle.centre_m - Vec3(0.001, -0.001, 0.103)).norm(), 1e-9);
    EXPECT_GT(handle.sigma_rad, 0);
    EXPECT_LT(handle.sigma_rad, 0.05);
  }
}

TEST(Handle, IsNotWhatIsTooLowTooLongTooFarOrTooFewPoints) {
  std::mt19937_64 random(34);
  const PanelResult good = seen(layout.nominal_base_from_panel(), 0.5, random, 0, 0);
  const ValveFrame frame = find_valve_frame(good, nominal_marker(), test::nominal_camera(), {});
  const auto found = [&](auto change) {
    PanelResult result = good;
    change(result.clusters[0]);
    return find_handle(result, frame, layout, {}).found;
  };
  EXPECT_TRUE(found([](ProudCluster&) {}));
  EXPECT_FALSE(found([](ProudCluster& c) { c.height_m = 0.03; }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.length_m = 0.3; }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.length_m = 0.02; }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.centroid_m += Vec3(0, 0.05, 0); }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.points = 3; }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.axis.x() = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_FALSE(find_handle(good, ValveFrame{}, layout, {}).found);
}

TEST(Buttons, AreFoundNearTheirPlacesAndNowhereElse) {
  std::mt19937_64 random(35);
  PanelResult result = seen(test::docked_panel(random, 0.020, rad_from_deg(2)), 0, random, 0, 0);
  const ValveFrame frame = find_valve_frame(result, nominal_marker(), test::nominal_camera(), {});
  const auto buttons = find_buttons(result, frame, layout);
  for (std::size_t i = 0; i < buttons.size(); ++i) {
    ASSERT_TRUE(buttons[i].found);
    EXPECT_LT((buttons[i].centre_m - Vec3(layout.buttons_m[i].x() + 0.002, layout.buttons_m[i].y() - 0.001, 0.030)).norm(), 1e-9);
  }
  result.clusters[2].centroid_m += Vec3(0, 0, 0.05);  // the centre cap's points are somewhere else
  EXPECT_FALSE(find_buttons(result, frame, layout)[1].found);
  EXPECT_TRUE(find_buttons(result, frame, layout)[2].found);
}

}  // namespace
}  // namespace lf::scan
