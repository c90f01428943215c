// When the camera is triggered, with laser and lamps as the picture needs them, and the orders to the vision thread that go with it.
//
// Outputs and trigger travel in one RPDO and act on one SYNC, the one after the tick that asks. The output node's reports are held against what was
// asked: a frame over which laser or lamps switched, or were not as asked, is dropped before its image comes.
#pragma once

#include <cstdint>

#include "firmware/canopen/io_module.hpp"
#include "shared/messages/scan_messages.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"

namespace lf::mission {

// Orders of one tick: a joint sample, an exposure, a drop, and three of the sweep's.
using ScanOrders = StaticVector<ScanCommand, 16>;

class CameraWork {
 public:
  enum class Mode : std::uint8_t {
    idle,  // dark, unless `always_on` keeps the camera running for the record
    sweep,  // laser-on frames with a background every `frames_per_background`; without lamps, whose shadows of the arm would move from one to the other
    still,  // one picture for the marker, laser off
    off,    // dark for good: the mission has ended
  };

  struct Config {
    Duration exposure = Duration::from_us(2000);
    std::uint32_t camera_syncs = 10;  // one frame in so many SYNCs: 25 Hz
    std::uint32_t frames_per_background = 5;
    bool use_lamps = true;
    bool always_on = false;
    Duration sync_period = Duration::from_ms(4);
    Duration image_due = Duration::from_ms(100);
  };

  explicit CameraWork(const Config& config) : config_(config) {}

  void set_mode(Mode mode, Time now);
  Mode mode() const { return mode_; }
  // The still has been exposed, and its image is due.
  bool still_taken(Time now) const;
  // A stripe was asked for, but the interlock or the node kept the laser off.
  bool laser_inhibited() const { return mode_ == Mode::sweep && inhibited_; }

  // Once a tick, after the answers to the last SYNC came in.
  void tick(Time now, canopen::IoModule& io, ScanOrders& orders);

  std::uint32_t exposures() const { return exposures_; }
  std::uint32_t dropped() const { return dropped_; }

 private:
  struct Pending {
    Time start;
    std::uint8_t outputs = 0;
  };

  void expose(Time now, canopen::IoModule& io, ExposureKind kind, std::uint8_t outputs, ScanOrders& orders);
  void check_outputs(Time now, const canopen::IoModule& io, ScanOrders& orders);
  std::uint8_t lamps() const;

  Config config_;
  Mode mode_ = Mode::idle;
  Time mode_since_;
  std::uint32_t syncs_ = 0;   // since the last frame's slot
  std::uint32_t frames_ = 0;  // of this sweep
  bool still_done_ = false;
  Time still_start_;
  bool inhibited_ = false;
  StaticVector<Pending, 8> pending_;  // exposures whose outputs are not confirmed yet: at most one in ten SYNCs, confirmed after two
  std::uint32_t exposures_ = 0;
  std::uint32_t dropped_ = 0;
};

}  // namespace lf::mission
