#include "hal/vehicle/v4l2_camera.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

namespace lf::hal {

namespace {

constexpr std::int64_t search_ns = 500'000'000;
constexpr std::array<std::uint32_t, 4> formats{V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y10, V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_YUYV};

std::int64_t stamp_ns(const v4l2_buffer& buffer) {
  return buffer.timestamp.tv_sec * std::int64_t{1'000'000'000} + buffer.timestamp.tv_usec * std::int64_t{1'000};
}

bool is_gone(int error) { return error == ENODEV || error == ENXIO || error == EIO || error == ENOENT; }

}  // namespace

struct V4l2Camera::State {
  struct Buffer {
    std::uint8_t* data = nullptr;
    std::size_t bytes = 0;
  };

  State(const Config& c, LinuxCalls& l)
      : config(c), calls(l), grey(static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height)) {}
  ~State() { close(); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  PortStatus open();
  void close();
  PortStatus lose();
  PortStatus choose_format();
  PortStatus map_buffers();
  bool set_control(std::uint32_t id, std::int32_t value);
  void set_controls();
  bool give_back();
  bool usable(const v4l2_buffer& buffer);
  Time start_of(const v4l2_buffer& buffer);
  ImageView grey_of(const v4l2_buffer& buffer);

  Config config;
  LinuxCalls& calls;
  int fd = -1;
  bool was_open = false;
  std::int64_t searched_ns = 0;
  Duration exposure;  // as the camera has it; zero: it does not say
  std::uint32_t format = 0;
  std::array<char, 5> format_name{};
  std::uint32_t stride = 0;
  std::vector<Buffer> buffers;
  std::vector<std::uint8_t> grey;
  v4l2_buffer lent{};
  bool has_lent = false;
  bool any = false;  // an image came since the camera was opened
  std::uint32_t last_sequence = 0;
  std::int64_t last_stamp_ns = 0;  // the last one that was believed
  std::uint32_t sequence = 0;      // grows on over a camera that came back
  Stats stats;
};

PortStatus V4l2Camera::State::choose_format() {
  for (const std::uint32_t candidate : formats) {
    v4l2_format wanted{};
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    wanted.fmt.pix.width = static_cast<std::uint32_t>(config.width);
    wanted.fmt.pix.height = static_cast<std::uint32_t>(config.height);
    wanted.fmt.pix.pixelformat = candidate;
    wanted.fmt.pix.field = V4L2_FIELD_NONE;
    // EINVAL is a format that the camera has not; anything else is no answer about formats.
    const int error = calls.ioctl(fd, VIDIOC_S_FMT, &wanted);
    if (error == -EINVAL) continue;
    if (error < 0) return -error;
    const v4l2_pix_format& got = wanted.fmt.pix;
    if (got.pixelformat != candidate || got.width != static_cast<std::uint32_t>(config.width) ||
        got.height != static_cast<std::uint32_t>(config.height))
      continue;
    const std::uint32_t pixel_bytes = candidate == V4L2_PIX_FMT_GREY ? 1 : 2;
    format = candidate;
    stride = std::max(got.bytesperline, got.width * pixel_bytes);
    std::memcpy(format_name.data(), &candidate, sizeof candidate);  // a fourcc is its letters
    return port_ok;
  }
  return EINVAL;
}

bool V4l2Camera::State::set_control(std::uint32_t id, std::int32_t value) {
  v4l2_control control{id, value};
  if (calls.ioctl(fd, VIDIOC_S_CTRL, &control) >= 0) return true;
  ++stats.controls_refused;
  return false;
}

void V4l2Camera::State::set_controls() {
  const auto wanted = static_cast<std::int32_t>((config.exposure.ns() + 99'999) / 100'000);
  const bool by_hand = set_control(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
  exposure = by_hand && set_control(V4L2_CID_EXPOSURE_ABSOLUTE, wanted) ? config.exposure : Duration{};
  // What the camera has instead, where it says so: a driver may also take another value than the one asked for.
  v4l2_control has{V4L2_CID_EXPOSURE_ABSOLUTE, 0};
  if (by_hand && calls.ioctl(fd, VIDIOC_G_CTRL, &has) >= 0 && has.value != wanted)
    exposure = Duration::from_us(std::int64_t{100} * has.value);
  (void)set_control(V4L2_CID_AUTOGAIN, 0);
  (void)set_control(V4L2_CID_GAIN, config.gain);
}

PortStatus V4l2Camera::State::map_buffers() {
  v4l2_requestbuffers request{};
  request.count = config.buffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = calls.ioctl(fd, VIDIOC_REQBUFS, &request); error < 0) return -error;
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer{};
    buffer.index = i;
    buffer.type = request.type;
    buffer.memory = request.memory;
    if (const int error = calls.ioctl(fd, VIDIOC_QUERYBUF, &buffer); error < 0) return -error;
    int error = 0;
    void* mapped = calls.map(fd, buffer.length, buffer.m.offset, error);
    if (mapped == nullptr) return -error;
    buffers.push_back({static_cast<std::uint8_t*>(mapped), buffer.length});
    if (const int queued = calls.ioctl(fd, VIDIOC_QBUF, &buffer); queued < 0) return -queued;
  }
  return buffers.empty() ? ENOMEM : port_ok;
}

PortStatus V4l2Camera::State::open() {
  close();
  searched_ns = calls.monotonic_ns();
  fd = calls.open(config.device.c_str(), O_RDWR | O_NONBLOCK);
  if (fd < 0) return -std::exchange(fd, -1);
  const auto refuse = [this](int error) {
    close();
    return error;
  };
  v4l2_capability capability{};
  if (calls.ioctl(fd, VIDIOC_QUERYCAP, &capability) < 0) return refuse(EINVAL);
  const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) return refuse(EINVAL);
  if (const PortStatus error = choose_format(); error != port_ok) return refuse(error);
  set_controls();
  if (const PortStatus error = map_buffers(); error != port_ok) return refuse(error);
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int error = calls.ioctl(fd, VIDIOC_STREAMON, &type); error < 0) return refuse(-error);
  any = false;
  if (was_open) ++stats.reopened;
  was_open = true;
  return port_ok;
}

