#include "tests/unit/vision/drawn_handle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

namespace lf::vision::test {
namespace {

constexpr int finer = 8;  // the picture is drawn so many times larger and shrunk: edges fall where they should

// Undistorted pinhole.
cv::Point2d pixel(const DrawnHandle& scene, const Vec3& in_panel) {
  const Vec3 p = scene.camera.base_from_camera.inverse() * (scene.base_from_panel * in_panel);
  const CameraIntrinsics& camera = scene.camera.intrinsics;
  return {camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy};
}

void fill(cv::Mat& picture, const DrawnHandle& scene, const std::array<Vec3, 4>& corners, double grey) {
  std::vector<cv::Point> points;
  for (const Vec3& corner : corners) {
    const cv::Point2d px = pixel(scene, corner);
    points.emplace_back(static_cast<int>(std::lround((px.x + 0.5) * finer)), static_cast<int>(std::lround((px.y + 0.5) * finer)));
  }
  cv::fillConvexPoly(picture, points, cv::Scalar(grey));
}

}  // namespace

GreyPicture draw_handle(const DrawnHandle& scene) {
  const CameraIntrinsics& camera = scene.camera.intrinsics;
  std::mt19937 random(scene.seed);
  std::normal_distribution<float> noise(0, static_cast<float>(scene.noise_grey));
  const PanelLayout::Valve& valve = scene.valve;
  const double half = valve.handle_length_m / 2, thick = valve.handle_thickness_m / 2, high = valve.handle_height_m;
  const Vec3 along(-std::sin(scene.angle_rad), std::cos(scene.angle_rad), 0),
      across(std::cos(scene.angle_rad), std::sin(scene.angle_rad), 0);
  const Vec3 eye = scene.base_from_panel.inverse() * scene.camera.base_from_camera.translation();
  const double flank = across.dot(eye - Vec3(0, 0, high)) > 0 ? 1 : -1;

  cv::Mat large(camera.height * finer, camera.width * finer, CV_32F, cv::Scalar(scene.background_grey));
  constexpr double piece_m = 0.001;
  for (double s = -half; s < half - 1e-9; s += piece_m) {
    const double middle = s + piece_m / 2;
    const bool marked = scene.painted && middle > half - valve.pointer_length_m;
    double grey = (marked ? scene.paint_grey : scene.bar_grey) * (1 - scene.fall_off * (middle / valve.handle_length_m + 0.5));
    if (middle < scene.shade_edge_m) grey *= scene.shade;
    const Vec3 a = s * along, b = (s + piece_m) * along, up(0, 0, 1);
    const Vec3 left = -thick * across, right = thick * across;
    fill(large, scene,
         {a + left + (high + thick) * up, b + left + (high + thick) * up, b + right + (high + thick) * up, a + right + (high + thick) * up},
         grey);
    const Vec3 side = flank * thick * across;
    fill(large, scene,
         {a + side + (high + thick) * up, b + side + (high + thick) * up, b + side + (high - thick) * up, a + side + (high - thick) * up},
         grey * scene.side_over_front);
  }
  cv::Mat picture;
  cv::resize(large, picture, {camera.width, camera.height}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(picture, picture, {}, scene.blur_px);
  GreyPicture out{camera.width, camera.height, {}};
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      // Light from one side, and blotches of growth.
      const double light = 0.8 + 0.4 * u / camera.width + 0.05 * std::sin(0.11 * u + 0.07 * v);
      const double linear = std::clamp(light * static_cast<double>(picture.at<float>(v, u)) + scene.veil_grey, 0.0, 255.0);
      const double grey = 255 * std::pow(linear / 255, scene.gamma) + static_cast<double>(noise(random));
      out.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L)));
    }
  }
  return out;
}

std::vector<CloudPoint> draw_bar_points(const DrawnHandle& scene, double paint_over_bar) {
  std::mt19937 random(scene.seed + 77);
  std::normal_distribution<double> noise(0, 1);
  const PanelLayout::Valve& valve = scene.valve;
  const double half = valve.handle_length_m / 2, thick = valve.handle_thickness_m / 2;
  std::vector<CloudPoint> points;
  for (double y = -half; y <= half; y += 0.0026) {
    for (double x = -half; x <= half; x += 0.002) {
      const double s = -std::sin(scene.angle_rad) * x + std::cos(scene.angle_rad) * y;
      const double t = std::cos(scene.angle_rad) * x + std::sin(scene.angle_rad) * y;
      if (std::abs(s) > half || std::abs(t) > thick) continue;
      CloudPoint point;
      point.p_m = (scene.base_from_panel * Vec3(x, y, valve.handle_height_m + thick + 0.0006 * noise(random))).cast<float>();
      const bool marked = scene.painted && s > half - valve.pointer_length_m;
      point.amplitude = static_cast<float>(60 * (marked ? paint_over_bar : 1) * (1 + 0.08 * noise(random)));
      points.push_back(point);
    }
  }
  return points;
}

}  // namespace lf::vision::test
