// The core's scan pipeline, fed as a vehicle feeds it: joints every control period, images that come late.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "firmware/arm/kinematics.hpp"
#include "firmware/scan/sweep.hpp"
#include "firmware/scan_pipeline.hpp"
#include "tests/arm5e.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::test {

using Angles = PerArmJoint<double>;

inline constexpr int width = ScanPipeline::image_width, height = ScanPipeline::image_height;
inline constexpr Duration sync_period = can_map::sync_period;
inline const Duration exposure = Duration::from_ms(2);

// A bare panel swept by the laser, one control period a step; images come 28 ms after their exposure.
class ScanBench {
 public:
  explicit ScanBench(const Pose& base_from_panel, std::uint32_t columns_apart = 1) : base_from_panel_(base_from_panel), random_(40) {
    config_.columns_apart = columns_apart;
    config_.camera = test::nominal_camera();
    config_.laser = test::nominal_laser();
    pipeline_ = std::make_unique<ScanPipeline>(config_);
  }

  ScanPipeline& pipeline() { return *pipeline_; }
  const ScanConfig& config() const { return config_; }

  void command(ScanCommand::Kind kind, std::uint32_t sweep = 1) {
    ScanCommand c;
    c.kind = kind;
    c.sweep = sweep;
    pipeline_->on_command(c);
  }
  void joints(Time t, const Angles& q) {
    ScanCommand c;
    c.joints = {t, q};
    pipeline_->on_command(c);
  }
  void order(Time start, ExposureKind kind) {
    ScanCommand c;
    c.kind = ScanCommand::Kind::exposure;
    c.exposure_start = start;
    c.exposure_kind = kind;
    pipeline_->on_command(c);
  }
  void drop(Time start) {
    ScanCommand c;
    c.kind = ScanCommand::Kind::drop_exposure;
    c.exposure_start = start;
    pipeline_->on_command(c);
  }
  // With a corner of its own, as no two pictures of a sensor are the same.
  void send(Time start, const std::vector<std::uint8_t>& pixels) {
    sent_ = pixels;
    sent_[0] = ++images_sent_;
    send_again(start);
  }
  // Without the mark that makes each picture another one.
  void send_just(Time start, const std::vector<std::uint8_t>& pixels) {
    sent_ = pixels;
    send_again(start);
  }
  void send_again(Time start) {
    pipeline_->on_image(0, {.view = {sent_.data(), width, height, width}, .exposure_start = start, .exposure = exposure});
  }
  const std::vector<std::uint8_t>& sent() const { return sent_; }

