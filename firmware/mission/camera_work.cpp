#include "firmware/mission/camera_work.hpp"

#include <utility>

#include "shared/can/can_map.hpp"

namespace lf::mission {

namespace {

// Lamps are LEDs: a tenth of a second covers their drivers' soft start.
constexpr Duration lamps_settle = Duration::from_ms(100);

}  // namespace

void CameraWork::set_mode(Mode mode, Time now) {
  mode_ = mode;
  mode_since_ = now;
  frames_ = 0;
  still_done_ = false;
  inhibited_ = false;
}

void CameraWork::on_image(Time exposure_start) {
  if (exposure_start <= newest_image_) return;
  newest_image_ = exposure_start;
  std::size_t arrived = 0;
  while (arrived < awaited_.size() && awaited_[arrived] <= exposure_start) {
    images_lost_ += awaited_[arrived] < exposure_start ? 1 : 0;
    ++arrived;
  }
  forget(arrived);
}

void CameraWork::forget(std::size_t count) {
  for (std::size_t i = count; i < awaited_.size(); ++i) awaited_[i - count] = awaited_[i];
  for (std::size_t i = 0; i < count; ++i) awaited_.pop_back();
}

void CameraWork::watch_images(Time now) {
  if (awaited_.empty() || now - awaited_[0] <= config_.exposure + config_.stale_image) return;
  const bool still = mode_ == Mode::still && still_done_ && awaited_[0] == still_start_;
  silent_ = still || awaited_.size() >= silent_after;
  const std::size_t lost = silent_ ? awaited_.size() : 1;
  images_lost_ += static_cast<std::uint32_t>(lost);
  forget(lost);
}

bool CameraWork::take_silence() { return std::exchange(silent_, false); }

std::uint8_t CameraWork::lamps() const { return config_.use_lamps ? can_map::output_lamps : std::uint8_t{0}; }

void CameraWork::tick(Time now, canopen::IoModule& io, ScanOrders& orders) {
  check_outputs(now, io, orders);
  watch_images(now);
  const bool slot = ++syncs_ >= config_.camera_syncs;
  if (slot) syncs_ = 0;
  switch (mode_) {
    case Mode::idle:
      io.set_outputs(config_.always_on ? lamps() : std::uint8_t{0});
      if (slot && config_.always_on) expose(now, io, ExposureKind::monitor, lamps(), orders);
      return;
    case Mode::sweep: {
      if (!slot) return;
      const bool background = frames_++ % config_.frames_per_background == 0;
      const auto outputs = background ? std::uint8_t{0} : can_map::output_laser;
      io.set_outputs(outputs);
      inhibited_ = !background && (io.laser_inhibited() || !io.interlock_closed());
      expose(now, io, background ? ExposureKind::background : ExposureKind::laser_on, outputs, orders);
      return;
    }
    case Mode::still:
      io.set_outputs(lamps());
      if (slot && !still_done_ && now - mode_since_ >= lamps_settle) {
        still_done_ = expose(now, io, ExposureKind::still, lamps(), orders);
        still_start_ = now + config_.sync_period;
      }
      return;
    case Mode::off: io.set_outputs(0); return;
  }
}

// True when the camera was triggered and the vision thread told of it.
bool CameraWork::expose(Time now, canopen::IoModule& io, ExposureKind kind, std::uint8_t outputs, ScanOrders& orders) {
  if (!io.trigger_camera(config_.exposure)) return false;
  ScanCommand order;
  order.kind = ScanCommand::Kind::exposure;
  order.exposure_start = now + config_.sync_period;
  order.exposure_kind = kind;
  order.trigger = io.trigger_counter();
  ++exposures_;
  if (pending_.full() || !orders.push_back(order) || !pending_.push_back({order.exposure_start, outputs})) {
    ++dropped_;
    return false;
  }
  if (awaited_.full()) {
    ++images_lost_;
    forget(1);
  }
  return awaited_.push_back(order.exposure_start);
}

// A report tells of the SYNC before it, so an exposure at one SYNC is confirmed by the reports from the next SYNC on.
void CameraWork::check_outputs(Time now, const canopen::IoModule& io, ScanOrders& orders) {
  while (!pending_.empty()) {
    const Pending first = pending_[0];
    const Time from = first.start + config_.sync_period;
    const Time to = from + config_.exposure;
    if (io.actual_time() < to && now - to < config_.sync_period * 4) return;
    const auto seen = io.outputs_during(from, to);
    if (!seen || *seen != first.outputs) {
      ScanCommand order;
      order.kind = ScanCommand::Kind::drop_exposure;
      order.exposure_start = first.start;
      ++dropped_;
      if (!orders.push_back(order)) return;
    }
    for (std::size_t i = 1; i < pending_.size(); ++i) pending_[i - 1] = pending_[i];
    pending_.pop_back();
  }
}

}  // namespace lf::mission
