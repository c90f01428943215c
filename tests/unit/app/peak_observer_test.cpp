#include "host_sim/app/observers/peak_observer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "tests/arm5e_bodies.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::app {
namespace {

constexpr std::int32_t width = ScanPipeline::image_width, height = ScanPipeline::image_height;
const Duration exposure = Duration::from_ms(2);

Time time_of(int stripe) { return Time::from_ns(5'000'000'000) + Duration::from_ms(40) * stripe; }

// A level stripe of 120 grey levels in every column.
std::vector<std::uint8_t> picture(int row) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height, 40);
  for (int v = row - 6; v <= row + 6; ++v) {
    const auto light = static_cast<std::uint8_t>(std::lround(120 * std::exp(-0.5 * (v - row) * (v - row) / 1.44)));
    for (int u = 0; u < width; ++u) pixels[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] += light;
  }
  return pixels;
}

optics::Frame frame_of(const std::vector<std::uint8_t>& pixels, int row) {
  optics::Frame frame;
  frame.width = width;
  frame.height = height;
  frame.channels = 1;
  frame.pixels = pixels;
  for (int u = 0; u < width; ++u) frame.pieces.push_back({.laser = 0, .u = u, .v = static_cast<float>(row), .grey = 120, .sigma_px = 1.2f});
  return frame;
}

// Four stripes wait for joints that come with the sweep's end. Only the last of them was scored.
TEST(PeakObserver, ScoresEachStripeOfThoseThatAreTakenInOneTurn) {
  ScanConfig config;
  config.camera = test::nominal_camera();
  config.laser = test::nominal_laser();
  const auto pipeline = std::make_unique<ScanPipeline>(config);
  PeakObserver observer({}, arm5e_body::panel);
  ScanCommand command;
  command.kind = ScanCommand::Kind::begin_sweep;
  pipeline->on_command(command);
  constexpr int stripes = 4;
  for (int i = 0; i < stripes; ++i) {
    command.kind = ScanCommand::Kind::exposure;
    command.exposure_start = time_of(i);
    command.exposure_kind = ExposureKind::laser_on;
    pipeline->on_command(command);
    const int row = 200 + 10 * i;
    const std::vector<std::uint8_t> pixels = picture(row);
    const optics::Frame frame = frame_of(pixels, row);
    hal::ExposureRecord record;
    record.exposure.start = time_of(i);
    record.exposure.duration = exposure;
    record.exposure.laser = true;
    record.frame = &frame;
    observer.on_image(record);
    pipeline->on_image(0, {.view = {pixels.data(), width, height, width}, .exposure_start = time_of(i), .exposure = exposure});
    (void)observer.after_vision(*pipeline);
  }
  EXPECT_EQ(observer.score().visible(), 0u);
  command.kind = ScanCommand::Kind::joint_sample;
  for (int i = 0; i <= stripes; ++i) {
    if (i > 0 && i < stripes) continue;
    command.joints = {time_of(i), {0, 0.95, 1.5, 0}};
    pipeline->on_command(command);
  }
  command.kind = ScanCommand::Kind::analyse;
  pipeline->on_command(command);
  (void)observer.after_vision(*pipeline);
  EXPECT_EQ(observer.score().visible(), static_cast<std::uint64_t>(stripes) * width);
  (void)observer.after_vision(*pipeline);
  EXPECT_EQ(observer.score().visible(), static_cast<std::uint64_t>(stripes) * width) << "once each";
  const std::vector<record::ReportChart> charts = observer.charts();
  ASSERT_FALSE(charts.empty());
  EXPECT_EQ(charts[0].series[0].t_s.size(), static_cast<std::size_t>(stripes));
}

}  // namespace
}  // namespace lf::app
