#include "host_sim/serve/v4l2_target.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "hal/vehicle/linux_calls.hpp"
#include "shared/input_error.hpp"

namespace lf::serve {

namespace {

constexpr std::uint32_t output = V4L2_BUF_TYPE_VIDEO_OUTPUT;

hal::LinuxCalls& calls() { return hal::linux_calls(); }

std::string because(const char* what, int negative_errno) { return std::string(what) + ": " + std::strerror(-negative_errno); }

}  // namespace

V4l2Target::V4l2Target(const std::string& device, std::int32_t width, std::int32_t height)
    : device_(device), width_(width), height_(height) {
  if (const std::string error = open(); !error.empty()) {
    close();
    throw InputError("--camera v4l2:" + device + ": " + error);
  }
}

V4l2Target::~V4l2Target() { close(); }

std::string V4l2Target::open() {
  fd_ = calls().open(device_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) return std::strerror(-fd_);
  v4l2_capability capability{};
  if (const int e = calls().ioctl(fd_, VIDIOC_QUERYCAP, &capability); e < 0) return because("is no V4L2 device", e);
  const std::uint32_t able = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((able & V4L2_CAP_VIDEO_OUTPUT) == 0) return "takes no frames; load v4l2loopback and name its device";
  v4l2_format format{};
  format.type = output;
  format.fmt.pix.width = static_cast<std::uint32_t>(width_);
  format.fmt.pix.height = static_cast<std::uint32_t>(height_);
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  format.fmt.pix.bytesperline = static_cast<std::uint32_t>(width_);
  format.fmt.pix.sizeimage = static_cast<std::uint32_t>(width_ * height_);
  if (const int e = calls().ioctl(fd_, VIDIOC_S_FMT, &format); e < 0) return because("does not take 8-bit grey", e);
  if (format.fmt.pix.pixelformat != V4L2_PIX_FMT_GREY || format.fmt.pix.width != static_cast<std::uint32_t>(width_) ||
      format.fmt.pix.height != static_cast<std::uint32_t>(height_)) {
    return "does not take 8-bit grey of this size";
  }
  return map_buffers();
}

std::string V4l2Target::map_buffers() {
  v4l2_requestbuffers request{};
  request.count = most_buffers;
  request.type = output;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int e = calls().ioctl(fd_, VIDIOC_REQBUFS, &request); e < 0) return because("gives no buffers", e);
  if (request.count == 0) return "gives no buffers";
  buffer_count_ = std::min<std::size_t>(request.count, most_buffers);
  for (std::size_t i = 0; i < buffer_count_; ++i) {
    v4l2_buffer buffer{};
    buffer.type = output;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = static_cast<std::uint32_t>(i);
    if (const int e = calls().ioctl(fd_, VIDIOC_QUERYBUF, &buffer); e < 0) return because("does not tell of its buffers", e);
    int error = 0;
    void* data = calls().map(fd_, buffer.length, buffer.m.offset, error);
    if (data == nullptr) return because("its buffers cannot be mapped", error);
    buffers_[i] = {data, buffer.length, false};
    if (buffer.length < static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) return "its buffers are too small";
  }
  std::uint32_t type = output;
  if (const int e = calls().ioctl(fd_, VIDIOC_STREAMON, &type); e < 0) return because("does not start", e);
  return {};
}

void V4l2Target::close() {
  if (fd_ < 0) return;
  std::uint32_t type = output;
  calls().ioctl(fd_, VIDIOC_STREAMOFF, &type);
  for (Buffer& buffer : buffers_) {
    if (buffer.data != nullptr) calls().unmap(buffer.data, buffer.bytes);
    buffer = {};
  }
  calls().close(fd_);
  fd_ = -1;
  buffer_count_ = 0;
}

void V4l2Target::set_away(bool away) {
  if (away || (fd_ < 0 && !open().empty())) close();
}

bool V4l2Target::deliver(const RecordInfo& info, std::span<const std::uint8_t> pixels) {
  if (fd_ < 0) return false;
  v4l2_buffer buffer{};
  buffer.type = output;
  buffer.memory = V4L2_MEMORY_MMAP;
  while (calls().ioctl(fd_, VIDIOC_DQBUF, &buffer) >= 0) {
    if (buffer.index < buffer_count_) buffers_[buffer.index].queued = false;
  }
  std::size_t free = 0;
  while (free < buffer_count_ && buffers_[free].queued) ++free;
  if (free == buffer_count_) return false;
  std::memcpy(buffers_[free].data, pixels.data(), std::min(pixels.size(), buffers_[free].bytes));
  buffer = {};
  buffer.type = output;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = static_cast<std::uint32_t>(free);
  buffer.bytesused = static_cast<std::uint32_t>(pixels.size());
  buffer.field = V4L2_FIELD_NONE;
  buffer.sequence = info.sequence;
  // v4l2loopback hands a time stamp on that is not zero: the capturing side sees the start of the exposure.
  buffer.timestamp.tv_sec = info.start_ns / 1'000'000'000;
  buffer.timestamp.tv_usec = info.start_ns / 1000 % 1'000'000;
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_COPY;
  if (calls().ioctl(fd_, VIDIOC_QBUF, &buffer) < 0) return false;
  buffers_[free].queued = true;
  return true;
}

}  // namespace lf::serve
