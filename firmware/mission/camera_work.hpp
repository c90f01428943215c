// When the camera is triggered, with laser and lamps as the picture needs them, and the orders to the vision thread that go with it.
//
// Outputs and trigger travel in one RPDO and act on one SYNC, the one after the tick that asks. The output node's reports are held against what was
// asked: a frame over which laser or lamps switched, or were not as asked, is dropped before its image comes. Each exposure's image is waited for: one
// that does not come is lost, and a camera of which none comes any more is silent.
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
    std::uint32_t camera_syncs = 10;  // one frame in so many SYNCs: 25 Hz. At least 2: outputs that last for one report are never confirmed
    std::uint32_t frames_per_background = 5;
    bool use_lamps = true;
    bool always_on = false;
    Duration sync_period = Duration::from_ms(4);
    Duration stale_image = Duration::from_ms(200);  // an image that has not come so long after its exposure never will
  };

  explicit CameraWork(const Config& config) : config_(config) {}

  void set_mode(Mode mode, Time now);
  Mode mode() const { return mode_; }
  // The still's image has come.
  bool still_taken() const { return mode_ == Mode::still && still_done_ && newest_image_ >= still_start_; }
  // A stripe was asked for, but the interlock or the node kept the laser off.
  bool laser_inhibited() const { return mode_ == Mode::sweep && inhibited_; }

  // The newest image that came is of this exposure; images come in the order of their exposures.
  void on_image(Time exposure_start);
  std::uint32_t images_lost() const { return images_lost_; }
  // Once, when three images in a row, or the still's, are overdue.
  bool take_silence();

  // Once a tick, after the answers to the last SYNC came in.
  void tick(Time now, canopen::IoModule& io, ScanOrders& orders);

  std::uint32_t exposures() const { return exposures_; }
  std::uint32_t dropped() const { return dropped_; }

 private:
  struct Pending {
    Time start;
    std::uint8_t outputs = 0;
  };

  bool expose(Time now, canopen::IoModule& io, ExposureKind kind, std::uint8_t outputs, ScanOrders& orders);
  void check_outputs(Time now, const canopen::IoModule& io, ScanOrders& orders);
  void watch_images(Time now);
  void forget(std::size_t count);
  std::uint8_t lamps() const;

  static constexpr std::size_t silent_after = 3;

  Config config_;
  Mode mode_ = Mode::idle;
  Time mode_since_;
  std::uint32_t syncs_ = 0;   // since the last frame's slot
  std::uint32_t frames_ = 0;  // of this sweep
  bool still_done_ = false;
  Time still_start_;
  bool inhibited_ = false;
  StaticVector<Pending, 8>
      pending_;  // exposures whose outputs are not confirmed yet: at most one in two SYNCs, confirmed or given up after seven
  StaticVector<Time, 32> awaited_;  // exposures whose image has not come: 26 at one in two SYNCs and 0.2 s, oldest first
  Time newest_image_;
  bool silent_ = false;
  std::uint32_t images_lost_ = 0;
  std::uint32_t exposures_ = 0;
  std::uint32_t dropped_ = 0;
};

}  // namespace lf::mission
