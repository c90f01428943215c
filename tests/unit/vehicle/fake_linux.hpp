// A kernel of the test's making: CAN sockets and one V4L2 camera, with everything that can go wrong with them, on a clock that the test turns.
#pragma once

#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <linux/videodev2.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "hal/vehicle/linux_calls.hpp"

namespace lf::test {

class FakeLinux : public hal::LinuxCalls {
 public:
  std::int64_t monotonic = 1'000'000'000;
  std::int64_t realtime = 5'000'000'000'000;

  // The CAN interface.
  struct Arriving {
    can_frame frame{};
    std::int64_t stamp = 0;  // on the wall clock; 0: none
    std::uint32_t overflow = 0;
    std::size_t bytes = sizeof(can_frame);
  };
  bool has_can = true;
  bool interface_there = true;
  bool interface_up = true;
  int receive_error = 0;  // told once
  std::deque<Arriving> arriving;
  std::size_t room = 1000;         // in the transmit queue
  int send_error = 0;              // while set
  std::uint32_t queued_bytes = 0;  // of what was sent and is still in the kernel
  int send_buffer = 0;
  std::vector<can_frame> sent;
  std::vector<can_filter> filters;
  can_err_mask_t error_mask = 0;
  int open_sockets = 0;
  int polled = 0;  // what poll() answers

  std::vector<char> link;  // what the kernel answers about an interface (rtnetlink); empty: nothing, ever

  // Clocks.
  std::int64_t monotonic_step = 1;
  bool wall_clock_kept = true;

  // The camera.
  std::vector<std::uint32_t> formats{V4L2_PIX_FMT_GREY};
  std::pair<std::int32_t, std::int32_t> exposure_range{1, 5000}, gain_range{0, 100};  // empty where the first is greater
  struct Frame {
    std::uint32_t sequence = 0;
    std::int64_t stamp_ns = 0;
    std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    std::uint8_t value = 0;
    bool whole = true;
  };
  std::map<unsigned long, int> failing_ioctls;  // request -> errno, while it is there
  bool camera_there = true;
  std::uint32_t camera_format = V4L2_PIX_FMT_GREY;
  std::deque<Frame> frames;
  std::vector<std::vector<std::uint8_t>> buffers;
  std::deque<std::uint32_t> queued;
  std::vector<std::pair<std::uint32_t, std::int32_t>> controls;
  std::int32_t exposure_100us = 333;  // until it is set
  bool streaming = false;

  int open(const char*, int) override { return camera_there ? 100 : -ENOENT; }
  int close(int fd) override {
    if (fd != 100) --open_sockets;
    if (fd == 100) streaming = false;
    return 0;
  }
  void* map(int, std::size_t, std::int64_t offset, int& error) override {
    error = 0;
    return buffers[static_cast<std::size_t>(offset)].data();
  }
  int unmap(void*, std::size_t) override { return 0; }
  int socket(int family, int, int) override {
    if (family != AF_NETLINK && !has_can) return -EAFNOSUPPORT;
    ++open_sockets;
    return family == AF_NETLINK ? 60 : 50;
  }
  int bind(int, const sockaddr*, std::size_t) override { return interface_there ? 0 : -ENODEV; }
  int set_option(int, int level, int name, const void* value, std::size_t bytes) override {
    if (level == SOL_CAN_RAW && name == CAN_RAW_FILTER) {
      filters.resize(bytes / sizeof(can_filter));
      std::memcpy(filters.data(), value, bytes);
    }
    if (level == SOL_SOCKET && name == SO_SNDBUF) std::memcpy(&send_buffer, value, sizeof send_buffer);
    if (level == SOL_CAN_RAW && name == CAN_RAW_ERR_FILTER) std::memcpy(&error_mask, value, sizeof error_mask);
    return 0;
  }
  int get_option(int, int, int name, void* value, std::size_t bytes) override {
    if (name != SO_MEMINFO) return -ENOPROTOOPT;
    std::vector<std::uint32_t> memory(bytes / sizeof(std::uint32_t));
    memory[SK_MEMINFO_WMEM_ALLOC] = queued_bytes;
    std::memcpy(value, memory.data(), bytes);
    return 0;
  }
  int ioctl(int fd, unsigned long request, void* argument) override {
    if (const auto failing = failing_ioctls.find(request); failing != failing_ioctls.end()) return -failing->second;
    return fd == 100 ? camera_ioctl(request, argument) : can_ioctl(request, argument);
  }