void V4l2Camera::State::close() {
  if (fd < 0) return;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  (void)calls.ioctl(fd, VIDIOC_STREAMOFF, &type);
  for (const Buffer& buffer : buffers) calls.unmap(buffer.data, buffer.bytes);
  buffers.clear();
  has_lent = false;
  calls.close(fd);
  fd = -1;
  format_name = {};
}

PortStatus V4l2Camera::State::lose() {
  ++stats.losses;
  searched_ns = calls.monotonic_ns();
  close();
  return ENODEV;
}

bool V4l2Camera::State::give_back() {
  if (!has_lent) return true;
  has_lent = false;
  return calls.ioctl(fd, VIDIOC_QBUF, &lent) >= 0;
}

// Counts what is missing before this buffer; false for one that cannot be used.
bool V4l2Camera::State::usable(const v4l2_buffer& buffer) {
  const std::uint32_t step = buffer.sequence - last_sequence;
  const std::int64_t stamp = stamp_ns(buffer);
  const bool same_stamp = stamp != 0 && stamp == last_stamp_ns;
  const bool repeated = (any && step == 0) || same_stamp;
  if (any && step != 0 && step < 0x8000'0000U) {
    stats.skipped += step - 1;
    sequence += step;
  } else if (!repeated) {
    ++sequence;
  }
  last_sequence = buffer.sequence;
  any = true;
  const bool complete = buffer.index < buffers.size() && (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 &&
                        buffer.bytesused >= stride * static_cast<std::uint32_t>(config.height) &&
                        buffer.bytesused <= buffers[buffer.index].bytes;
  stats.repeated += repeated ? 1 : 0;
  stats.broken += !repeated && !complete ? 1 : 0;
  return complete && !repeated;
}

// A copied stamp is the writer's of a loopback device; both kinds are CLOCK_MONOTONIC. So is that of v4l2loopback 0.12, which leaves the kind open: such a
// stamp is believed when it is of the last second, which no wall clock's is.
Time V4l2Camera::State::start_of(const v4l2_buffer& buffer) {
  const std::uint32_t clock = buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK;
  const bool monotonic = clock == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC || clock == V4L2_BUF_FLAG_TIMESTAMP_COPY;
  const std::int64_t stamp = stamp_ns(buffer);
  const std::int64_t now_ns = calls.monotonic_ns();
  const bool recent = stamp <= now_ns && now_ns - stamp < 1'000'000'000;
  const bool open_kind = clock == V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN && recent;
  if (stamp == 0 || !(monotonic || open_kind)) {
    ++stats.stamps_missed;
    return Time::from_ns(now_ns) - config.stamp_delay;
  }
  last_stamp_ns = stamp;
  return Time::from_ns(stamp) - config.stamp_delay;
}

ImageView V4l2Camera::State::grey_of(const v4l2_buffer& buffer) {
  const std::uint8_t* pixels = buffers[buffer.index].data;
  if (format == V4L2_PIX_FMT_GREY) return {pixels, config.width, config.height, static_cast<std::int32_t>(stride)};
  for (std::int32_t v = 0; v < config.height; ++v) {
    const std::uint8_t* from = pixels + static_cast<std::size_t>(v) * stride;
    std::uint8_t* to = grey.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(config.width);
    for (std::int32_t u = 0; u < config.width; ++u) {
      const unsigned low = from[2 * u], high = from[2 * u + 1];
      // Y10 fills the lower ten bits of two little-endian bytes, Y16 all of them; YUYV has its luma in every first byte.
      to[u] = static_cast<std::uint8_t>(format == V4L2_PIX_FMT_YUYV ? low : format == V4L2_PIX_FMT_Y10 ? (high << 6 | low >> 2) : high);
    }
  }
  return {grey.data(), config.width, config.height, config.width};
}

V4l2Camera::V4l2Camera(const Config& config, LinuxCalls& calls) : state_(std::make_unique<State>(config, calls)) {}
V4l2Camera::~V4l2Camera() = default;

PortStatus V4l2Camera::open() { return state_->open(); }
bool V4l2Camera::is_open() const { return state_->fd >= 0; }
const V4l2Camera::Stats& V4l2Camera::stats() const { return state_->stats; }
const char* V4l2Camera::format() const { return state_->format_name.data(); }

std::string V4l2Camera::explain(PortStatus error, const Config& config) {
  const std::string size = std::to_string(config.width) + "x" + std::to_string(config.height);
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO: return config.device + ": there is no camera; `v4l2-ctl --list-devices` shows those there are";
    case EINVAL:
      return config.device + ": has no " + size + " image in GREY, Y10, Y16 or YUYV (`v4l2-ctl -d " + config.device +
             " --list-formats-ext`)";
    case EACCES: return config.device + ": no permission; its user belongs to the group video";
    case EBUSY: return config.device + ": another program has it";
    default: return config.device + ": " + std::strerror(error);
  }
}

