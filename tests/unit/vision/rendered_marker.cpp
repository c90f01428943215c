#include "tests/unit/vision/rendered_marker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <random>

namespace lf::vision::test {
namespace {

constexpr int cells = 8;  // 36h11: 6 x 6 bits and the black border

// +1 white, 0 black; row 0 at the top.
cv::Mat bits_of(std::int32_t id) {
  cv::Mat image, upright;
  cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), id, cells, image, 1);
  cv::rotate(image, upright, cv::ROTATE_180);
  return upright;
}

double grey_at(const MarkerScene& scene, const cv::Mat& bits, const Pose& tag_from_camera, double u, double v) {
  const Vec3 origin = tag_from_camera.translation();
  const Vec3 ray = tag_from_camera.linear() * Vec3((u - scene.camera.cx) / scene.camera.fx, (v - scene.camera.cy) / scene.camera.fy, 1);
  const Vec3 p = origin - ray * (origin.z() / ray.z());
  if (std::abs(p.x()) > scene.plate_m / 2 || std::abs(p.y()) > scene.plate_m / 2) return scene.surround;
  const int column = static_cast<int>(std::floor((p.x() / scene.size_m + 0.5) * cells));
  const int row = static_cast<int>(std::floor((0.5 - p.y() / scene.size_m) * cells));
  if (column < 0 || column >= cells || row < 0 || row >= cells) return scene.white;
  return bits.at<std::uint8_t>(row, column) != 0 ? scene.white : scene.black;
}

// The pixel's mean grey: of 8 x 8 rays where its corners differ.
double mean_grey(const MarkerScene& scene, const cv::Mat& bits, const Pose& tag_from_camera, int u, int v) {
  constexpr int rays = 8;
  const auto at = [&](double du, double dv) { return grey_at(scene, bits, tag_from_camera, u + du, v + dv); };
  const double corner = at(-0.5, -0.5);
  if (corner == at(0.5, -0.5) && corner == at(-0.5, 0.5) && corner == at(0.5, 0.5)) return corner;
  double sum = 0;
  for (int i = 0; i < rays * rays; ++i) sum += at((i % rays + 0.5) / rays - 0.5, (i / rays + 0.5) / rays - 0.5);
  return sum / (rays * rays);
}

}  // namespace

RenderedMarker render_marker(const MarkerScene& scene) {
  RenderedMarker image{scene.camera.width, scene.camera.height, {}, {}};
  const cv::Mat bits = bits_of(scene.id);
  const Pose tag_from_camera = scene.camera_from_tag.inverse();
  std::mt19937 random(scene.seed);
  std::normal_distribution<double> noise(0, scene.noise_grey > 0 ? scene.noise_grey : 1);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const double grey = mean_grey(scene, bits, tag_from_camera, u, v) + (scene.noise_grey > 0 ? noise(random) : 0);
      image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L)));
    }
  }
  const double h = scene.size_m / 2;
  const std::array<Vec3, 4> corners{Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 p = scene.camera_from_tag * corners[i];
    image.corners_px[i] = Vec2(scene.camera.fx * p.x() / p.z() + scene.camera.cx, scene.camera.fy * p.y() / p.z() + scene.camera.cy);
  }
  return image;
}

Pose looking_at_marker(double distance_m, double tilt_rad, double tilt_axis_rad, double turn_rad, const Vec2& offset_m) {
  const Eigen::AngleAxisd facing(pi, Vec3::UnitX());  // the marker's z toward the camera, its y up in the image
  const Eigen::AngleAxisd tilt(tilt_rad, Vec3(std::cos(tilt_axis_rad), std::sin(tilt_axis_rad), 0));
  Pose camera_from_tag = Pose::Identity();
  camera_from_tag.linear() = (facing * tilt * Eigen::AngleAxisd(turn_rad, Vec3::UnitZ())).toRotationMatrix();
  camera_from_tag.translation() = Vec3(offset_m.x(), offset_m.y(), distance_m);
  return camera_from_tag;
}

}  // namespace lf::vision::test
