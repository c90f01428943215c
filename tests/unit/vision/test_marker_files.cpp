#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "hal/vision/marker_files.hpp"
#include "tests/unit/vision/rendered_marker.hpp"
#include "tests/unit/vision/vision_files.hpp"

namespace lf::vision {
namespace {

using testing::HasSubstr;

const std::string video_path = LANTERNFISH_TEST_DATA "/uw_apriltag16h5_video/test_vid.mp4";

class MarkerFiles : public test::VisionFiles {};

cv::Mat marker_picture() {
  test::MarkerScene scene;
  scene.camera_from_tag = test::looking_at_marker(0.6, 0.6, 0.5, 0.1);
  const test::RenderedMarker image = test::render_marker(scene);
  return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())).clone();
}

TEST_F(MarkerFiles, MarkersInAnImageComeWithPosesAndAnOverlay) {
  cv::imwrite(path("tag.png"), marker_picture());
  MarkerFilesOptions options;
  options.camera = CameraIntrinsics{};
  options.size_m = 0.08;
  options.overlay_path = path("overlay.png");
  const auto frames = find_markers_in_files({path("tag.png")}, options);
  ASSERT_EQ(frames.size(), 1u);
  ASSERT_EQ(frames[0].markers.size(), 1u);
  ASSERT_TRUE(frames[0].markers[0].pose.has_value());
  EXPECT_NEAR(frames[0].markers[0].pose->camera_from_tag.translation().z(), 0.6, 0.002);
  const cv::Mat overlay = cv::imread(path("overlay.png"));
  EXPECT_EQ(overlay.size(), cv::Size(640, 480));
  const Vec2 corner = frames[0].markers[0].marker.corners_px[0];
  const auto drawn = overlay.at<cv::Vec3b>(static_cast<int>(corner.y()), static_cast<int>(corner.x()));
  EXPECT_GT(drawn[2], drawn[0] + 100);  // red

  const auto json = nlohmann::json::parse(marker_frames_json(frames));
  EXPECT_EQ(json[0]["source"], path("tag.png"));
  EXPECT_EQ(json[0]["frame"], 0);
  EXPECT_EQ(json[0]["markers"][0]["id"], 7);
  EXPECT_EQ(json[0]["markers"][0]["corners"].size(), 4u);
  EXPECT_EQ(json[0]["markers"][0]["pose"]["quaternion_xyzw"].size(), 4u);
}

TEST_F(MarkerFiles, WithoutACalibrationTheJsonHasNoPose) {
  cv::imwrite(path("tag.png"), marker_picture());
  const auto json = nlohmann::json::parse(marker_frames_json(find_markers_in_files({path("tag.png")}, {})));
  EXPECT_TRUE(json[0]["markers"][0]["pose"].is_null());
}

TEST_F(MarkerFiles, SixteenBitImagesAreReadByTheirUpperBitsInUse) {
  cv::Mat deep;
  marker_picture().convertTo(deep, CV_16U, 16);  // a 12-bit camera
  cv::imwrite(path("deep.png"), deep);
  const GreyImage image = read_image_file(path("deep.png"));
  const cv::Mat original = marker_picture();
  EXPECT_TRUE(std::equal(image.pixels.begin(), image.pixels.end(), original.begin<std::uint8_t>()));
  const DeepImage all_bits = read_deep_image(path("deep.png"));
  EXPECT_TRUE(all_bits.deep);
  EXPECT_TRUE(all_bits.pixels8.empty());
  EXPECT_TRUE(std::equal(all_bits.pixels16.begin(), all_bits.pixels16.end(), deep.begin<std::uint16_t>()));
}

TEST_F(MarkerFiles, ChannelsAreTheOnesNamed) {
  cv::imwrite(path("colour.png"), cv::Mat(20, 30, CV_8UC3, cv::Scalar(10, 20, 30)));  // blue, green, red
  EXPECT_EQ(read_image_file(path("colour.png"), channel_from_name("blue")).pixels[5], 10);
  EXPECT_EQ(read_image_file(path("colour.png"), channel_from_name("green")).pixels[5], 20);
  EXPECT_EQ(read_image_file(path("colour.png"), channel_from_name("red")).pixels[5], 30);
  EXPECT_EQ(read_image_file(path("colour.png"), channel_from_name("grey")).pixels[5], 22);  // ITU-R BT.601
  EXPECT_THROW(channel_from_name("violet"), InputError);
}

TEST_F(MarkerFiles, BadImagesAndVideosAreRefusedInOneLine) {
  cv::imwrite(path("tag.png"), marker_picture());
  cv::imwrite(path("tag.jpg"), marker_picture());
  const std::string png = bytes_of(path("tag.png")), jpg = bytes_of(path("tag.jpg"));
  const std::string video = bytes_of(video_path);
  const std::vector<std::pair<std::string, const char*>> files{
      {write("half.png", png.substr(0, png.size() / 2)), "truncated"},
      {write("half.jpg", jpg.substr(0, jpg.size() / 2)), "truncated"},
      {write("head.jpg", jpg.substr(0, 100)), "truncated"},
      {write("text.png", "not an image"), "neither an image nor a video"},
      {write("empty.png", ""), "neither an image nor a video"},
      {write("half.mp4", video.substr(0, video.size() / 2)), "truncated"},
      {path("missing.png"), "there is no such file"},
      {folder_.path().string(), "is a folder"},
  };
  for (const auto& [file, message] : files) {
    const std::string text = refusal([&] { find_markers_in_files({file}, {}); });
    EXPECT_THAT(text, HasSubstr(message)) << file;
    EXPECT_EQ(text.find('\n'), std::string::npos) << file;
  }
  for (const char* name : {"half.png", "half.jpg", "text.png", "empty.png", "missing.png"}) {
    EXPECT_THAT(refusal([&] { read_image_file(path(name)); }), HasSubstr(name));
  }
}

TEST_F(MarkerFiles, ACalibrationOfAnotherSizeAndAnOverlayThatCannotBeWrittenAreRefused) {
  cv::imwrite(path("tag.png"), marker_picture());
  MarkerFilesOptions options;
  options.camera = CameraIntrinsics{};
  options.camera->width = 800;
  options.size_m = 0.08;
  EXPECT_THAT(refusal([&] { find_markers_in_files({path("tag.png")}, options); }),
              HasSubstr("is 640 x 480 px, but the calibration is for 800"));
  options.camera.reset();
  for (const std::string& overlay : {path("no/such/folder.png"), path("overlay.unknown")}) {
    options.overlay_path = overlay;
    EXPECT_THAT(refusal([&] { find_markers_in_files({path("tag.png")}, options); }), HasSubstr("cannot be written"));
  }
}

}  // namespace
}  // namespace lf::vision
