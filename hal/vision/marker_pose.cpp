#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "hal/vision/marker_detector.hpp"

namespace lf::vision {
namespace {

struct Solution {
  Pose camera_from_tag;
  double rms_px;
};

// In the order that IPPE_SQUARE asks for: top left, top right, bottom right, bottom left, with y up.
std::vector<cv::Point3d> square(double size_m) {
  const double h = size_m / 2;
  return {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
}

std::vector<cv::Point2d> from_top_left(const std::array<Vec2, 4>& corners_px) {
  std::vector<cv::Point2d> points;
  for (const std::size_t i : {3, 2, 1, 0}) points.emplace_back(corners_px[i].x(), corners_px[i].y());
  return points;
}

Pose pose_from_vectors(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  cv::Mat rotation;
  cv::Rodrigues(rotation_vector, rotation);
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.linear()(row, column) = rotation.at<double>(row, column);
    pose.translation()(row) = translation.at<double>(row);
  }
  return pose;
}

}  // namespace

double MarkerPose::ambiguity() const {
  constexpr double noise_px = 1e-3;  // errors below this are equal: no detector is that good
  if (!has_second) return 1e6;       // one solution only: nothing to mistake it for
  return std::max(second_rms_px, noise_px) / std::max(reprojection_rms_px, noise_px);
}

double MarkerPose::second_angle_rad() const {
  if (!has_second) return 0;
  return Eigen::AngleAxisd(Mat3(camera_from_tag.linear().transpose() * camera_from_tag_second.linear())).angle();
}

std::optional<MarkerPose> marker_pose(const std::array<Vec2, 4>& corners_px, double size_m, const CameraIntrinsics& camera) {
  const bool finite = std::all_of(corners_px.begin(), corners_px.end(), [](const Vec2& corner) { return corner.allFinite(); });
  if (!finite || !(size_m > 0)) return std::nullopt;
  const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Mat distortion(1, 5, CV_64F, const_cast<double*>(camera.distortion.data()));
  const std::vector<cv::Point3d> object = square(size_m);
  const std::vector<cv::Point2d> image = from_top_left(corners_px);

  std::vector<Solution> solutions;
  try {
    std::vector<cv::Mat> rotations, translations;
    cv::solvePnPGeneric(object, image, matrix, distortion, rotations, translations, false, cv::SOLVEPNP_IPPE_SQUARE);
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      cv::solvePnPRefineLM(object, image, matrix, distortion, rotations[i], translations[i]);
      std::vector<cv::Point2d> projected;
      cv::projectPoints(object, rotations[i], translations[i], matrix, distortion, projected);
      const Solution solution{pose_from_vectors(rotations[i], translations[i]), cv::norm(projected, image, cv::NORM_L2) / 2};
      const bool in_front = solution.camera_from_tag.translation().z() > size_m / 2;
      if (std::isfinite(solution.rms_px) && solution.camera_from_tag.matrix().allFinite() && in_front) solutions.push_back(solution);
    }
  } catch (const cv::Exception&) {
    return std::nullopt;  // corners on one line
  }
  if (solutions.empty()) return std::nullopt;
  std::stable_sort(solutions.begin(), solutions.end(), [](const Solution& a, const Solution& b) { return a.rms_px < b.rms_px; });

  MarkerPose pose;
  pose.camera_from_tag = solutions[0].camera_from_tag;
  pose.reprojection_rms_px = solutions[0].rms_px;
  pose.has_second = solutions.size() > 1;
  if (pose.has_second) {
    pose.camera_from_tag_second = solutions[1].camera_from_tag;
    pose.second_rms_px = solutions[1].rms_px;
  }
  return pose;
}

}  // namespace lf::vision