  // The stripe on the panel as the camera sees it with the arm at `q`: a Gaussian of sigma 1.2 px and 120 grey levels on a scene of 40.
  std::vector<std::uint8_t> picture(const Angles& q, bool laser_on) {
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height);
    for (auto& grey : pixels) grey = static_cast<std::uint8_t>(40 + random_() % 3);
    if (!laser_on) return pixels;
    const Pose laser = test::arm5e.base_from_laser(arm::planar_joints(q[0], q[1], q[2], q[3]), config_.laser);
    for (int u = 0; u < width; ++u) {
      const double centre = stripe_row(u, laser);
      for (int v = std::max(0, static_cast<int>(centre) - 8); v < std::min(height, static_cast<int>(centre) + 9); ++v)
        pixels[static_cast<std::size_t>(v) * width + u] = static_cast<std::uint8_t>(
            pixels[static_cast<std::size_t>(v) * width + u] + std::lround(120 * std::exp(-0.5 * std::pow((v - centre) / 1.2, 2))));
    }
    return pixels;
  }

  // The rays to the stripe turned by a thousandth of a radian to either side of the laser's sheet, and met with it again.
  double m_per_rad(const Angles& q) const {
    constexpr double turn_rad = 1e-3;
    const Pose laser = test::arm5e.base_from_laser(arm::planar_joints(q[0], q[1], q[2], q[3]), config_.laser);
    const scan::Triangulator triangulator(config_.camera, config_.laser, {});
    const Vec3 eye_m = config_.camera.base_from_camera.translation(), normal = laser.linear().col(0);
    double sum = 0;
    int points = 0;
    for (int u = 0; u < width; ++u) {
      const auto point = triangulator.point(Vec2(u, stripe_row(u, laser)), laser);
      if (!point) continue;
      const Vec3 ray = *point - eye_m, axis = ray.cross(normal).normalized();
      const auto met = [&](double rad) {
        const Vec3 turned = Eigen::AngleAxisd(rad, axis) * ray;
        return Vec3(eye_m + turned * ((laser.translation() - eye_m).dot(normal) / turned.dot(normal)));
      };
      sum += (met(turn_rad) - met(-turn_rad)).norm() / (2 * turn_rad), ++points;
    }
    return sum / points;
  }
  // By how much a stripe's point moves when it is seen a pixel lower, the mean over the picture.
  double m_per_px(const Angles& q) const {
    const Pose laser = test::arm5e.base_from_laser(arm::planar_joints(q[0], q[1], q[2], q[3]), config_.laser);
    const scan::Triangulator triangulator(config_.camera, config_.laser, {});
    double sum = 0;
    int points = 0;
    for (int u = 0; u < width; ++u) {
      const double v = stripe_row(u, laser);
      const auto above = triangulator.point(Vec2(u, v - 0.5), laser), below = triangulator.point(Vec2(u, v + 0.5), laser);
      if (above && below) sum += (*above - *below).norm(), ++points;
    }
    return sum / points;
  }

  // Sends images and joints of a whole sweep; every fifth image is a background. Returns the number of images.
  std::uint32_t sweep(const scan::SweepPlan& plan) {
    std::uint32_t images = 0;
    command(ScanCommand::Kind::begin_sweep);
    std::vector<std::uint8_t> waiting;
    Time waiting_start;
    const int steps = static_cast<int>(plan.duration.s() / sync_period.s());
    for (int i = 0; i <= steps + 20; ++i) {
      const Time t = time(i);
      joints(t, angles(plan, t));
      if (!waiting.empty() && t - waiting_start > Duration::from_ms(28)) {
        send(waiting_start, waiting);
        waiting.clear();
      }
      // Every thirtieth SYNC: the rest of the images would only make the test longer.
      if (i % 30 == 0 && i < steps) {
        const bool background = i % 150 == 0;
        waiting_start = t;
        ++images;
        order(t, background ? ExposureKind::background : ExposureKind::laser_on);
        waiting = picture(angles(plan, t + exposure / 2), !background);
      }
    }
    command(ScanCommand::Kind::end_sweep);
    return images;
  }

  static Time time(int sync) { return Time::from_ns(5'000'000'000) + sync_period * sync; }
  static Angles angles(const scan::SweepPlan& plan, Time t) {
    Angles q;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] = plan.start_rad[j] + plan.speed_rad_s[j] * (t - time(0)).s();
    return q;
  }

 private:
  // Where in column u the panel's point lies in the laser plane.
  double stripe_row(int u, const Pose& laser) const {
    const Pose& camera = config_.camera.base_from_camera;
    const Vec3 panel_normal = base_from_panel_.linear().col(2), laser_normal = laser.linear().col(0);
    const auto beyond = [&](double v) {
      const CameraIntrinsics& in = config_.camera.intrinsics;
      const Vec3 ray = camera.linear() * Vec3((u - in.cx) / in.fx, (v - in.cy) / in.fy, 1);
      const double range = panel_normal.dot(base_from_panel_.translation() - camera.translation()) / panel_normal.dot(ray);
      return laser_normal.dot(camera.translation() + range * ray - laser.translation());
    };
    double low = -2000, high = 3000;  // far beyond the image: the panel goes on without end
    low = std::max(low, horizon(u, low, high));
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (beyond(middle) > 0 ? low : high) = middle;
    }
    return high;
  }
  // The row from which on the column's rays meet the panel in front of the camera.
  double horizon(int u, double low, double high) const {
    const Vec3 panel_normal = base_from_panel_.linear().col(2);
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      const CameraIntrinsics& in = config_.camera.intrinsics;
      const Vec3 ray = config_.camera.base_from_camera.linear() * Vec3((u - in.cx) / in.fx, (middle - in.cy) / in.fy, 1);
      (panel_normal.dot(ray) < -1e-3 ? high : low) = middle;
    }
    return high;
  }

  ScanConfig config_;
  Pose base_from_panel_;
  std::mt19937_64 random_;
  std::vector<std::uint8_t> sent_;
  std::uint8_t images_sent_ = 0;
  std::unique_ptr<ScanPipeline> pipeline_;
};

inline scan::SweepPlan nominal_sweep() {
  scan::SweepRequest request;
  request.base_from_panel = PanelLayout{}.nominal_base_from_panel();
  (void)request.handles.push_back({});
  return scan::plan_sweep(test::arm5e, request, test::nominal_laser());
}

}  // namespace lf::test
