#include "tests/hil/known_sight.hpp"

#include <cmath>

#include "firmware/scan/camera_model.hpp"

namespace lf::test {

namespace {

// As many as a sweep of the whole panel gives.
constexpr std::uint32_t plane_points = 80000, handle_points = 4000;
constexpr Duration answer_time = Duration::from_ms(300);

}  // namespace

PanelResult panel_as_it_is(const Pose& base_from_panel, double handle_rad, const PanelLayout& layout, const MarkerCalibration& marker,
                           const CameraCalibration& camera) {
  PanelResult result;
  result.fit.valid = true;
  result.fit.plane.normal = base_from_panel.linear().col(2);
  result.fit.plane.offset_m = -result.fit.plane.normal.dot(base_from_panel.translation());
  result.fit.points = result.fit.inliers = plane_points;
  result.fit.rms_m = 0.0004;
  result.confidence = 0.9f;

  const Pose camera_from_tag = camera.base_from_camera.inverse() * base_from_panel * marker.panel_from_tag;
  const scan::CameraModel model(camera.intrinsics);
  const double h = marker.size_m / 2;
  const std::array<Vec3, 4> corners{Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
  result.marker.found = true;
  result.marker.id = marker.id;
  result.marker.camera_from_tag = camera_from_tag;
  result.marker.margin = 80;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::optional<Vec2> pixel = model.project(camera_from_tag * corners[i]);
    result.marker.found = result.marker.found && pixel.has_value();
    result.marker.corners_px[i] = pixel.value_or(Vec2::Zero());
    result.marker.centre_px += result.marker.corners_px[i] / 4;
  }

  ProudCluster handle;
  handle.centroid_m = base_from_panel * Vec3(0, 0, layout.handle_height_m);
  handle.axis = base_from_panel.linear() * Vec3(-std::sin(handle_rad), std::cos(handle_rad), 0);
  handle.length_m = layout.handle_length_m;
  handle.width_m = layout.handle_thickness_m;
  handle.height_m = handle.height_max_m = layout.handle_height_m;
  handle.points = handle_points;
  (void)result.clusters.push_back(handle);
  return result;
}

hal::PortStatus KnownSight::receive_image(std::uint8_t camera, Image& image) {
  const hal::PortStatus status = inner_.receive_image(camera, image);
  if (status != hal::port_ok) return status;
  if (images_to_lose_ > 0) {
    --images_to_lose_;
    return hal::port_empty;
  }
  if (frozen_ == Frozen::camera && last_image_) {
    image.exposure_start = last_image_->exposure_start;
    image.sequence = last_image_->sequence;
  }
  if (frozen_ == Frozen::sensor) {
    hanging_.resize(static_cast<std::size_t>(ScanPipeline::image_width) * ScanPipeline::image_height, 40);
    image.view = {hanging_.data(), ScanPipeline::image_width, ScanPipeline::image_height, ScanPipeline::image_width};
  }
  last_image_ = image;
  return status;
}

hal::PortStatus KnownSight::submit_panel(const PanelRequest& request, ImageView, std::span<const CloudPoint>) {
  ++questions_;
  if (!answers_) return hal::port_ok;
  answer_ = panel_as_it_is(base_from_panel_ * Eigen::Translation3d(shift_m_), inner_.world().valve_angle_rad(), layout_, marker_, camera_);
  answer_->id = request.id;
  answer_->measured = inner_.now();
  answer_due_ = inner_.now() + answer_time;
  return hal::port_ok;
}

hal::PortStatus KnownSight::receive_panel(PanelResult& result) {
  if (!answer_ || inner_.now() < answer_due_) return hal::port_empty;
  result = *answer_;
  result.answered = inner_.now();
  answer_.reset();
  return hal::port_ok;
}

}  // namespace lf::test
