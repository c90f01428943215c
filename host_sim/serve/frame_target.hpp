// Where the simulated camera's frames go: a frame ring that hal/vehicle reads, or a V4L2 output device such as v4l2loopback's.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "shared/frame_ring/frame_ring.hpp"
#include "shared/frame_ring/mapped_file.hpp"
#include "shared/messages/time.hpp"

namespace lf::serve {

class FrameTarget {
 public:
  virtual ~FrameTarget() = default;
  // Hands a frame over; `info.start_ns` is on CLOCK_MONOTONIC. False when the target could not take it.
  virtual bool deliver(const RecordInfo& info, std::span<const std::uint8_t> pixels) = 0;
  // The camera is unplugged, or back: while it is away nothing is delivered and nothing shows that anybody is there.
  virtual void set_away(bool away) = 0;
  // Says that the camera lives; once a millisecond will do.
  virtual void beat() {}
};

// "ring:FILE", "v4l2:/dev/videoN" or just "/dev/videoN", "none" (null). Throws InputError for other words and when the target cannot be opened.
std::unique_ptr<FrameTarget> open_frame_target(const std::string& text, std::int32_t width, std::int32_t height);

class RingTarget : public FrameTarget {
 public:
  explicit RingTarget(const std::string& file);
  bool deliver(const RecordInfo& info, std::span<const std::uint8_t> pixels) override;
  void set_away(bool away) override { away_ = away; }
  void beat() override;

 private:
  MappedFile file_;
  FrameRingWriter ring_;
  bool away_ = false;
};

}  // namespace lf::serve
