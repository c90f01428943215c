// Planes in real clouds, held to the lines of the data's README files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/scan/plane.hpp"

namespace lf::scan {
namespace {

const std::string data_folder = LANTERNFISH_TEST_DATA;

// LZF, as binary_compressed PCD files hold it: literal runs, and references back into what is out already.
std::vector<char> decompress(const std::vector<char>& in, std::size_t size) {
  std::vector<char> out;
  out.reserve(size);
  for (std::size_t i = 0; i < in.size();) {
    const unsigned control = static_cast<unsigned char>(in[i++]);
    if (control < 32) {
      out.insert(out.end(), in.begin() + static_cast<std::ptrdiff_t>(i), in.begin() + static_cast<std::ptrdiff_t>(i + control + 1));
      i += control + 1;
      continue;
    }
    unsigned length = control >> 5;
    if (length == 7) length += static_cast<unsigned char>(in[i++]);
    const std::size_t back = ((control & 31u) << 8) + static_cast<unsigned char>(in[i++]) + 1;
    for (unsigned k = 0; k < length + 2; ++k) out.push_back(out[out.size() - back]);
  }
  return out;
}

struct LabelledCloud {
  std::vector<CloudPoint> points;
  std::vector<std::uint32_t> labels;
};

// All fields of these files are four bytes, and stored one field after the other.
LabelledCloud read_pcd(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::string> fields;
  std::size_t count = 0;
  for (std::string line; std::getline(file, line) && line.rfind("DATA", 0) != 0;) {
    std::istringstream words(line);
    std::string key, word;
    words >> key;
    if (key == "FIELDS")
      while (words >> word) fields.push_back(word);
    if (key == "POINTS") words >> count;
  }
  std::uint32_t sizes[2] = {};
  file.read(reinterpret_cast<char*>(sizes), sizeof sizes);
  std::vector<char> packed(sizes[0]);
  file.read(packed.data(), sizes[0]);
  const std::vector<char> raw = decompress(packed, sizes[1]);
  LabelledCloud cloud;
  if (raw.size() != fields.size() * count * 4) return cloud;
  cloud.points.resize(count);
  cloud.labels.resize(count);
  for (std::size_t f = 0; f < fields.size(); ++f)
    for (std::size_t i = 0; i < count; ++i) {
      const char* from = raw.data() + 4 * (f * count + i);
      if (fields[f] == "x") std::memcpy(&cloud.points[i].p_m.x(), from, 4);
      if (fields[f] == "y") std::memcpy(&cloud.points[i].p_m.y(), from, 4);
      if (fields[f] == "z") std::memcpy(&cloud.points[i].p_m.z(), from, 4);
      if (fields[f] == "label") std::memcpy(&cloud.labels[i], from, 4);
    }
  return cloud;
}

double angle_deg(const Vec3& a, const Vec3& b) { return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b))); }

TEST(PlaneInRealClouds, TheTableIsWhereItsLabelsSay) {
  const LabelledCloud cloud = read_pcd(data_folder + "/pcl_planes/test43.pcd");
  ASSERT_EQ(cloud.points.size(), 170'986u);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const PlaneFit fit = std::make_unique<PlaneFitter>()->fit(cloud.points, {.threshold_m = 0.005, .seed = seed});
    ASSERT_TRUE(fit.valid);
    EXPECT_LT(angle_deg(fit.plane.normal, Vec3(0.00309, -0.82925, -0.55886)), 0.05);
    EXPECT_NEAR(fit.plane.offset_m, 0.59380, 0.0005);
    int table = 0, table_found = 0, objects_found = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const bool inlier = std::abs(fit.plane.signed_distance_m(cloud.points[i].p_m.cast<double>())) < 0.005;
      table += cloud.labels[i] == 1;
      table_found += cloud.labels[i] == 1 && inlier;
      objects_found += cloud.labels[i] != 1 && inlier;
    }
    ASSERT_EQ(table, 123'873);
    EXPECT_GE(table_found, 0.98 * table);
    EXPECT_LE(objects_found, 1000);
    EXPECT_EQ(fit.inliers, static_cast<std::uint32_t>(table_found + objects_found));
  }
}

TEST(PlaneInRealClouds, AThirdOfThePointsMayBeNoNumbers) {
  const LabelledCloud cloud = read_pcd(data_folder + "/pcl_planes/table_scene_mug_stereo_textured.pcd");
  ASSERT_EQ(cloud.points.size(), 307'200u);
  const PlaneFit fit = std::make_unique<PlaneFitter>()->fit(cloud.points, {.threshold_m = 0.005});
  ASSERT_TRUE(fit.valid);
  EXPECT_EQ(fit.points, 209'280u);
  EXPECT_LT(angle_deg(fit.plane.normal, Vec3(0.01624, -0.83749, -0.54622)), 0.1);  // PCL's, which is no truth
  EXPECT_NEAR(fit.plane.offset_m, 0.52903, 0.001);
  EXPECT_GT(fit.inliers, 0.99 * 123'132);
}

class TurbotsLaserPlane : public testing::Test {
 protected:
  void SetUp() override {
    cv::FileStorage file(data_folder + "/turbot_underwater_laser_plane/turbot_calibration.yaml", cv::FileStorage::READ);
    ASSERT_TRUE(file.isOpened());
    cv::Mat points, plane;
    file["points"] >> points;
    file["laser_plane"] >> plane;
    published_ = {Vec3(plane.at<double>(0), plane.at<double>(1), plane.at<double>(2)), plane.at<double>(3)};
    for (int i = 0; i < points.rows; ++i)
      points_.push_back({.p_m = Vec3(points.at<double>(i, 0), points.at<double>(i, 1), points.at<double>(i, 2)).cast<float>()});
    ASSERT_EQ(points_.size(), 9971u);
  }
  std::vector<CloudPoint> points_;
  Plane published_;
};

TEST_F(TurbotsLaserPlane, IsThePublishedOneWhenAllPointsAreInliers) {
  for (double threshold_m : {0.005, 0.010, 0.050}) {
    SCOPED_TRACE(threshold_m);
    const PlaneFit fit = std::make_unique<PlaneFitter>()->fit(points_, {.threshold_m = threshold_m});
    ASSERT_TRUE(fit.valid);
    EXPECT_EQ(fit.inliers, 9971u);
    EXPECT_LT((fit.plane.normal - published_.normal).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_NEAR(fit.plane.offset_m, published_.offset_m, 1e-6);
    EXPECT_NEAR(fit.rms_m, 0.0008997, 2e-6);
  }
}

TEST_F(TurbotsLaserPlane, IsNearThePublishedOneAtTwoMillimetres) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const PlaneFit fit = std::make_unique<PlaneFitter>()->fit(points_, {.threshold_m = 0.002, .seed = seed});
    ASSERT_TRUE(fit.valid);
    EXPECT_LT(angle_deg(fit.plane.normal, published_.normal), 0.15);
  }
}

}  // namespace
}  // namespace lf::scan
