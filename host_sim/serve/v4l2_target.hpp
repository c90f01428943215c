// Frames into a V4L2 output device, 8-bit grey. v4l2loopback hands them on to whoever captures from it, with the time stamps of their exposures.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "host_sim/serve/frame_target.hpp"

namespace lf::serve {

class V4l2Target : public FrameTarget {
 public:
  // Throws InputError when there is no such device, it is no output device, or it does not take 8-bit grey of this size.
  V4l2Target(const std::string& device, std::int32_t width, std::int32_t height);
  ~V4l2Target() override;
  V4l2Target(const V4l2Target&) = delete;
  V4l2Target& operator=(const V4l2Target&) = delete;

  bool deliver(const RecordInfo& info, std::span<const std::uint8_t> pixels) override;
  void set_away(bool away) override;  // closes the device, and opens it again

 private:
  static constexpr std::size_t most_buffers = 4;
  struct Buffer {
    void* data = nullptr;
    std::size_t bytes = 0;
    bool queued = false;
  };

  std::string open();  // what went wrong; empty when nothing did
  std::string map_buffers();
  void close();

  std::string device_;
  std::int32_t width_, height_;
  int fd_ = -1;
  std::size_t buffer_count_ = 0;
  std::array<Buffer, most_buffers> buffers_{};
};

}  // namespace lf::serve
