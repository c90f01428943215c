#include "hal/vehicle/ring_camera.hpp"

#include <algorithm>
#include <cerrno>

#include "hal/vehicle/tick_clock.hpp"

namespace lf::hal {

namespace {

constexpr Duration look_again = Duration::from_ms(1);

}  // namespace

PortStatus RingCamera::open() {
  if (config_.offset >= config_.bytes || config_.offset % frame_ring_page != 0) return EINVAL;
  if (const int error = file_.open(config_.path, config_.bytes); error != 0) return error;
  std::uint64_t word = 0;
  if (const int error = file_.read(&word, config_.offset, sizeof word); error != 0) {
    file_.close();
    return error;
  }
  reader_ = FrameRingReader(file_, config_.offset, config_.bytes - config_.offset);
  return port_ok;
}

PortStatus RingCamera::receive(Image& image) {
  using Answer = FrameRingReader::Answer;
  if (!file_.is_open()) return ENODEV;
  if (!has_record_) answer_ = reader_.take(info_, pixels_);
  has_record_ = false;
  if (answer_ == Answer::other_layout) return EPROTO;
  if (answer_ != Answer::record) return port_empty;
  if (any_ && info_.sequence - last_sequence_ - 1 < 0x8000'0000U) skipped_ += info_.sequence - last_sequence_ - 1;
  any_ = true;
  last_sequence_ = info_.sequence;
  const std::int64_t needed = static_cast<std::int64_t>(info_.stride) * info_.height;
  const bool complete = info_.kind == 0 && info_.width > 0 && info_.height > 0 && info_.stride >= info_.width &&
                        needed <= static_cast<std::int64_t>(info_.bytes) && needed <= static_cast<std::int64_t>(pixels_.size());
  if (!complete) {
    ++broken_;
    return port_empty;
  }
  image = {};
  image.view = {reinterpret_cast<const std::uint8_t*>(pixels_.data()), info_.width, info_.height, info_.stride};
  image.exposure_start = Time::from_ns(info_.start_ns);
  image.exposure = Duration::from_ns(info_.exposure_ns);
  image.sequence = info_.sequence;
  image.trigger = info_.trigger;
  return port_ok;
}

void RingCamera::wait(Time until) {
  while (!has_record_ && file_.is_open()) {
    answer_ = reader_.take(info_, pixels_);
    has_record_ = answer_ == FrameRingReader::Answer::record;
    const Time now = monotonic_now();
    if (has_record_ || now >= until) return;
    sleep_until(std::min(until, now + look_again));
  }
  if (!file_.is_open()) sleep_until(until);
}

}  // namespace lf::hal
