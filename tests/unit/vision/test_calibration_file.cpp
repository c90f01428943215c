#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "hal/vision/calibration_file.hpp"
#include "tests/unit/vision/vision_files.hpp"

namespace lf::vision {
namespace {

using testing::HasSubstr;

class CalibrationFile : public test::VisionFiles {};

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

TEST_F(CalibrationFile, ThoseOfRosAreRead) {
  const CameraIntrinsics camera = read_camera_calibration(write("ros.yaml", ros));
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 430.2);
  EXPECT_EQ(camera.fy, 430.5);
  EXPECT_EQ(camera.cx, 306.7);
  EXPECT_EQ(camera.cy, 227.2);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{-0.337586, 0.111431, -0.000601, -0.000104, 0}));
}

TEST_F(CalibrationFile, ThoseThatOpenCvWritesAreRead) {
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

TEST_F(CalibrationFile, BadOnesAreRefusedWithTheirLine) {
  const std::vector<std::pair<std::string, const char*>> texts{
      {replaced(ros, "plumb_bob", "equidistant"), "c.yaml:8: unknown distortion_model 'equidistant'"},
      {replaced(ros, "430.2", "-430.2"), "c.yaml:5: focal lengths must be positive"},
      {replaced(ros, "430.2", ".nan"), "c.yaml:7: a number of camera_matrix is not finite"},
      {replaced(ros, "430.2", "wide"), "c.yaml:7: a number of camera_matrix is not a number"},
      {replaced(ros, "  rows: 3", "  rows: 4"), "c.yaml:5: camera_matrix has 9 numbers"},
      {replaced(ros, "  rows: 3", "  rows: 1e107"), "camera_matrix.rows must be 0 to 65535"},
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
  EXPECT_THAT(refusal([&] { read_camera_calibration(path("missing.yaml")); }), HasSubstr("there is no such file"));
}

}  // namespace
}  // namespace lf::vision
