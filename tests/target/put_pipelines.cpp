#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <optional>

#include "firmware/arm/kinematics.hpp"
#include "firmware/scan/camera_model.hpp"
#include "firmware/scan/sweep.hpp"
#include "firmware/scan_pipeline.hpp"
#include "tests/arm5e.hpp"
#include "tests/target/ledger.hpp"
#include "tests/target/same_everywhere.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::test {
namespace {

using Joints = PerArmJoint<double>;
constexpr Duration exposure = Duration::from_ms(2);
constexpr int frames = 12;
constexpr int syncs_a_frame = 300;  // a dozen stripes over the whole sweep

template <ScanCapacity capacity>
struct Bench {
  static constexpr std::int32_t width = capacity.image_width, height = capacity.image_height;
  alignas(BasicScanPipeline<capacity>) unsigned char pipeline[sizeof(BasicScanPipeline<capacity>)];
  std::array<std::uint8_t, static_cast<std::size_t>(width) * height> pixels;
};

LANTERNFISH_EXTERNAL_MEMORY Bench<full_scan> full;
LANTERNFISH_EXTERNAL_MEMORY Bench<compact_scan> compact;
LANTERNFISH_EXTERNAL_MEMORY Bench<small_scan> small;

// The nominal camera with pixels of another size.
CameraCalibration camera_of(std::int32_t width, std::int32_t height) {
  CameraCalibration camera = nominal_camera();
  CameraIntrinsics& in = camera.intrinsics;
  const double scale = static_cast<double>(width) / in.width;
  in.width = width;
  in.height = height;
  in.fx *= scale;
  in.fy *= scale;
  in.cx = 0.5 * (width - 1);
  in.cy = 0.5 * (height - 1);
  return camera;
}

// The panel's line in the laser's plane, painted where the camera sees it. Centres are rounded to 256ths of a pixel.
template <class B>
void paint(B& bench, const CameraCalibration& camera, const LaserCalibration& laser, const Joints& q, bool laser_on, std::uint64_t seed) {
  SameRandom random(seed);
  for (std::uint8_t& grey : bench.pixels) grey = static_cast<std::uint8_t>(40 + random.below(3));
  if (!laser_on) return;
  const Pose panel = PanelLayout{}.nominal_base_from_panel();
  const Pose sheet = test::arm5e.base_from_laser(arm::planar_joints(q[0], q[1], q[2], q[3]), laser);
  const Vec3 panel_normal = panel.linear().col(2), sheet_normal = sheet.linear().col(0);
  const Vec3 along = panel_normal.cross(sheet_normal).normalized();
  // A point of both planes: from the panel's origin within the panel to the sheet.
  const Vec3 within = along.cross(panel_normal);
  const Vec3 middle =
      panel.translation() + within * (sheet_normal.dot(sheet.translation() - panel.translation()) / sheet_normal.dot(within));
  const scan::CameraModel model(camera.intrinsics);
  const Pose camera_from_base = camera.base_from_camera.inverse();
  const auto pixel = [&](double along_m) { return model.project(camera_from_base * (middle + along_m * along)); };
  std::optional<Vec2> before = pixel(-0.45);
  for (int i = -449; i <= 450; ++i) {
    const std::optional<Vec2> here = pixel(1e-3 * i);
    if (before && here) {
      const Vec2& left = before->x() < here->x() ? *before : *here;
      const Vec2& right = before->x() < here->x() ? *here : *before;
      for (int u = std::max(0, static_cast<int>(std::ceil(left.x()))); u < right.x() && u < B::width; ++u) {
        const double row = left.y() + (right.y() - left.y()) * (u - left.x()) / (right.x() - left.x());
        if (!(row > 10) || !(row < B::height - 10)) continue;
        const std::int32_t centre_256 = static_cast<std::int32_t>(std::lround(256 * row));
        for (std::int32_t v = centre_256 / 256 - 5; v <= centre_256 / 256 + 5; ++v) {
          std::uint8_t& grey = bench.pixels[static_cast<std::size_t>(v) * B::width + u];
          grey = static_cast<std::uint8_t>(grey + stripe_grey(v * 256 - centre_256, 120));
        }
      }
    }
    before = here;
  }
}

template <ScanCapacity capacity>
void put_pipeline(Ledger& ledger, Bench<capacity>& bench, const char* image, const char* analysis) {
  using B = Bench<capacity>;
  ScanConfig config;
  config.camera = camera_of(B::width, B::height);
  config.laser = nominal_laser();
  auto& pipeline = *new (bench.pipeline) BasicScanPipeline<capacity>(config);
  scan::SweepRequest request;
  request.base_from_panel = PanelLayout{}.nominal_base_from_panel();
  (void)request.handles.push_back({});
  const scan::SweepPlan plan = scan::plan_sweep(test::arm5e, request, config.laser);
  const auto joints = [&](Duration t) {
    Joints q;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] = plan.start_rad[j] + plan.speed_rad_s[j] * t.s();
    return q;
  };