  int receive_many(int fd, mmsghdr* messages, unsigned count) override {
    if (fd == 60) {
      std::memcpy(messages->msg_hdr.msg_iov->iov_base, link.data(), link.size());
      messages->msg_len = static_cast<unsigned>(link.size());
      return 1;
    }
    if (receive_error != 0) return -std::exchange(receive_error, 0);
    if (arriving.empty()) return -EAGAIN;
    unsigned n = 0;
    for (; n < count && !arriving.empty(); ++n) {
      const Arriving& next = arriving.front();
      msghdr& header = messages[n].msg_hdr;
      std::memcpy(header.msg_iov->iov_base, &next.frame, sizeof next.frame);
      messages[n].msg_len = static_cast<unsigned>(next.bytes);
      put_control(header, next);
      arriving.pop_front();
    }
    return static_cast<int>(n);
  }
  int send_many(int fd, mmsghdr* messages, unsigned count) override {
    if (fd == 60) return 1;
    if (send_error != 0) return -send_error;
    if (room == 0) return -ENOBUFS;
    unsigned n = 0;
    for (; n < count && room > 0; ++n, --room) {
      can_frame frame{};
      std::memcpy(&frame, messages[n].msg_hdr.msg_iov->iov_base, sizeof frame);
      sent.push_back(frame);
    }
    return static_cast<int>(n);
  }
  int poll(int fd, short, std::int64_t timeout_ns) override {
    if (fd == 60 && !link.empty()) return POLLIN;
    monotonic += timeout_ns;
    return polled;
  }
  std::int64_t monotonic_ns() override { return monotonic; }
  std::int64_t realtime_ns() override { return realtime; }
  std::int64_t monotonic_step_ns() override { return monotonic_step; }
  bool wall_clock_synchronised() override { return wall_clock_kept; }

  void pass(std::int64_t ns) {
    monotonic += ns;
    realtime += ns;
  }

 private:
  static void put_control(msghdr& header, const Arriving& next) {
    cmsghdr* control = CMSG_FIRSTHDR(&header);
    std::size_t used = 0;
    const auto put = [&](int type, const void* data, std::size_t bytes) {
      control->cmsg_level = SOL_SOCKET;
      control->cmsg_type = type;
      control->cmsg_len = CMSG_LEN(bytes);
      std::memcpy(CMSG_DATA(control), data, bytes);
      used += CMSG_SPACE(bytes);
      control = reinterpret_cast<cmsghdr*>(reinterpret_cast<char*>(control) + CMSG_SPACE(bytes));
    };
    if (next.stamp != 0) {
      const timespec stamp{next.stamp / 1'000'000'000, next.stamp % 1'000'000'000};
      put(SCM_TIMESTAMPNS, &stamp, sizeof stamp);
    }
    if (next.overflow != 0) put(SO_RXQ_OVFL, &next.overflow, sizeof next.overflow);
    header.msg_controllen = used;
  }

  int can_ioctl(unsigned long request, void* argument) {
    if (!interface_there) return -ENODEV;
    auto* wanted = static_cast<ifreq*>(argument);
    if (request == SIOCGIFINDEX) wanted->ifr_ifindex = 3;
    if (request == SIOCGIFFLAGS) wanted->ifr_flags = interface_up ? IFF_UP : 0;
    return 0;
  }

