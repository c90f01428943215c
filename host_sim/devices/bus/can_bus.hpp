// A classic CAN bus in simulated time: frames wait with their senders, the lowest identifier wins, each takes its exact bits.
//
// Deterministic: the outcome depends on the frames and their times only; frames with equal identifiers go in the order they were queued.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/devices/bus/bus_record.hpp"
#include "shared/can/can_map.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::devices {

class CanBus {
 public:
  static constexpr std::size_t queue_capacity = 64;  // frames waiting with one sender; a real controller's driver has 10 to 1000
  static constexpr std::uint32_t destroyed_one_in = 16;

  explicit CanBus(std::uint32_t bits_per_s = can_map::bitrate) : bits_per_s_(bits_per_s) {}

  // Queues `frame` with `sender` (0..127) at `now`. False, and counted as lost, when its queue is full or it is off the bus.
  bool send(std::uint8_t sender, const CanFrame& frame, Time now);

  // The next frame whose last bit passes not later than `until`; false when there is none. A receiver may send at once, from `delivered` on.
  // O(frames waiting).
  bool next(Time until, BusRecord& record);

  void drop(std::uint32_t id, bool on);             // frames with this identifier take their time but reach nobody
  void set_error_frames(bool on) { errors_ = on; }  // one frame in `destroyed_one_in` is destroyed, and sent again by its controller
  void set_bus_off(std::uint8_t sender, bool off);  // what waits with the sender is lost
  bool bus_off(std::uint8_t sender) const { return off_[sender & 0x7F]; }

  // Load is taken up to the last bit that passed.
  BusStats stats() const;

 private:
  struct Waiting {
    CanFrame frame;
    Time since;
    std::uint64_t order = 0;
    std::uint32_t key = 0;
    std::uint32_t bits = 0;
    std::uint8_t sender = 0;
  };

  std::size_t winner(Time& start) const;
  void occupy(Time start, std::uint32_t bits);
  double percent_of(std::uint64_t bits) const;
  Duration time_of(std::uint32_t bits) const { return Duration::from_ns(bits * std::int64_t{1'000'000'000} / bits_per_s_); }
  bool dropped(std::uint32_t id) const;

  std::uint32_t bits_per_s_;
  std::vector<Waiting> waiting_;
  std::array<std::uint8_t, 128> queued_{};
  std::array<bool, 128> off_{};
  std::vector<std::uint32_t> dropped_ids_;
  bool errors_ = false;
  Time free_;  // the bus is idle from here on
  std::uint64_t order_ = 0;
  std::uint64_t attempts_ = 0;
  bool started_ = false;
  Time first_, window_;
  std::uint64_t window_bits_ = 0;
  std::uint64_t worst_window_bits_ = 0;
  std::uint64_t unstuffed_bits_ = 0, worst_case_bits_ = 0;
  BusStats stats_;
};

}  // namespace lf::devices
