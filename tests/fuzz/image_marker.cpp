// Marker and pointer in images of any size and content: pieces of a real still, drawn over, or nothing but what is drawn.
#include <cmath>

#include "hal/vision/corner_refinement.hpp"
#include "hal/vision/image_file.hpp"
#include "hal/vision/marker_detector.hpp"
#include "hal/vision/pointer.hpp"
#include "tests/fuzz/picture.hpp"

namespace lf::fuzz {
namespace {

// A cut of the still; the marker stands at (220..300, 300..380) of it.
Picture<std::uint8_t> cut(Input& in) {
  static const vision::GreyImage still = vision::read_image_file(LANTERNFISH_SOURCE_DIR "/tests/data/marker_still/seed_146.png");
  const std::int32_t left = in.byte() * 2, top = in.byte() + 100;
  const std::int32_t width = std::min(16 + in.byte(), still.width - left), height = std::min(16 + in.byte(), still.height - top);
  Picture<std::uint8_t> picture = blank<std::uint8_t>(in, width, height);
  for (std::int32_t v = 0; v < height; ++v) {
    for (std::int32_t u = 0; u < width; ++u) picture.at(u, v) = still.view().at(left + u, top + v);
  }
  return picture;
}

// Mostly of a size that occurs; sometimes any bits.
double number(Input& in) {
  const std::uint8_t kind = in.byte();
  if (kind == 0xFF) return in.take<double>();
  return static_cast<double>(in.take<std::int16_t>()) * (kind < 64 ? 0.1 : 1e-4);
}

void look_for_pointer(Input& in, ImageView image) {
  vision::BarPlace bar;
  const Vec3 axis = Vec3(number(in), number(in), number(in));
  if (axis.norm() > 1e-9 && axis.allFinite())
    bar.base_from_panel.linear() = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
  bar.base_from_panel.translation() = Vec3(number(in), number(in), number(in));
  bar.angle_rad = number(in);
  bar.centre_m = Vec3(number(in), number(in), number(in));
  CameraCalibration camera;
  camera.intrinsics.width = image.width;
  camera.intrinsics.height = image.height;
  PanelLayout::Valve valve;
  valve.pointer = static_cast<PanelLayout::Pointer>(in.byte() % 3U);
  std::vector<CloudPoint> cloud;
  for (std::size_t count = in.byte(); count > 0; --count) {
    CloudPoint point;
    point.p_m = Vec3(number(in), number(in), number(in)).cast<float>();
    point.amplitude = static_cast<float>(number(in));
    cloud.push_back(point);
  }
  const PointerObservation seen = vision::find_pointer(bar, image, cloud, camera, valve);
  expect(seen.confidence >= 0 && seen.confidence <= 1, "a confidence is a share");
  expect(std::abs(seen.still_evidence) <= 1 && std::abs(seen.cloud_evidence) <= 1, "evidence is within 1");
}

void look_for_markers(Input& in, ImageView image) {
  vision::MarkerDetectorConfig config;
  config.family = vision::MarkerDetector::marker_families()[in.byte() % 4U];
  config.decimate = 1 + in.byte() % 3;
  config.min_margin = in.byte() % 16;
  vision::MarkerDetector detector(config);
  for (const vision::DetectedMarker& marker : detector.detect(image)) {
    expect(marker.id >= 0, "a marker has an id");
    expect(marker.centre_px.allFinite() && marker.corners_px[2].allFinite(), "a marker's place is numbers");
    (void)vision::marker_pose(marker.corners_px, 0.08, CameraIntrinsics());
  }
  std::array<Vec2, 4> corners;
  for (Vec2& corner : corners) corner = Vec2(number(in), number(in));
  (void)vision::refine_corners(image, corners, 1 + in.byte() % 12);
  if (const auto pose = vision::marker_pose(corners, 0.08, CameraIntrinsics())) {
    expect(pose->camera_from_tag.matrix().allFinite() && pose->camera_from_tag.translation().z() > 0, "a marker stands before the camera");
  }
}

}  // namespace
}  // namespace lf::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lf::fuzz::Input in(data, size);
  const std::uint8_t flags = in.byte();
  const std::int32_t width = in.byte(), height = in.byte();
  auto picture = (flags & 1U) != 0 ? lf::fuzz::cut(in) : lf::fuzz::blank<std::uint8_t>(in, width, height);
  // What is looked for comes first: what is drawn takes the rest of the input.
  lf::fuzz::Input asked = in;
  for (int i = 0; i < 64; ++i) (void)in.byte();
  lf::fuzz::draw(in, picture);
  const lf::ImageView image{picture.pixels.data(), picture.width, picture.height, picture.stride};
  if ((flags & 2U) != 0) lf::fuzz::look_for_pointer(asked, image);
  if ((flags & 4U) == 0) lf::fuzz::look_for_markers(asked, image);
  return 0;
}
