#include "host_sim/devices/bus/can_bus.hpp"

#include <algorithm>

#include "host_sim/devices/bus/can_bits.hpp"

namespace lf::devices {
namespace {

constexpr Duration load_window = Duration::from_ms(100);
constexpr std::uint32_t error_frame_bits = 6 + 6 + 8;  // flag, the others' flags, delimiter (ISO 11898-1)

}  // namespace

bool CanBus::send(std::uint8_t sender, const CanFrame& frame, Time now) {
  sender &= 0x7F;
  if (off_[sender] || queued_[sender] >= queue_capacity || (frame.id & CanFrame::error_flag) != 0) {
    ++stats_.lost;
    return false;
  }
  ++queued_[sender];
  waiting_.push_back({frame, now, order_++, arbitration_key(frame), frame_bits(frame), sender});
  return true;
}

std::size_t CanBus::winner(Time& start) const {
  Time earliest = waiting_.front().since;
  for (const Waiting& w : waiting_) earliest = std::min(earliest, w.since);
  start = std::max(free_, earliest);
  std::size_t best = waiting_.size();
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    if (waiting_[i].since > start) continue;
    if (best == waiting_.size() || waiting_[i].key < waiting_[best].key ||
        (waiting_[i].key == waiting_[best].key && waiting_[i].order < waiting_[best].order)) {
      best = i;
    }
  }
  return best;
}

bool CanBus::next(Time until, BusRecord& record) {
  while (!waiting_.empty()) {
    Time start;
    const std::size_t best = winner(start);
    const std::uint32_t bits = waiting_[best].bits;
    const bool destroyed = errors_ && (attempts_ + 1) % destroyed_one_in == 0;
    const std::uint32_t on_wire = destroyed ? bits / 2 + error_frame_bits : bits;
    const Time end = start + time_of(on_wire);
    if (end > until) return false;
    ++attempts_;
    occupy(start, on_wire + interframe_bits);
    // What an error frame destroyed took as long in every account.
    unstuffed_bits_ += destroyed ? on_wire + interframe_bits : unstuffed_bits(waiting_[best].frame);
    worst_case_bits_ += destroyed ? on_wire + interframe_bits : worst_case_bits(waiting_[best].frame);
    if (destroyed) {
      ++stats_.errors;
      continue;
    }
    record = {waiting_[best].frame, end, waiting_[best].sender};
    --queued_[record.sender];
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(best));
    if (dropped(record.frame.id)) {
      ++stats_.lost;
      continue;
    }
    ++stats_.frames;
    return true;
  }
  return false;
}

void CanBus::occupy(Time start, std::uint32_t bits) {
  if (!started_) {
    started_ = true;
    first_ = window_ = start;
  }
  free_ = start + time_of(bits);
  stats_.bits += bits;
  while (start - window_ >= load_window) {
    worst_window_bits_ = std::max(worst_window_bits_, window_bits_);
    window_bits_ = 0;
    window_ = window_ + load_window;
  }
  window_bits_ += bits;
}

void CanBus::drop(std::uint32_t id, bool on) {
  const auto found = std::find(dropped_ids_.begin(), dropped_ids_.end(), id);
  if (on && found == dropped_ids_.end()) dropped_ids_.push_back(id);
  if (!on && found != dropped_ids_.end()) dropped_ids_.erase(found);
}

bool CanBus::dropped(std::uint32_t id) const { return std::find(dropped_ids_.begin(), dropped_ids_.end(), id) != dropped_ids_.end(); }

void CanBus::set_bus_off(std::uint8_t sender, bool off) {
  sender &= 0x7F;
  off_[sender] = off;
  if (!off) return;
  stats_.lost += queued_[sender];
  queued_[sender] = 0;
  std::erase_if(waiting_, [sender](const Waiting& w) { return w.sender == sender; });
}

double CanBus::percent_of(std::uint64_t bits) const {
  const Duration span = started_ ? free_ - first_ : Duration{};
  return span.ns() > 0 ? 100.0 * static_cast<double>(bits) / (span.s() * bits_per_s_) : 0;
}

BusStats CanBus::stats() const {
  BusStats stats = stats_;
  stats.load_percent = percent_of(stats.bits);
  stats.load_unstuffed_percent = percent_of(unstuffed_bits_);
  stats.load_worst_case_percent = percent_of(worst_case_bits_);
  const std::uint64_t worst = std::max(worst_window_bits_, window_bits_);
  stats.peak_load_percent = 100.0 * static_cast<double>(worst) / (load_window.s() * bits_per_s_);
  return stats;
}

}  // namespace lf::devices
