// Real frames: tests/data/uw_apriltag16h5_video.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "hal/vision/marker_files.hpp"

namespace lf::vision {
namespace {

// Surveyed centres on the tank's floor, metres.
const std::map<int, Vec2> layout_m{{0, {0.750, 0.500}},  {1, {1.548, 0.500}},  {2, {2.343, 0.500}},
                                   {3, {0.750, 1.265}},  {4, {1.550, 1.295}},  {5, {2.350, 1.285}},
                                   {12, {0.750, 2.057}}, {14, {1.545, 2.065}}, {16, {2.340, 2.077}}};
constexpr int unmapped_id = 13;  // lies there too, its place is not known

std::vector<MarkerFrame> frames_of_the_video() {
  MarkerFilesOptions options;
  options.detector.family = "16h5";
  options.detector.decimate = 2;
  options.detector.min_margin = 5;
  options.channel = Channel::green;
  options.camera = CameraIntrinsics{640, 480, 1127.7, 1139.3, 314.7352, 226.3186, {}};
  options.size_m = 0.1555;
  return find_markers_in_files({LANTERNFISH_TEST_DATA "/uw_apriltag16h5_video/test_vid.mp4"}, options);
}

std::vector<double> pair_ratios(const std::vector<MarkerFrame>& frames) {
  std::vector<double> ratios;
  for (const MarkerFrame& frame : frames) {
    for (const MarkerInFrame& a : frame.markers) {
      for (const MarkerInFrame& b : frame.markers) {
        if (a.marker.id >= b.marker.id || !a.pose || !b.pose || !layout_m.contains(a.marker.id) || !layout_m.contains(b.marker.id))
          continue;
        const double seen_m = (a.pose->camera_from_tag.translation() - b.pose->camera_from_tag.translation()).norm();
        ratios.push_back(seen_m / (layout_m.at(a.marker.id) - layout_m.at(b.marker.id)).norm());
      }
    }
  }
  std::sort(ratios.begin(), ratios.end());
  return ratios;
}

TEST(UnderwaterVideo, GivesTheTagsThatLieThereInAllFramesAndTheirSurveyedDistances) {
  const std::vector<MarkerFrame> frames = frames_of_the_video();
  EXPECT_EQ(frames.size(), 491u);
  int right = 0, other = 0;
  for (const MarkerFrame& frame : frames) {
    for (const MarkerInFrame& found : frame.markers) {
      (layout_m.contains(found.marker.id) || found.marker.id == unmapped_id ? right : other) += 1;
    }
  }
  EXPECT_GE(right, 1800);
  EXPECT_LE(right, 10 * 491);
  EXPECT_LE(other, 5);
  const std::vector<double> ratios = pair_ratios(frames);
  ASSERT_GT(ratios.size(), 500u);
  EXPECT_NEAR(ratios[ratios.size() / 2], 1.0, 0.02);
  RecordProperty("right", right);
  RecordProperty("other", other);
  RecordProperty("median_ratio", std::to_string(ratios[ratios.size() / 2]));
}

}  // namespace
}  // namespace lf::vision
