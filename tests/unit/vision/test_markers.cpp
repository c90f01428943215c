#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <limits>
#include <random>

#include "hal/vision/corner_refinement.hpp"
#include "hal/vision/marker_detector.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/vision/rendered_marker.hpp"

namespace lf::vision {
namespace {

using test::looking_at_marker;
using test::MarkerScene;
using test::render_marker;
using test::RenderedMarker;

double angle_between_deg(const Pose& a, const Pose& b) {
  return deg_from_rad(Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle());
}

double worst_corner_px(const DetectedMarker& marker, const RenderedMarker& image) {
  double worst = 0;
  for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, (marker.corners_px[i] - image.corners_px[i]).norm());
  return worst;
}

struct Trial {
  double worst_corner_px, translation_mm, rotation_deg;
};

std::vector<Trial> trials(double noise_grey, int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  MarkerDetector detector({});
  std::vector<Trial> results;
  for (int i = 0; i < count; ++i) {
    MarkerScene scene;
    const Vec2 offset_m = 0.1 * Vec2(share(random) - 0.5, share(random) - 0.5);
    scene.camera_from_tag = looking_at_marker(0.5 + 0.3 * share(random), 0.25 + 0.65 * share(random), 2 * pi * share(random),
                                              0.6 * share(random) - 0.3, offset_m);
    scene.noise_grey = noise_grey;
    scene.seed = static_cast<std::uint32_t>(i);
    const RenderedMarker image = render_marker(scene);
    const auto markers = detector.detect(image.view());
    if (markers.size() != 1 || markers[0].id != scene.id) {
      ADD_FAILURE() << "trial " << i << " of seed 3: " << markers.size() << " markers";
      continue;
    }
    const auto pose = marker_pose(markers[0].corners_px, scene.size_m, scene.camera);
    if (!pose) {
      ADD_FAILURE() << "trial " << i << " of seed 3 has no pose";
      continue;
    }
    results.push_back({worst_corner_px(markers[0], image),
                       1000 * (pose->camera_from_tag.translation() - scene.camera_from_tag.translation()).norm(),
                       angle_between_deg(pose->camera_from_tag, scene.camera_from_tag)});
  }
  return results;
}

template <class Member>
double at_share(std::vector<Trial> results, Member member, double share) {
  std::sort(results.begin(), results.end(), [&](const Trial& a, const Trial& b) { return a.*member < b.*member; });
  return results[static_cast<std::size_t>(share * static_cast<double>(results.size() - 1))].*member;
}

TEST(Markers, HaveCornersWithinATenthOfAPixelOfTheTrueOnes) {
  const auto results = trials(0, 16);
  EXPECT_LT(at_share(results, &Trial::worst_corner_px, 1), 0.1);
  EXPECT_LT(at_share(results, &Trial::translation_mm, 1), 0.6);
  EXPECT_LT(at_share(results, &Trial::rotation_deg, 1), 0.3);
}

TEST(Markers, HaveCornersWithinATenthOfAPixelUnderTheNoisiestCamera) {
  const auto results = trials(3, 16);
  EXPECT_LT(at_share(results, &Trial::worst_corner_px, 0.9), 0.1);
  EXPECT_LT(at_share(results, &Trial::translation_mm, 0.9), 1.0);
  EXPECT_LT(at_share(results, &Trial::rotation_deg, 0.9), 0.6);
}

// The tag frame's axes seen by hand: upright, facing the camera, right of the middle and above it.
TEST(Markers, StandUprightInTheirOwnFrame) {
  MarkerScene scene;
  scene.camera_from_tag.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  scene.camera_from_tag.translation() = Vec3(0.06, -0.04, 0.5);
  const RenderedMarker image = render_marker(scene);
  const auto markers = MarkerDetector({}).detect(image.view());
  ASSERT_EQ(markers.size(), 1u);
  const auto& corners = markers[0].corners_px;
  EXPECT_LT(corners[0].x(), corners[1].x());  // bottom left, bottom right
  EXPECT_GT(corners[0].y(), corners[3].y());  // top left is above
  const auto pose = marker_pose(corners, scene.size_m, scene.camera);
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT((pose->camera_from_tag.translation() - scene.camera_from_tag.translation()).norm(), 0.001);
  EXPECT_LT(angle_between_deg(pose->camera_from_tag, scene.camera_from_tag), 3);  // seen face on, the tilt is weak
}

TEST(Markers, AreNotFoundInInvalidTinyOrEmptyImages) {
  MarkerDetector detector({});
  EXPECT_TRUE(detector.detect(ImageView{}).empty());
  const std::vector<std::uint8_t> grey(640 * 480, 100);
  EXPECT_TRUE(detector.detect({grey.data(), 640, 480, 640}).empty());
  for (const int size : {1, 3, 8, 15, 16, 17, 40}) EXPECT_TRUE(detector.detect({grey.data(), size, size, size}).empty()) << size;
}

TEST(Markers, AreTheSameInEveryRunAndLeaveTheImageAsItWas) {
  MarkerScene scene;
  scene.camera_from_tag = looking_at_marker(0.6, 0.7, 1, 0.1);
  scene.noise_grey = 2;
  const RenderedMarker image = render_marker(scene);
  const auto pixels = image.pixels;
  MarkerDetectorConfig config;
  config.blur_sigma_px = 0.8;
  MarkerDetector detector(config);
  const auto first = detector.detect(image.view());
  const auto second = detector.detect(image.view());
  ASSERT_EQ(first.size(), 1u);
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(first[0].corners_px, second[0].corners_px);
  EXPECT_EQ(image.pixels, pixels);
}

TEST(Markers, OfEveryFamilyCanBeLookedForAndOthersAreRefused) {
  for (const std::string& family : MarkerDetector::marker_families()) EXPECT_NO_THROW(MarkerDetector({.family = family})) << family;
  try {
    const MarkerDetector detector({.family = "36h12"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("unknown marker family '36h12'"));
    EXPECT_THAT(error.what(), testing::HasSubstr("36h11"));
  }
  EXPECT_THROW(MarkerDetector({.max_hamming = 3}), InputError);
  EXPECT_THROW(MarkerDetector({.decimate = 0.5}), InputError);
  EXPECT_THROW(MarkerDetector({.min_margin = std::numeric_limits<double>::quiet_NaN()}), InputError);
}

TEST(MarkerPose, IsExactForExactCornersAndTellsTheSecondSolution) {
  MarkerScene scene;
  scene.camera_from_tag = looking_at_marker(0.7, 0.9, 0.4, 0.2, {0.05, -0.03});
  const double h = scene.size_m / 2;
  std::array<Vec2, 4> corners;
  const std::array<Vec3, 4> square{Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 p = scene.camera_from_tag * square[i];
    corners[i] = Vec2(scene.camera.fx * p.x() / p.z() + scene.camera.cx, scene.camera.fy * p.y() / p.z() + scene.camera.cy);
  }
  const auto pose = marker_pose(corners, scene.size_m, scene.camera);
  ASSERT_TRUE(pose.has_value());
  EXPECT_TRUE(pose->camera_from_tag.isApprox(scene.camera_from_tag, 1e-6));
  EXPECT_LT(pose->reprojection_rms_px, 1e-5);
  ASSERT_TRUE(pose->has_second);
  EXPECT_GT(pose->ambiguity(), 100);
}

TEST(MarkerPose, IsNoneForCornersThatHaveNone) {
  const CameraIntrinsics camera;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(marker_pose({Vec2(1, 1), Vec2(2, nan), Vec2(3, 3), Vec2(4, 4)}, 0.08, camera).has_value());
  EXPECT_FALSE(marker_pose({Vec2(100, 120), Vec2(120, 120), Vec2(120, 100), Vec2(100, 100)}, 0, camera).has_value());
  const auto degenerate = marker_pose({Vec2(5, 5), Vec2(5, 5), Vec2(5, 5), Vec2(5, 5)}, 0.08, camera);
  if (degenerate) {
    EXPECT_TRUE(degenerate->camera_from_tag.matrix().allFinite());
  }
}

// Of an edge of 1e77 px as many profiles were wanted: a number that no integer holds.
TEST(RefineCorners, GivesBackCornersThatAreFarApart) {
  const std::vector<std::uint8_t> pixels(64 * 64, 90);
  for (const double far : {1e3, 1e9, 1e77}) {
    const std::array<Vec2, 4> corners{Vec2(10, 10), Vec2(far, 10), Vec2(far, far), Vec2(10, far)};
    std::feclearexcept(FE_INVALID);
    EXPECT_EQ(refine_corners(ImageView{pixels.data(), 64, 64, 64}, corners, 8), corners);
    EXPECT_EQ(std::fetestexcept(FE_INVALID), 0) << far;
  }
}

}  // namespace
}  // namespace lf::vision
