#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "hal/vision/calibration_file.hpp"
#include "hal/vision/marker_files.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/vision/rendered_marker.hpp"

namespace lf::vision {
namespace {

using testing::HasSubstr;

const std::string video_path = LANTERNFISH_TEST_DATA "/uw_apriltag16h5_video/test_vid.mp4";

class VisionFiles : public testing::Test {
 protected:
  VisionFiles() {
    std::string pattern = (std::filesystem::temp_directory_path() / "lanternfish-test-XXXXXX").string();
    if (::mkdtemp(pattern.data()) != nullptr) folder_ = pattern;
  }
  ~VisionFiles() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  static std::string bytes_of(const std::string& file_path, std::size_t most = std::string::npos) {
    std::ifstream file(file_path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    return bytes.substr(0, most);
  }
  template <class Act>
  static std::string refusal(const Act& act) {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "nothing was refused";
    return "";
  }

  std::filesystem::path folder_;
};

cv::Mat marker_picture() {
  test::MarkerScene scene;
  scene.camera_from_tag = test::looking_at_marker(0.6, 0.6, 0.5, 0.1);
  const test::RenderedMarker image = test::render_marker(scene);
  return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())).clone();
}

TEST_F(VisionFiles, MarkersInAnImageComeWithPosesAndAnOverlay) {
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

TEST_F(VisionFiles, WithoutACalibrationTheJsonHasNoPose) {
  cv::imwrite(path("tag.png"), marker_picture());
  const auto json = nlohmann::json::parse(marker_frames_json(find_markers_in_files({path("tag.png")}, {})));
  EXPECT_TRUE(json[0]["markers"][0]["pose"].is_null());
}

TEST_F(VisionFiles, SixteenBitImagesAreReadByTheirUpperBitsInUse) {
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

TEST_F(VisionFiles, ChannelsAreTheOnesNamed) {
  cv::imwrite(path("colour.png"), cv::Mat(20, 30, CV_8UC3, cv::Scalar(10, 20, 30)));  // blue, green, red
  EXPECT_EQ(read_image_file(path("colour.png"), channel_from_name("blue")).pixels[5], 10);
  EXPECT_EQ(read_image_file(path("colour.png"), channel_from_name("green")).pixels[5], 20);
  EXPECT_EQ(read_image_file(path("colour.png"), channel_from_name("red")).pixels[5], 30);
  EXPECT_EQ(read_image_file(path("colour.png"), channel_from_name("grey")).pixels[5], 22);  // ITU-R BT.601
  EXPECT_THROW(channel_from_name("violet"), InputError);
}

TEST_F(VisionFiles, BadImagesAndVideosAreRefusedInOneLine) {
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
      {path("missing.png"), "cannot be read"},
      {folder_.string(), "is a folder"},
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

TEST_F(VisionFiles, ACalibrationOfAnotherSizeAndAnOverlayThatCannotBeWrittenAreRefused) {
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

const std::string ros = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [430.2, 0., 306.7, 0., 430.5, 227.2, 0., 0., 1.]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.337586, 0.111431, -0.000601, -0.000104, 0.]
projection_matrix: {rows: 3, cols: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == text.npos ? text : text.replace(at, from.size(), to);
}

TEST_F(VisionFiles, CalibrationsOfRosAreRead) {
  const CameraIntrinsics camera = read_camera_calibration(write("ros.yaml", ros));
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 430.2);
  EXPECT_EQ(camera.fy, 430.5);
  EXPECT_EQ(camera.cx, 306.7);
  EXPECT_EQ(camera.cy, 227.2);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{-0.337586, 0.111431, -0.000601, -0.000104, 0}));
}

TEST_F(VisionFiles, CalibrationsThatOpenCvWritesAreRead) {
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << 800.5, 0, 313.25, 0, 801.25, 231.5, 0, 0, 1);
  const cv::Mat distortion = (cv::Mat_<double>(5, 1) << -0.25, 0.125, 1e-3, -2e-3, 0.0625);
  {
    cv::FileStorage file(path("cv.yml"), cv::FileStorage::WRITE);
    file << "calibration_time"
         << "today"
         << "image_width" << 640 << "image_height" << 480 << "camera_matrix" << matrix << "distortion_coefficients" << distortion
         << "avg_reprojection_error" << 0.3;
  }
  const CameraIntrinsics camera = read_camera_calibration(path("cv.yml"));
  EXPECT_EQ(camera.fx, 800.5);
  EXPECT_EQ(camera.cy, 231.5);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{-0.25, 0.125, 1e-3, -2e-3, 0.0625}));
}

TEST_F(VisionFiles, BadCalibrationsAreRefusedWithTheirLine) {
  const std::vector<std::pair<std::string, const char*>> texts{
      {replaced(ros, "plumb_bob", "equidistant"), "c.yaml:8: unknown distortion_model 'equidistant'"},
      {replaced(ros, "430.2", "-430.2"), "c.yaml:5: focal lengths must be positive"},
      {replaced(ros, "430.2", ".nan"), "c.yaml:7: a number of camera_matrix is not finite"},
      {replaced(ros, "430.2", "wide"), "c.yaml:7: a number of camera_matrix is not a number"},
      {replaced(ros, "  rows: 3", "  rows: 4"), "c.yaml:5: camera_matrix has 9 numbers"},
      {replaced(ros, "camera_matrix", "camera_matrx"), "camera_matrix is missing"},
      {replaced(replaced(ros, "cols: 5", "cols: 6"), "-0.000104, 0.]", "-0.000104, 0., 0.2]"), "beyond k1 k2 p1 p2 k3 must be zero"},
      {replaced(ros, "image_width: 640", "image_width: 6.5"), "c.yaml:1: image_width must be 1 to 65535"},
      {replaced(ros, "[430.2", "[430.2, ["), "c.yaml:"},
      {"just text\n", "is no calibration"},
      {"", "is no calibration"},
  };
  for (const auto& [text, message] : texts) {
    EXPECT_THAT(refusal([&] { read_camera_calibration(write("c.yaml", text)); }), HasSubstr(message)) << text;
  }
  EXPECT_THAT(refusal([&] { read_camera_calibration(path("missing.yaml")); }), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace lf::vision
