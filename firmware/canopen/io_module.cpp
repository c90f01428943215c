#include "firmware/canopen/io_module.hpp"

#include <algorithm>

#include "firmware/canopen/cob_id.hpp"
#include "firmware/canopen/codec.hpp"

namespace lf::canopen {

// Half a period more than three, for the loop's jitter.
bool IoModule::fresh(Time now) const { return seen_ && now - actual_time_ <= sync_period_ * 7 / 2; }

void IoModule::set_outputs(std::uint8_t outputs) {
  wanted_outputs_ = outputs;
  if ((outputs & can_map::output_laser) == 0) laser_inhibited_ = false;
}

bool IoModule::trigger_camera(Duration exposure) {
  const std::int64_t us = exposure.ns() / 1000;
  if (!online_ || !seen_ || trigger_pending_ || us < 1 || us > 0xFFFF) {
    ++stats_.triggers_refused;
    return false;
  }
  trigger_pending_ = true;
  exposure_us_ = static_cast<std::uint16_t>(us);
  ++trigger_counter_;
  ++stats_.triggers;
  return true;
}

void IoModule::go_offline() {
  online_ = false;
  seen_ = false;
  wanted_outputs_ = 0;
  sent_outputs_ = 0;
  laser_inhibited_ = false;
  trigger_pending_ = false;
  outputs_ = 0;
  inputs_ = 0;
  steady_count_ = 0;
}

void IoModule::on_tpdo(const CanFrame& frame, Time sync) {
  const auto outputs = get<std::uint8_t>(frame, can_map::io_tpdo1::outputs_actual);
  inputs_ = get<std::uint8_t>(frame, can_map::io_tpdo1::inputs);
  last_trigger_counter_ = get<std::uint8_t>(frame, can_map::io_tpdo1::last_trigger_counter);
  last_exposure_ = Duration::from_us(get<std::uint16_t>(frame, can_map::io_tpdo1::last_exposure));
  if (!seen_) trigger_counter_ = last_trigger_counter_;

  const bool gap = seen_ && sync - actual_time_ > sync_period_ + sync_period_ / 2;  // what happened in a lost cycle is not known
  if (steady_count_ == 0 || outputs != outputs_ || gap) steady_[steady_count_++ % history] = {outputs, sync, sync};
  steady_[(steady_count_ - 1) % history].to = sync;
  outputs_ = outputs;
  actual_time_ = sync;
  seen_ = true;
}

std::optional<std::uint8_t> IoModule::outputs_during(Time from, Time to) const {
  const std::size_t known = std::min(steady_count_, history);
  for (std::size_t back = 1; back <= known; ++back) {
    const Steady& stretch = steady_[(steady_count_ - back) % history];
    if (stretch.from <= from && to <= stretch.to) return stretch.outputs;
  }
  return std::nullopt;
}

void IoModule::step(Time now) {
  trigger_pending_ = false;
  const bool laser_wanted = (wanted_outputs_ & can_map::output_laser) != 0;
  if (laser_wanted && !(interlock_closed() && fresh(now))) laser_inhibited_ = true;
  const bool hold_back = laser_wanted && laser_inhibited_;
  if (hold_back) ++stats_.laser_inhibited;
  sent_outputs_ = hold_back ? static_cast<std::uint8_t>(wanted_outputs_ & ~can_map::output_laser) : wanted_outputs_;
}

bool IoModule::make_rpdo(CanFrame& frame, std::uint8_t node) const {
  if (!online_ || !seen_) return false;
  frame = empty_frame(cob_id::rpdo1 + node, rpdo_length);
  put(frame, can_map::io_rpdo1::outputs, sent_outputs_);
  put(frame, can_map::io_rpdo1::trigger_counter, trigger_counter_);
  put(frame, can_map::io_rpdo1::exposure, exposure_us_);
  return true;
}

}  // namespace lf::canopen
