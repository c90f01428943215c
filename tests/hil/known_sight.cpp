#include "tests/hil/known_sight.hpp"

namespace lf::test {

namespace {

constexpr Duration answer_time = Duration::from_ms(300);

}  // namespace

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
  std::vector<double> handles_rad;
  for (std::size_t i = 0; i < layout_.valves.size(); ++i) handles_rad.push_back(inner_.world().valve_angle_rad(i) + handle_rad_);
  answer_ = hal::panel_as_it_is(base_from_panel_ * Eigen::Translation3d(shift_m_), handles_rad, layout_, markers_, camera_);
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
