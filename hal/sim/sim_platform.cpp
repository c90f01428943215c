#include "hal/sim/sim_platform.hpp"

#include <utility>

#include "hal/sim/given_sight.hpp"

namespace lf::hal {

namespace {

constexpr Duration physics_step = Duration::from_ms(1);

// Codes of this platform's failures, as errno has them.
constexpr PortStatus no_such_device = 19;  // ENODEV
constexpr PortStatus busy = 16;            // EBUSY
constexpr PortStatus no_buffer = 105;      // ENOBUFS
constexpr PortStatus io_error = 5;         // EIO: what a call that was made to fail answers

// Added to the answer's time by `vision_late`: with the default's 0.3 s it stays within the limits' 2 s.
constexpr Duration vision_delay = Duration::from_ms(1500);

}  // namespace

static_assert(Platform<SimPlatform>);

SimPlatform::SimPlatform(const SimConfig& config, SimObserver& observer)
    : config_(config),
      observer_(observer),
      world_(config.world),
      devices_(config.devices),
      renderer_(config.given_sight ? nullptr : std::make_unique<RenderWorker>(config.optics)),
      vision_(config.given_sight ? nullptr : std::make_unique<vision::PanelVisionWorker>(config.vision)),
      faults_(config.faults) {
  devices_.set_tap([this](const devices::BusRecord& record) { observer_.on_bus_frame(record); });
}

PortStatus SimPlatform::wait_for_tick(Time& tick) {
  const Time end = now_ + can_map::sync_period;
  while (now_ < end) step();
  if (faults_.on(SimFaultKind::clock_lost)) return io_error;  // the world goes on; only its time is not told
  tick = now_;
  return port_ok;
}

void SimPlatform::begin_faults() {
  while (const SimFault* fault = faults_.next(now_)) begin(*fault);
}

// What is more than a state that lasts.
void SimPlatform::begin(const SimFault& fault) {
  switch (fault.kind) {
    case SimFaultKind::device: {
      devices::DeviceFault device = fault.device;
      device.duration_s = fault.duration_s;
      devices_.add_fault(device, now_);
      return;
    }
    case SimFaultKind::image_lost: ++images_to_lose_; return;
    case SimFaultKind::handle_breaks: world_.break_handle(config_.valve_that_breaks); return;
    case SimFaultKind::obstacle: world_.push_obstacle(); return;
    case SimFaultKind::abort_ordered: orders_.push_back(Command::abort); return;
    case SimFaultKind::estop_ordered: orders_.push_back(Command::emergency_stop); return;
    case SimFaultKind::shut_down_ordered: orders_.push_back(Command::shut_down); return;
    default: return;
  }
}

PortStatus SimPlatform::receive_order(NumberedOrder& order) {
  if (orders_.empty()) return port_empty;
  order = {};
  order.order.command = orders_.front();
  orders_.pop_front();
  return port_ok;
}

void SimPlatform::step() {
  now_ = now_ + physics_step;
  begin_faults();
  world_.set_drives(devices_.drives());
  world_.step();
  devices_.step(now_, world_.readings());
  expose();
  observer_.on_step(now_, world_);
}

// Once the shutter has closed the renderer makes the picture.
void SimPlatform::expose(PendingExposure& pending) {
  ExposureUnderWay& exposure = pending.under_way;
  exposure.pass(now_ - physics_step, now_, devices_.laser_on(), devices_.lamps_on(), world_.base_from_body());
  if (!exposure.closed(now_)) return;
  pending.submitted = true;
  if (!renderer_) return;
  optics::Shot shot = exposure.shot();
  shot.truth = exposure.ordered().laser;
  pending.ticket = renderer_->submit(shot);
}

void SimPlatform::expose() {
  while (const std::optional<devices::Exposure> exposure = devices_.take_exposure()) {
    pending_.push_back({.under_way = ExposureUnderWay(*exposure, exposures_++, config_.exposure_delay)});
  }
  for (PendingExposure& pending : pending_) {
    if (!pending.submitted) expose(pending);
  }
}

PortStatus SimPlatform::receive_can(std::uint8_t bus, ReceivedFrame& received) {
  if (bus != 0) return no_such_device;
  if (faults_.on(SimFaultKind::can_receive_fails)) return io_error;
  return devices_.next_to_master(received.frame, received.t) ? port_ok : port_empty;
}

PortStatus SimPlatform::send_can(std::uint8_t bus, std::span<const CanFrame> frames) {
  if (bus != 0) return no_such_device;
  if (faults_.on(SimFaultKind::can_send_fails)) return io_error;
  for (const CanFrame& frame : frames) {
    if (!devices_.master_sends(frame, now_)) return no_buffer;
  }
  return port_ok;
}

// The picture of a finished exposure, into `delivered_`.
void SimPlatform::picture(const PendingExposure& exposure) {
  if (renderer_) return renderer_->wait(exposure.ticket, delivered_);
  blank_picture(exposure.under_way.sequence(), delivered_);
}

// False for an image that gets lost.
bool SimPlatform::spoil_image(Image& image) {
  if (images_to_lose_ > 0) {
    --images_to_lose_;
    return false;
  }
  if (faults_.on(SimFaultKind::camera_silent)) return false;
  if (faults_.on(SimFaultKind::camera_frozen) && last_image_) {
    image.exposure_start = last_image_->exposure_start;
    image.sequence = last_image_->sequence;
  }
  if (!faults_.on(SimFaultKind::sensor_frozen)) {
    hanging_.clear();
  } else {
    if (hanging_.empty()) {
      const CameraIntrinsics& size = config_.vision.camera.intrinsics;  // a blank picture is smaller, and would be refused for that
      hanging_width_ = size.width;
      hanging_height_ = size.height;
      hanging_.assign(static_cast<std::size_t>(hanging_width_) * static_cast<std::size_t>(hanging_height_), 40);
      if (renderer_) hanging_ = delivered_.pixels;
    }
    image.view = {hanging_.data(), hanging_width_, hanging_height_, hanging_width_};
  }
  last_image_ = image;
  return true;
}

PortStatus SimPlatform::receive_image(std::uint8_t camera, Image& image) {
  if (camera != 0) return no_such_device;
  if (faults_.on(SimFaultKind::camera_fails)) return io_error;
  if (pending_.empty() || !pending_.front().submitted) return port_empty;
  const PendingExposure& first = pending_.front();
  devices::Exposure stamped = first.under_way.ordered();
  if (now_ < stamped.start + config_.image_latency) return port_empty;

  picture(first);
  stamped.start = stamped.start + config_.stamp_offset;
  observer_.on_image({stamped, first.under_way.sequence(), first.under_way.poses(), &delivered_});
  image.view = {delivered_.pixels.data(), delivered_.width, delivered_.height, delivered_.width};
  image.exposure_start = stamped.start;
  image.exposure = stamped.duration;
  image.sequence = first.under_way.sequence();
  pending_.pop_front();
  return spoil_image(image) ? port_ok : port_empty;
}

PanelResult SimPlatform::see_as_it_is(const PanelRequest& request) const {
  std::vector<double> handles_rad;
  for (std::size_t i = 0; i < world_.valve_count(); ++i) handles_rad.push_back(world_.valve_angle_rad(i));
  PanelResult answer =
      panel_as_it_is(config_.world.base_from_panel, handles_rad, config_.vision.panel, config_.vision.markers, config_.vision.camera);
  answer.id = request.id;
  answer.measured = now_;
  return answer;
}

PortStatus SimPlatform::submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) {
  if (faults_.on(SimFaultKind::panel_submit_fails)) return io_error;
  observer_.on_panel_request(request, still, cloud);
  if (!vision_) {
    given_answer_ = see_as_it_is(request);
  } else if (!vision_->submit(vision::PanelJob::copy(request, still, cloud))) {
    return busy;
  }
  vision_answer_due_ = now_ + config_.vision_latency;
  return port_ok;
}

PortStatus SimPlatform::receive_panel(PanelResult& result) {
  if (faults_.on(SimFaultKind::panel_receive_fails)) return io_error;
  const Duration delay = faults_.on(SimFaultKind::vision_late) ? vision_delay : Duration();
  if (!vision_answer_due_ || now_ < *vision_answer_due_ + delay) return port_empty;
  vision_answer_due_.reset();
  if (vision_ && !vision_->wait(result)) return port_empty;
  if (!vision_) result = *given_answer_;
  if (faults_.on(SimFaultKind::vision_silent)) return port_empty;
  if (faults_.on(SimFaultKind::vision_poor)) {
    result.markers.clear();
    result.clusters.clear();
    result.confidence = 0;
  }
  result.answered = now_;
  observer_.on_panel_result(result);
  return port_ok;
}

PortStatus SimPlatform::publish(const Telemetry& telemetry) {
  faults_.in_step(telemetry.step, now_);
  if (faults_.on(SimFaultKind::telemetry_fails)) return io_error;
  observer_.on_telemetry(telemetry);
  return port_ok;
}

}  // namespace lf::hal
