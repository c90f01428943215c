#include "firmware/mission/sight.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lf::mission {
namespace {

// The panel's plane, pushed away from the robot by `off_m` and turned by `tilt_rad` about the base's z at the valve.
PlaneFit plane(const PanelLayout& layout, double off_m, double tilt_rad) {
  PlaneFit fit;
  fit.valid = true;
  fit.plane.normal = Vec3(-std::cos(tilt_rad), -std::sin(tilt_rad), 0);
  fit.plane.offset_m = -fit.plane.normal.dot(Vec3(layout.nominal_x_m + off_m, layout.nominal_y_m, layout.nominal_z_m));
  fit.points = 1000;
  fit.inliers = 900;
  return fit;
}

TEST(Sight, HoldsThePlaneAgainstTheNominalPanel) {
  const PanelLayout layout;
  PanelResult result;
  result.id = 3;
  result.fit = plane(layout, 0.25, 0.1);
  const Sight sight = sight_of(result, {}, {}, layout, 0, CameraCalibration{});
  EXPECT_EQ(sight.look, 3u);
  EXPECT_TRUE(sight.plane_found);
  EXPECT_EQ(sight.inliers, 900u);
  EXPECT_NEAR(sight.plane_off_m, 0.25 * std::cos(0.1), 1e-6);
  EXPECT_NEAR(sight.plane_tilt_rad, 0.1, 1e-6);
  result.fit = plane(layout, -0.02, 0);
  EXPECT_NEAR(sight_of(result, {}, {}, layout, 0, CameraCalibration{}).plane_off_m, -0.02, 1e-6);
  result.fit.plane.offset_m = std::nan("");
  EXPECT_FALSE(sight_of(result, {}, {}, layout, 0, CameraCalibration{}).plane_found);
}

TEST(Sight, HoldsTheMarkerAgainstItsNominalPlace) {
  const PanelLayout layout;
  CameraCalibration camera;
  camera.base_from_camera = Pose(Eigen::Translation3d(0.1, -0.2, 0.05) * Eigen::AngleAxisd(0.7, Vec3::UnitY()));
  PanelResult result;
  MarkerObservation marker;
  marker.id = layout.markers[0].id;
  marker.margin = 55;
  const Vec3 seen_m = (layout.nominal_base_from_panel() * layout.markers[0].panel_from_tag()).translation() + Vec3(0.03, 0, -0.04);
  marker.camera_from_tag.translation() = camera.base_from_camera.inverse() * seen_m;
  ASSERT_TRUE(result.markers.push_back(marker));
  const Sight sight = sight_of(result, {}, {}, layout, 0, camera);
  EXPECT_TRUE(sight.marker_found);
  EXPECT_NEAR(sight.marker_off_m, 0.05, 1e-6);
  EXPECT_EQ(sight.marker_margin_grey, 55);
  result.markers.clear();
  EXPECT_EQ(sight_of(result, {}, {}, layout, 0, camera).marker_off_m, 0);
}

// 8 mm of the marker's 64 at 500 px, 1.25 m ahead: 3.2 px.
TEST(Sight, SaysHowLargeASquareOfTheMarkersCodeIsInThePicture) {
  PanelLayout layout;
  layout.markers[0].size_m = 0.064;
  CameraCalibration camera;
  camera.intrinsics.fx = 500;
  const Vec3 tag_m = (layout.nominal_base_from_panel() * layout.markers[0].panel_from_tag()).translation();
  camera.base_from_camera.translation() = tag_m - Vec3(0.3, 0.1, 1.25);
  EXPECT_NEAR(sight_of({}, {}, {}, layout, 0, camera).marker_cell_px, 3.2, 1e-5);
  camera.base_from_camera.translation() = tag_m + Vec3(0, 0, 1);
  EXPECT_EQ(sight_of({}, {}, {}, layout, 0, camera).marker_cell_px, 0) << "behind the camera";
}

TEST(Sight, TakesForTheHandleWhatHasItsHeightAndLength) {
  const PanelLayout layout;
  PanelResult result;
  ProudCluster button, far, near;
  button.height_m = layout.buttons[0].height_m;
  button.length_m = layout.buttons[0].width_m;
  far.height_m = near.height_m = layout.valves[0].handle_height_m;
  far.length_m = near.length_m = layout.valves[0].handle_length_m;
  button.centroid_m = near.centroid_m = layout.nominal_base_from_panel() * Vec3(0, 0, layout.valves[0].handle_height_m);
  near.centroid_m += Vec3(0, 0.03, 0.04);
  far.centroid_m = near.centroid_m + Vec3(0, 0.5, 0);
  (void)result.clusters.push_back(button);
  EXPECT_FALSE(sight_of(result, {}, {}, layout, 0, CameraCalibration{}).handle_found);
  (void)result.clusters.push_back(far);
  (void)result.clusters.push_back(near);
  const Sight sight = sight_of(result, {}, {}, layout, 0, CameraCalibration{});
  EXPECT_TRUE(sight.handle_found);
  EXPECT_NEAR(sight.handle_off_m, 0.05, 1e-6);
  EXPECT_EQ(sight.proud_clusters, 3u);
}

// Counters run on from power-on: a look has what came since its sweep began.
TEST(Sight, CountsFromTheBeginningOfItsSweep) {
  ScanStats before, now;
  before.stripes = 100;
  before.stills = 1;
  before.peaks = 5000;
  before.still = {1, 2, 3};
  now = before;
  now.stripes = 130;
  now.peaks = 5600;
  now.peaks_weak = 40;
  now.peaks_saturated = 7;
  now.peaks_misfit = 20;
  now.peaks_unfitted = 3;
  now.peaks_apart = 100;
  now.stripe.width_px = 1.6f;
  now.images_missing = 2;
  now.images_refused = 3;
  Sight sight = sight_of({}, before, now, {}, 0, CameraCalibration{});
  EXPECT_EQ(sight.stripes, 30u);
  EXPECT_EQ(sight.columns_found, 600u);
  EXPECT_EQ(sight.columns_weak, 40u);
  EXPECT_EQ(sight.columns_saturated, 7u);
  EXPECT_EQ(sight.columns_misfit, 123u);
  EXPECT_EQ(sight.stripe.width_px, 1.6f);
  EXPECT_EQ(sight.images_missing, 2u);
  EXPECT_EQ(sight.images_refused, 3u);
  EXPECT_FALSE(sight.still_taken);
  EXPECT_EQ(sight.still.mean_grey, 0) << "the still of the look before is not this one's";
  now.stills = 2;
  now.still = {90, 30, 0};
  sight = sight_of({}, before, now, {}, 0, CameraCalibration{});
  EXPECT_TRUE(sight.still_taken);
  EXPECT_EQ(sight.still.contrast_grey, 30);
}

}  // namespace
}  // namespace lf::mission
