#include "hal/sim/sim_platform.hpp"

#include <utility>

namespace lf::hal {

namespace {

constexpr Duration physics_step = Duration::from_ms(1);

// Codes of this platform's failures, as errno has them.
constexpr PortStatus no_such_device = 19;  // ENODEV
constexpr PortStatus busy = 16;            // EBUSY
constexpr PortStatus no_buffer = 105;      // ENOBUFS

}  // namespace

static_assert(Platform<SimPlatform>);

SimPlatform::SimPlatform(const SimConfig& config, SimObserver& observer)
    : config_(config),
      observer_(observer),
      world_(config.world),
      devices_(config.devices),
      renderer_(config.optics),
      vision_(config.vision) {
  devices_.set_tap([this](const devices::BusRecord& record) { observer_.on_bus_frame(record); });
}

PortStatus SimPlatform::wait_for_tick(Time& tick) {
  const Time end = now_ + can_map::sync_period;
  while (now_ < end) step();
  tick = now_;
  return port_ok;
}

void SimPlatform::step() {
  now_ = now_ + physics_step;
  world_.set_drives(devices_.drives());
  world_.step();
  devices_.step(now_, world_.readings());
  expose();
  observer_.on_step(now_, world_);
}

// Takes new exposures, and hands those whose middle has come to the renderer with the bodies as they are now.
void SimPlatform::expose() {
  while (const std::optional<devices::Exposure> exposure = devices_.take_exposure()) {
    PendingExposure pending;
    pending.exposure = *exposure;
    pending.sequence = exposures_++;
    pending_.push_back(std::move(pending));
  }
  for (PendingExposure& pending : pending_) {
    const Time mid = pending.exposure.start + pending.exposure.duration / 2;
    if (pending.submitted || now_ + physics_step / 2 < mid) continue;
    pending.poses = world_.base_from_body();
    optics::Shot shot;
    shot.frame_number = pending.sequence;
    shot.poses = pending.poses;
    shot.laser = pending.exposure.laser;
    shot.lamps = pending.exposure.lamps;
    shot.truth = pending.exposure.laser;
    pending.ticket = renderer_.submit(shot);
    pending.submitted = true;
  }
}

PortStatus SimPlatform::receive_can(std::uint8_t bus, ReceivedFrame& received) {
  if (bus != 0) return no_such_device;
  return devices_.next_to_master(received.frame, received.t) ? port_ok : port_empty;
}

PortStatus SimPlatform::send_can(std::uint8_t bus, std::span<const CanFrame> frames) {
  if (bus != 0) return no_such_device;
  for (const CanFrame& frame : frames) {
    if (!devices_.master_sends(frame, now_)) return no_buffer;
  }
  return port_ok;
}

PortStatus SimPlatform::receive_image(std::uint8_t camera, Image& image) {
  if (camera != 0) return no_such_device;
  if (pending_.empty() || !pending_.front().submitted) return port_empty;
  const PendingExposure& first = pending_.front();
  if (now_ < first.exposure.start + config_.image_latency) return port_empty;

  renderer_.wait(first.ticket, delivered_);
  observer_.on_image({first.exposure, first.sequence, first.poses, &delivered_});
  image.view = {delivered_.pixels.data(), delivered_.width, delivered_.height, delivered_.width};
  image.exposure_start = first.exposure.start;
  image.exposure = first.exposure.duration;
  image.sequence = first.sequence;
  pending_.pop_front();
  return port_ok;
}

PortStatus SimPlatform::submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) {
  observer_.on_panel_request(request, still, cloud);
  if (!vision_.submit(vision::PanelJob::copy(request, still, cloud))) return busy;
  vision_answer_due_ = now_ + config_.vision_latency;
  return port_ok;
}

PortStatus SimPlatform::receive_panel(PanelResult& result) {
  if (!vision_answer_due_ || now_ < *vision_answer_due_) return port_empty;
  vision_answer_due_.reset();
  if (!vision_.wait(result)) return port_empty;
  result.answered = now_;
  observer_.on_panel_result(result);
  return port_ok;
}

PortStatus SimPlatform::publish(const Telemetry& telemetry) {
  observer_.on_telemetry(telemetry);
  return port_ok;
}

}  // namespace lf::hal