  int camera_ioctl(unsigned long request, void* argument) {
    if (!camera_there) return -ENODEV;
    switch (request) {
      case VIDIOC_QUERYCAP: static_cast<v4l2_capability*>(argument)->capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING; return 0;
      case VIDIOC_S_FMT: {
        v4l2_pix_format& pix = static_cast<v4l2_format*>(argument)->fmt.pix;
        pix.pixelformat = camera_format;
        pix.bytesperline = pix.width * (camera_format == V4L2_PIX_FMT_GREY ? 1 : 2) + 16;  // padded, as some drivers do
        pix.sizeimage = pix.bytesperline * pix.height;
        size_ = pix.sizeimage;
        stride_ = pix.bytesperline;
        return 0;
      }
      case VIDIOC_REQBUFS:
        buffers.assign(static_cast<v4l2_requestbuffers*>(argument)->count, std::vector<std::uint8_t>(size_));
        queued.clear();
        return 0;
      case VIDIOC_QUERYBUF: {
        auto* buffer = static_cast<v4l2_buffer*>(argument);
        buffer->length = size_;
        buffer->m.offset = buffer->index;
        return 0;
      }
      case VIDIOC_QBUF: queued.push_back(static_cast<v4l2_buffer*>(argument)->index); return 0;
      case VIDIOC_DQBUF: return give(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_S_CTRL: {
        const auto* control = static_cast<v4l2_control*>(argument);
        controls.emplace_back(control->id, control->value);
        if (control->id == V4L2_CID_EXPOSURE_ABSOLUTE) exposure_100us = control->value;
        return 0;
      }
      case VIDIOC_G_CTRL: {
        auto* control = static_cast<v4l2_control*>(argument);
        if (control->id != V4L2_CID_EXPOSURE_ABSOLUTE) return -EINVAL;
        control->value = exposure_100us;
        return 0;
      }
      case VIDIOC_ENUM_FMT: {
        auto* format = static_cast<v4l2_fmtdesc*>(argument);
        if (format->index >= formats.size()) return -EINVAL;
        format->pixelformat = formats[format->index];
        return 0;
      }
      case VIDIOC_ENUM_FRAMESIZES: {
        auto* size = static_cast<v4l2_frmsizeenum*>(argument);
        if (size->index > 0) return -EINVAL;
        size->type = V4L2_FRMSIZE_TYPE_DISCRETE;
        size->discrete = {640, 480};
        return 0;
      }
      case VIDIOC_QUERYCTRL: {
        auto* control = static_cast<v4l2_queryctrl*>(argument);
        const auto& range = control->id == V4L2_CID_GAIN ? gain_range : exposure_range;
        if (range.first > range.second) return -EINVAL;
        control->minimum = range.first;
        control->maximum = range.second;
        return 0;
      }
      case VIDIOC_STREAMON: streaming = true; return 0;
      default: return 0;
    }
  }

  int give(v4l2_buffer& buffer) {
    if (frames.empty() || queued.empty()) return -EAGAIN;
    const Frame frame = frames.front();
    frames.pop_front();
    buffer.index = queued.front();
    queued.pop_front();
    buffer.sequence = frame.sequence;
    buffer.flags = frame.flags;
    buffer.bytesused = frame.whole ? size_ : size_ / 2;
    buffer.timestamp = {frame.stamp_ns / 1'000'000'000, frame.stamp_ns % 1'000'000'000 / 1000};
    std::vector<std::uint8_t>& pixels = buffers[buffer.index];
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const bool first = i % stride_ % 2 == 0;
      switch (camera_format) {
        case V4L2_PIX_FMT_YUYV: pixels[i] = first ? frame.value : 128; break;
        case V4L2_PIX_FMT_Y10: pixels[i] = static_cast<std::uint8_t>(first ? frame.value << 2 | 3 : frame.value >> 6); break;
        case V4L2_PIX_FMT_Y16: pixels[i] = first ? 0xEE : frame.value; break;
        default: pixels[i] = frame.value;
      }
    }
    return 0;
  }

  std::uint32_t size_ = 0, stride_ = 1;
};

}  // namespace lf::test
