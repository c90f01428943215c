#include "hal/vehicle/vehicle_platform.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

namespace lf::hal {

namespace {

// A full controller queue of ten frames takes 1.3 ms at 1 Mbit/s.
constexpr Duration try_again = Duration::from_us(300);
constexpr Duration longest_look = Duration::from_ms(5);

vision::PanelVisionConfig panel_vision_config(const ControllerConfig& core) {
  vision::PanelVisionConfig config;
  config.camera = core.camera;
  config.markers = core.markers;
  config.panel = core.mission.layout;
  return config;
}

}  // namespace

VehiclePlatform::VehiclePlatform(const VehicleConfig& config, LogRings& log, LoopRings& loops, const EstopLine& estop, LinuxCalls& calls)
    : config_(config),
      calls_(calls),
      log_(log),
      loops_(loops),
      estop_(estop),
      can_(config.can(), calls),
      clock_(config.core.controller.network.sync_period),
      panel_vision_(panel_vision_config(config.core.controller)) {
  can_.set_tap(this);
}

PortStatus VehiclePlatform::open_camera(std::string& why) {
  if (config_.camera_source == "device") {
    auto camera = std::make_unique<V4l2Camera>(config_.v4l2(), calls_);
    const PortStatus status = camera->open();
    if (status != port_ok) why = V4l2Camera::explain(status, config_.v4l2());
    camera_ = std::move(camera);
    return status;
  }
  if (config_.camera_source == "none") {
    why = "camera.source is none";
    return port_ok;
  }
  auto camera = std::make_unique<RingCamera>(config_.ring_camera());
  const PortStatus status = camera->open();
  if (status != port_ok) why = config_.ring + ": no frame ring can be had here: " + std::strerror(status);
  camera_ = std::move(camera);
  return status;
}

PortStatus VehiclePlatform::wait_for_tick(Time& tick) {
  if (!std::exchange(clock_runs_, true)) clock_.start();
  while (can_.waiting() > 0) {
    const Time again = monotonic_now() + try_again;
    if (again >= clock_.next()) break;
    sleep_until(again);
    if (const PortStatus status = can_.flush(); status != port_ok) send_error_ = status;
  }
  tick = clock_.wait();
  return port_ok;
}

PortStatus VehiclePlatform::receive_order(NumberedOrder& order) {
  if (loops_.own.pop(order)) return port_ok;
  if (loops_.stops.pop(order)) return port_ok;  // a stop is never withdrawn: it needs no gate
  while (loops_.orders.pop(order)) {
    if (loops_.gate.take(order.number)) return port_ok;
  }
  return port_empty;
}

PortStatus VehiclePlatform::answer_order(const OrderAnswer& answer) {
  if (answer.number == 0) return loops_.own_answers.push(answer) ? port_ok : ENOBUFS;
  return loops_.answers.push(answer) ? port_ok : ENOBUFS;
}

PortStatus VehiclePlatform::read_estop(bool& closed) const {
  closed = estop_.closed(monotonic_now());
  return port_ok;
}

PortStatus VehiclePlatform::receive_can(std::uint8_t bus, ReceivedFrame& received) { return bus == 0 ? can_.receive(received) : ENODEV; }

PortStatus VehiclePlatform::send_can(std::uint8_t bus, std::span<const CanFrame> frames) {
  if (bus != 0) return ENODEV;
  const PortStatus earlier = std::exchange(send_error_, port_ok);
  const PortStatus status = can_.send(frames);
  return status != port_ok ? status : earlier;
}

PortStatus VehiclePlatform::receive_panel(PanelResult& result) {
  if (!panel_vision_.poll(result)) return port_empty;
  result.answered = monotonic_now();
  return port_ok;
}

PortStatus VehiclePlatform::publish(const Telemetry& telemetry) { return log_.telemetry.push(telemetry) ? port_ok : ENOBUFS; }

PortStatus VehiclePlatform::wait_for_image() {
  const Time until = monotonic_now() + longest_look;
  if (const auto* device = std::get_if<std::unique_ptr<V4l2Camera>>(&camera_)) {
    (*device)->wait(until);
  } else if (const auto* ring = std::get_if<std::unique_ptr<RingCamera>>(&camera_)) {
    (*ring)->wait(until);
  } else {
    sleep_until(until);
  }
  return port_ok;
}

PortStatus VehiclePlatform::receive_image(std::uint8_t camera, Image& image) {
  if (camera != 0) return ENODEV;
  camera_status_ = port_empty;
  if (const auto* device = std::get_if<std::unique_ptr<V4l2Camera>>(&camera_)) camera_status_ = (*device)->receive(image);
  if (const auto* ring = std::get_if<std::unique_ptr<RingCamera>>(&camera_)) camera_status_ = (*ring)->receive(image);
  return camera_status_;
}

PortStatus VehiclePlatform::submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) {
  return panel_vision_.submit(vision::PanelJob::copy(request, still, cloud)) ? port_ok : EBUSY;
}

CameraReport VehiclePlatform::camera_report() const {
  CameraReport report;
  report.status = camera_status_;
  if (const auto* device = std::get_if<std::unique_ptr<V4l2Camera>>(&camera_)) {
    const V4l2Camera::Stats& s = (*device)->stats();
    report.images = s.images;
    report.skipped = s.skipped;
    report.broken = s.broken;
    report.repeated = s.repeated;
    report.stamps_missed = s.stamps_missed;
    report.controls_refused = s.controls_refused;
    report.losses = s.losses;
    report.reopened = s.reopened;
  }
  if (const auto* ring = std::get_if<std::unique_ptr<RingCamera>>(&camera_)) {
    const FrameRingReader::Stats& s = (*ring)->stats();
    report.images = s.records;
    report.skipped = (*ring)->skipped();
    report.broken = (*ring)->broken() + s.malformed;
    report.missed = s.missed;
    report.restarts = s.restarts;
  }
  return report;
}

void VehiclePlatform::on_frame(const CanFrame& frame, Time t, bool sent) { (void)log_.frames.push({frame, t, sent}); }

}  // namespace lf::hal
