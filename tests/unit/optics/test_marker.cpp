#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <gtest/gtest.h>

#include "shared/input_error.hpp"
#include "shared/panel/panel_layout.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

struct Found {
  int id = -1;
  int hamming = -1;
  double margin = 0;
  std::array<Vec2, 4> corners;
};

std::vector<Found> detect(const Frame& frame) {
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family(detector, family);
  detector->quad_decimate = 1;
  image_u8_t image{frame.width, frame.height, frame.width, const_cast<std::uint8_t*>(frame.pixels.data())};
  zarray_t* detections = apriltag_detector_detect(detector, &image);
  std::vector<Found> found;
  for (int i = 0; i < zarray_size(detections); ++i) {
    apriltag_detection_t* d = nullptr;
    zarray_get(detections, i, &d);
    Found f{d->id, d->hamming, d->decision_margin, {}};
    for (std::size_t c = 0; c < 4; ++c) f.corners[c] = {d->p[c][0], d->p[c][1]};
    found.push_back(f);
  }
  apriltag_detections_destroy(detections);
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
  return found;
}

// The reference layout's camera, panel and tag, with lamps on or off, in water of the given attenuation.
struct Layout {
  Layout() {
    CameraConfig camera;
    camera.base_from_camera = looking({0.015, -0.245, 0.060}, {0.678, 0.257, 0.688});
    config.cameras.push_back(camera);
    scene::Shape plate = make_shape(scene::ShapeKind::box, {0.8, 0.6, 0.02}, {0, -0.078, -0.01}, 0.6f);
    scene::Shape marker = make_shape(scene::ShapeKind::box, {0.1, 0.1, 0.002}, {tag().centre_m.x(), tag().centre_m.y(), 0.001}, 0.85f);
    marker.marker_id = tag().id;
    marker.marker_size_m = tag().size_m;
    body(config.scene, arm5e_body::panel).shapes = {plate, marker};
    LampConfig lamp;
    lamp.body_from_lamp = looking({0.0, 0.30, 0.03}, {0.70, -0.25, 0.66});
    config.lamps.push_back(lamp);
  }
  Frame render(double attenuation_per_m, bool lamps) {
    config.water.attenuation_per_m = attenuation_per_m;
    Optics optics(config);
    Shot shot;
    shot.poses = resting();
    shot.poses[arm5e_body::panel] = panel.nominal_base_from_panel();
    shot.laser = false;
    shot.lamps = lamps;
    Frame frame;
    optics.render(shot, frame);
    return frame;
  }
  Vec2 project(const Vec3& tag_point) const {
    const CameraIntrinsics k;
    const Pose base_from_tag = panel.nominal_base_from_panel() * tag().panel_from_tag();
    const Vec3 p = config.cameras[0].base_from_camera.inverse() * (base_from_tag * tag_point);
    return {k.cx + k.fx * p.x() / p.z(), k.cy + k.fy * p.y() / p.z()};
  }
  const PanelLayout::Marker& tag() const { return panel.markers[0]; }
  PanelLayout panel;
  OpticsConfig config;
};

TEST(MarkerImage, LibapriltagReadsItOnThePanelInAllWatersWithAndWithoutLamps) {
  Layout layout;
  for (const double attenuation : {0.1, 0.4, 0.8}) {
    for (const bool lamps : {false, true}) {
      const auto found = detect(layout.render(attenuation, lamps));
      ASSERT_EQ(found.size(), 1U) << attenuation << " " << lamps;
      EXPECT_EQ(found[0].id, layout.tag().id);
      EXPECT_EQ(found[0].hamming, 0);
      EXPECT_GT(found[0].margin, 10);
    }
  }
}

TEST(MarkerImage, ItsCornersAreWhereTheyProjectToAndTheRightWayUp) {
  Layout layout;
  layout.config.cameras[0].read_noise_grey = 0.2;
  const auto found = detect(layout.render(0.1, true));
  ASSERT_EQ(found.size(), 1U);
  // libapriltag's corners: lower left, lower right, upper right, upper left of the upright marker.
  const double h = 0.5 * layout.tag().size_m;
  const std::array<Vec3, 4> corners{Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
  // libapriltag counts pixel edges, not centres, from the image's corner: half a pixel more.
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((found[0].corners[i] - Vec2(0.5, 0.5) - layout.project(corners[i])).norm(), 0.35) << i;
  }
}

TEST(MarkerImage, WhiteShareOfAFootprintAcrossTheSquaresEdgeIsItsAreaOutside) {
  const Marker marker(7, 0.08);
  EXPECT_FLOAT_EQ(marker.white_share({0.045, 0}, {0.001, 0}, {0, 0.001}), 1.f);   // quiet zone
  EXPECT_FLOAT_EQ(marker.white_share({0.0375, 0}, {0.001, 0}, {0, 0.001}), 0.f);  // border
  EXPECT_NEAR(marker.white_share({0.04, 0}, {0.006, 0}, {0, 0.001}), 0.5, 1e-6);
}

TEST(MarkerImage, RefusesIdsThatTheFamilyDoesNotHave) {
  EXPECT_THROW(Marker(587, 0.08), InputError);
  EXPECT_THROW(Marker(-1, 0.08), InputError);
  EXPECT_THROW(Marker(7, 0), InputError);
}

}  // namespace
}  // namespace lf::optics::test
