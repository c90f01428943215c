// A V4L2 camera, triggered by the output node: mmap buffers, fixed exposure and gain, never waiting.
//
// Grey comes as GREY, as Y10 or Y16 (the upper eight bits) or as the luma of YUYV, whatever of these the camera has, in this order. The driver's monotonic time
// stamp becomes the start of the exposure: what the stamp means is the camera's affair (V4L2_BUF_FLAG_TSTAMP_SRC_SOE or EOF, and cables), so its distance
// from the exposure's start is calibrated: `stamp_delay`. The core takes an image whose start is within ScanConfig::match_window of an exposure it ordered.
// A camera that is not there, or goes away (ENODEV, an unplugged cable), is looked for twice a second, set up anew and goes on; each call until then answers
// ENODEV. An image bears the exposure that the camera says it has, and none (zero) where the one asked for was refused and the camera says nothing.
//
// Not thread-safe: one thread owns it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/ports.hpp"
#include "hal/vehicle/linux_calls.hpp"
#include "shared/messages/image.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

class V4l2Camera {
 public:
  struct Config {
    std::string device = "/dev/video0";
    std::int32_t width = 640;
    std::int32_t height = 480;
    Duration exposure = Duration::from_us(2000);  // V4L2 has units of 100 us: rounded to them, up
    std::int32_t gain = 0;                        // in the driver's own units
    Duration stamp_delay;                         // from the start of an exposure to the time stamp of its image
    std::uint32_t buffers = 4;
  };

  struct Stats {
    std::uint64_t images = 0;
    std::uint64_t skipped = 0;           // gaps in the driver's sequence: frames that never came
    std::uint64_t broken = 0;            // marked as erroneous by the driver, or too short
    std::uint64_t repeated = 0;          // the same sequence number or time stamp again
    std::uint32_t stamps_missed = 0;     // buffers without a monotonic time stamp: taken as of now
    std::uint32_t controls_refused = 0;  // manual exposure or gain that the camera does not have
    std::uint32_t losses = 0;
    std::uint32_t reopened = 0;
  };

  explicit V4l2Camera(const Config& config, LinuxCalls& calls = linux_calls());
  ~V4l2Camera();
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  // 0, or errno: ENOENT or ENODEV (no such camera), EINVAL (it has no grey image of this size, or is no camera), EBUSY.
  PortStatus open();
  bool is_open() const;
  static std::string explain(PortStatus error, const Config& config);

  // Takes one image, oldest first; port_empty when there is none. Its pixels stay valid until the next call.
  PortStatus receive(Image& image);
  // Waits for an image or the instant `until`, whichever comes first.
  void wait(Time until);

  const Stats& stats() const;
  const char* format() const;  // "GREY", "Y10 ", "Y16 " or "YUYV"; "" while not open

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lf::hal