PortStatus V4l2Camera::receive(Image& image) {
  State& own = *state_;
  if (own.fd < 0) {
    if (own.calls.monotonic_ns() - own.searched_ns < search_ns) return ENODEV;
    if (own.open() != port_ok) return ENODEV;
  }
  if (!own.give_back()) return own.lose();
  for (std::uint32_t i = 0; i < own.config.buffers; ++i) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    const int error = own.calls.ioctl(own.fd, VIDIOC_DQBUF, &buffer);
    if (error == -EAGAIN) return port_empty;
    if (error < 0) return is_gone(-error) ? own.lose() : -error;
    own.lent = buffer;
    own.has_lent = true;
    if (!own.usable(buffer)) {
      if (!own.give_back()) return own.lose();
      continue;
    }
    image = {};
    image.view = own.grey_of(buffer);
    image.exposure_start = own.start_of(buffer);
    image.exposure = own.exposure;
    image.sequence = own.sequence;
    ++own.stats.images;
    return port_ok;
  }
  return port_empty;
}

void V4l2Camera::wait(Time until) {
  const std::int64_t left_ns = std::max<std::int64_t>(0, until.ns() - state_->calls.monotonic_ns());
  const int events = state_->calls.poll(state_->fd, POLLIN, left_ns);
  // A camera in trouble is ready at once, for ever.
  constexpr std::int64_t breath_ns = 5'000'000;
  if (events < 0 || (events & (POLLERR | POLLHUP | POLLNVAL)) != 0) (void)state_->calls.poll(-1, 0, std::min(left_ns, breath_ns));
}

}  // namespace lf::hal
