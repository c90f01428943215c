#include "host_sim/serve/frame_target.hpp"

#include <cstring>

#include "hal/vehicle/linux_calls.hpp"
#include "host_sim/serve/v4l2_target.hpp"
#include "shared/input_error.hpp"

namespace lf::serve {

std::unique_ptr<FrameTarget> open_frame_target(const std::string& text, std::int32_t width, std::int32_t height) {
  if (text == "none") return nullptr;
  if (text.starts_with("ring:")) return std::make_unique<RingTarget>(text.substr(5));
  if (text.starts_with("v4l2:")) return std::make_unique<V4l2Target>(text.substr(5), width, height);
  if (text.starts_with("/dev/video")) return std::make_unique<V4l2Target>(text, width, height);
  throw InputError("--camera " + text + ": takes ring:FILE, v4l2:/dev/videoN or none");
}

RingTarget::RingTarget(const std::string& file) {
  if (const int error = file_.open(file, frame_ring_bytes(camera_ring_slots, camera_ring_payload)); error != 0) {
    throw InputError("--camera ring:" + file + ": cannot be mapped: " + std::strerror(error));
  }
  ring_.open(file_.bytes());
}

bool RingTarget::deliver(const RecordInfo& info, std::span<const std::uint8_t> pixels) {
  return !away_ && ring_.write(info, std::as_bytes(pixels), hal::linux_calls().monotonic_ns());
}

void RingTarget::beat() {
  if (!away_) ring_.beat(hal::linux_calls().monotonic_ns());
}

}  // namespace lf::serve
