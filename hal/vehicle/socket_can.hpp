// Raw CAN over SocketCAN: a real controller (can0) and a virtual one (vcan0) alike, never blocking, in batches.
//
// Receive: exact filters in the kernel; frames carry the kernel's receive time, put on CLOCK_MONOTONIC whatever the wall clock does; what overflowed the
// socket's queue is counted. Error frames come as frames with CanFrame::error_flag, and are counted by what they say (can_error.hpp).
// Send: what the controller's queue does not take at once (ENOBUFS, EAGAIN) waits in order and is tried again at the next send() or flush(), until its
// deadline; then it is dropped and counted, since a late SYNC or set point is worse than none. What the kernel has taken counts as well: it cannot be called
// back. Therefore its queue is kept short, and while it has not been empty for a deadline nothing more is put into it.
// An interface that is down, gone or bus-off is an error that is told at every call until it is back; the same object works again then. A bus-off controller
// stays off until restart_can() (can_restart.hpp): nothing restarts by itself.
//
// Not thread-safe: one thread owns it. No heap after construction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hal/ports.hpp"
#include "hal/vehicle/can_error.hpp"
#include "hal/vehicle/linux_calls.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

// Frames whose identifier, flags included, equals `id` in the bits of `mask`.
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  // This very identifier as a standard data frame, and no other.
  static CanFilter exactly(std::uint32_t id);
};

// What the master listens to: EMCY, TPDO1, SDO answers and heartbeats of its `nodes`, those of the CAN map unless stated; and what only a master sends, which
// tells of a second one: NMT, SYNC, its heartbeat, RPDOs and SDO requests. Frames of this socket's own do not come back.
std::vector<CanFilter> core_filters();
std::vector<CanFilter> core_filters(std::span<const std::uint8_t> nodes);

// Told of every frame as it crosses the kernel's border; for the log.
class CanTap {
 public:
  virtual ~CanTap() = default;
  virtual void on_frame(const CanFrame& frame, Time t, bool sent) = 0;
};

class SocketCan {
 public:
  struct Config {
    std::string interface = "can0";
    std::vector<CanFilter> filters;  // empty: every frame
    bool error_frames = true;
    int receive_buffer_bytes = 1 << 20;  // some 2500 frames: half a second of a full bus at 1 Mbit/s
    // Of frames that the kernel has taken and the controller has not. It charges 768 bytes for each and doubles the number that it is given: 32 frames,
    // a tick's and its retries (docs: canopen.md).
    int send_buffer_bytes = 32 * 768 / 2;
    Duration transmit_deadline = Duration::from_ms(4);  // a SYNC period
  };

  struct Stats {
    std::uint64_t received = 0;       // data frames
    std::uint64_t sent = 0;           // taken by the kernel
    std::uint64_t overflowed = 0;     // lost in the socket's full receive queue
    std::uint64_t expired = 0;        // not sent before their deadline
    std::uint64_t refused = 0;        // not sent: no room to wait in, or the interface was down, gone or never there
    std::uint64_t full = 0;           // times the controller's queue was full
    std::uint64_t stuck = 0;          // times frames were held back, since those before had been in the queue for a deadline
    std::uint32_t malformed = 0;      // messages that are no classic CAN frame
    std::uint32_t stamps_missed = 0;  // receive times that could not be had, or that a jump of the wall clock spoilt: taken as of now
    std::uint32_t downs = 0;          // times the interface went down
    std::uint32_t losses = 0;         // times it went away
    std::uint32_t reopened = 0;       // times it was found again
    CanErrorCounts errors;
  };

  explicit SocketCan(const Config& config, LinuxCalls& calls = linux_calls());
  ~SocketCan();
  SocketCan(SocketCan&&) noexcept;
  SocketCan& operator=(SocketCan&&) noexcept;

  // 0, or errno: EAFNOSUPPORT or EPROTONOSUPPORT (this kernel has no CAN), ENODEV (no such interface), ENETDOWN (it is down; open nevertheless),
  // EPERM. `explain` puts it in words with what to do.
  PortStatus open();
  bool is_open() const;
  static std::string explain(PortStatus error, const std::string& interface);

  // Takes one frame, oldest first; port_empty when there is none. ENETDOWN once when the interface went down, ENODEV while it is gone.
  // While it is gone, every call in a tenth of a second looks for it anew.
  PortStatus receive(ReceivedFrame& received);
  // Sends frames in order, behind those that wait. ENOBUFS when frames were dropped since the last call, ENETDOWN or ENODEV.
  PortStatus send(std::span<const CanFrame> frames);
  // Tries again what waits.
  PortStatus flush();
  std::size_t waiting() const;

  // Waits until a frame can be taken or the instant `until` on CLOCK_MONOTONIC has come; true when there is a frame or an error to take.
  bool wait_readable(Time until);
  int fd() const;  // for poll(2); -1 when not open

  void set_tap(CanTap* tap);
  const Stats& stats() const;
  const std::string& interface() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lf::hal
