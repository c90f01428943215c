// A recorded still: tests/data/marker_still.
#include <gtest/gtest.h>

#include "hal/vision/image_file.hpp"
#include "hal/vision/panel_vision.hpp"

namespace lf::vision {
namespace {

GreyImage still() { return read_image_file(LANTERNFISH_TEST_DATA "/marker_still/seed_146.png"); }

TEST(MarkerStill, ShowsNoMarkerAtFullResolution) { EXPECT_TRUE(MarkerDetector({}).detect(still().view()).empty()); }

TEST(MarkerStill, HasItsMarkerFoundInASmallerPictureWithCornersOfTheWhole) {
  const std::array<Vec2, 4> seen{Vec2(252, 291), Vec2(298, 281), Vec2(295, 251), Vec2(246, 261)};
  const GreyImage image = still();
  PanelVisionConfig config;
  MarkerCalibration calibration;
  calibration.id = config.panel.markers[0].id;
  calibration.size_m = config.panel.markers[0].size_m;
  config.markers = MarkerCalibrations(calibration);
  PanelRequest request;
  request.has_still = true;
  const PanelResult result = analyse_panel(request, image.view(), {}, config);
  ASSERT_EQ(result.markers.size(), 1u);
  const MarkerObservation& marker = result.markers[0];
  EXPECT_GT(marker.margin, 10);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((marker.corners_px[i] - seen[i]).norm(), 3) << marker.corners_px[i].transpose();
}

}  // namespace
}  // namespace lf::vision