  const Time begin = Time::from_ns(5'000'000'000);
  const auto order = [&](ScanCommand::Kind kind) {
    ScanCommand command;
    command.kind = kind;
    command.sweep = 9;
    pipeline.on_command(command);
  };
  order(ScanCommand::Kind::begin_sweep);
  ledger.operation(image, 0);
  for (int frame = 0; frame < frames; ++frame) {
    const Time start = begin + can_map::sync_period * (frame * syncs_a_frame);
    const ExposureKind kind = frame % 5 == 0 ? ExposureKind::background : ExposureKind::laser_on;
    paint(bench, config.camera, config.laser, joints(start + exposure / 2 - begin), kind == ExposureKind::laser_on, 50 + frame);
    ScanCommand ordered;
    ordered.kind = ScanCommand::Kind::exposure;
    ordered.exposure_start = start;
    ordered.exposure_kind = kind;
    pipeline.on_command(ordered);
    const Image taken{
        .view = {bench.pixels.data(), B::width, B::height, B::width}, .exposure_start = start, .exposure = exposure, .sequence = 0};
    const auto see = [&] { pipeline.on_image(0, taken); };
    if (kind == ExposureKind::laser_on)
      ledger.turn(see);
    else
      see();
    // Joint samples about the exposure, the last ones after the image.
    for (int sync = -10; sync <= 10; ++sync) {
      const Time t = start + can_map::sync_period * sync;
      ScanCommand sample;
      sample.joints = {t, joints(t - begin)};
      pipeline.on_command(sample);
    }
    ledger.integer(pipeline.last_peaks().size());
  }
  order(ScanCommand::Kind::end_sweep);
  // 6e-5 px at 362 px of focal length and 0.9 m are 1.5e-7 m, at the sheet's flattest angle times three.
  ledger.operation(analysis, 1e-6);
  ledger.turn([&] { order(ScanCommand::Kind::analyse); });
  PanelRequest answer;
  ledger.integer(pipeline.take_request(answer));
  ledger.integer(answer.fit.valid);
  ledger.integer(answer.fit.points);
  ledger.integer(answer.fit.inliers);
  ledger.numbers(answer.fit.plane.normal);
  ledger.number(answer.fit.plane.offset_m);
  for (std::size_t i = 0; i < pipeline.cloud().size(); i += 17) ledger.numbers(pipeline.cloud()[i].p_m);
  const ScanStats& stats = pipeline.stats();
  for (const std::uint32_t counter : {stats.images, stats.images_unexpected, stats.images_refused, stats.images_missing, stats.peaks,
                                      stats.points, stats.points_overflowed, stats.points_no_joints, stats.commands_refused})
    ledger.integer(counter);
}

}  // namespace

void put_pipelines(Ledger& ledger) {
  put_pipeline(ledger, full, "stripe image, full pipeline", "sweep's analysis, full pipeline");
  put_pipeline(ledger, compact, "stripe image, compact pipeline", "sweep's analysis, compact pipeline");
  put_pipeline(ledger, small, "stripe image, small pipeline", "sweep's analysis, small pipeline");
}

}  // namespace lf::test
