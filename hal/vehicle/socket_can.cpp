#include "hal/vehicle/socket_can.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include "shared/can/can_map.hpp"

namespace lf::hal {

namespace {

// A tick's answers are 18 frames at most, its orders 26.
constexpr unsigned batch = 64;
// What waits for a full controller: four ticks' worth.
constexpr std::size_t queue = 128;
// An interface that went away is looked for this often.
constexpr std::int64_t search_ns = 100'000'000;

CanFrame frame_of(const can_frame& raw) {
  CanFrame frame;
  frame.id = raw.can_id;
  frame.length = std::min<std::uint8_t>(raw.len, 8);
  if ((frame.id & CanFrame::remote_flag) == 0) std::copy_n(raw.data, frame.length, frame.data.begin());
  return frame;
}

can_frame raw_of(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id;
  raw.len = frame.length;
  std::copy(frame.data.begin(), frame.data.end(), raw.data);
  return raw;
}

bool is_gone(int error) { return error == ENODEV || error == ENXIO; }

}  // namespace

CanFilter CanFilter::exactly(std::uint32_t id) { return {id, CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK}; }

std::vector<CanFilter> core_filters() {
  std::vector<std::uint8_t> nodes(can_map::drive_nodes.begin(), can_map::drive_nodes.end());
  nodes.push_back(can_map::io_node);
  return core_filters(nodes);
}

std::vector<CanFilter> core_filters(std::span<const std::uint8_t> nodes) {
  std::vector<CanFilter> filters{CanFilter::exactly(0x000), CanFilter::exactly(0x080), CanFilter::exactly(0x700U + can_map::master_node)};
  for (const std::uint8_t node : nodes) {
    // The second half are a master's: RPDO 1 to 4 and SDO requests.
    for (const std::uint32_t function : {0x080U, 0x180U, 0x580U, 0x700U, 0x200U, 0x300U, 0x400U, 0x500U, 0x600U})
      filters.push_back(CanFilter::exactly(function + node));
  }
  return filters;
}

struct SocketCan::State {
  // Messages, buffers and control data of one recvmmsg, prepared once; the kernel writes the lengths.
  struct Inbox {
    std::array<mmsghdr, batch> messages{};
    std::array<iovec, batch> vectors{};
    std::array<can_frame, batch> frames{};
    struct alignas(cmsghdr) Control {
      std::array<char, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> bytes;
    };
    std::array<Control, batch> controls{};
    unsigned count = 0, next = 0;
  };
  struct Waiting {
    CanFrame frame;
    std::int64_t deadline_ns = 0;
  };

  State(const Config& c, LinuxCalls& l) : config(c), calls(l) {
    for (unsigned i = 0; i < batch; ++i) {
      inbox.vectors[i] = {&inbox.frames[i], sizeof(can_frame)};
      outbox_vectors[i] = {&outbox_frames[i], sizeof(can_frame)};
      outbox[i].msg_hdr.msg_iov = &outbox_vectors[i];
      outbox[i].msg_hdr.msg_iovlen = 1;
    }
  }
  ~State() { close(); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void close() {
    if (fd >= 0) calls.close(fd);
    fd = -1;
  }

  PortStatus open();
  PortStatus configure();
  PortStatus look_for_it();
  PortStatus fill();
  void read_control(const msghdr& header, std::int64_t realtime_ns, std::int64_t monotonic_ns, Time& stamp);
  PortStatus fail(int error);
  void expire(std::int64_t now_ns);
  PortStatus flush();
  PortStatus drops();
  bool stuck(std::int64_t now_ns);

  Config config;
  LinuxCalls& calls;
  int fd = -1;
  bool was_open = false;
  std::int64_t searched_ns = 0;
  CanTap* tap = nullptr;
  Stats stats;

  Inbox inbox;
  std::array<Time, batch> stamps{};
  std::int64_t drained_ns = 0;  // when the receive queue was last found empty: what comes later was received later
  std::uint32_t overflow_seen = 0;

  std::array<mmsghdr, batch> outbox{};
  std::array<iovec, batch> outbox_vectors{};
  std::array<can_frame, batch> outbox_frames{};
  std::array<Waiting, queue> waiting{};
  std::size_t first_waiting = 0, waiting_count = 0;
  std::int64_t emptied_ns = 0;  // when the kernel's queue was last found empty
  bool dropped = false;         // since the last answer
  bool down = false;            // as the last call found it
};

PortStatus SocketCan::State::configure() {
  std::vector<can_filter> filters;
  for (const CanFilter& filter : config.filters) filters.push_back({filter.id, filter.mask});
  int error = 0;
  if (!filters.empty()) error = calls.set_option(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), filters.size() * sizeof(can_filter));
  if (error < 0) return -error;
  const can_err_mask_t errors = config.error_frames ? CAN_ERR_MASK : 0;
  error = calls.set_option(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors);
  if (error < 0) return -error;
  const int on = 1;
  // Without these three it still works: stamps are taken here, overflows go unseen, the queue is the default one.
  (void)calls.set_option(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  (void)calls.set_option(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  const int off = 0;
  (void)calls.set_option(fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &off, sizeof off);
  (void)calls.set_option(fd, SOL_SOCKET, SO_SNDBUF, &config.send_buffer_bytes, sizeof config.send_buffer_bytes);
  const int bytes = config.receive_buffer_bytes;
  if (calls.set_option(fd, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) < 0)
    (void)calls.set_option(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  return port_ok;
}

PortStatus SocketCan::State::open() {
  close();
  searched_ns = calls.monotonic_ns();
  fd = calls.socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK, CAN_RAW);
  if (fd < 0) {
    const int error = -fd;
    fd = -1;
    return error;
  }
  const auto refuse = [this](int error) {
    close();
    return is_gone(error) ? ENODEV : error;
  };
  ifreq request{};
  if (config.interface.empty() || config.interface.size() >= sizeof request.ifr_name) return refuse(ENODEV);
  std::copy(config.interface.begin(), config.interface.end(), request.ifr_name);
  if (const int error = calls.ioctl(fd, SIOCGIFINDEX, &request); error < 0) return refuse(-error);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (const PortStatus error = configure(); error != port_ok) return refuse(error);
  if (const int error = calls.bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address); error < 0) return refuse(-error);
  drained_ns = emptied_ns = calls.monotonic_ns();
  overflow_seen = 0;
  inbox.count = inbox.next = 0;
  waiting_count = 0;
  if (was_open) ++stats.reopened;
  was_open = true;
  down = calls.ioctl(fd, SIOCGIFFLAGS, &request) >= 0 && (request.ifr_flags & IFF_UP) == 0;
  return down ? ENETDOWN : port_ok;
}

PortStatus SocketCan::State::look_for_it() {
  if (!was_open || calls.monotonic_ns() - searched_ns < search_ns) return ENODEV;
  const PortStatus status = open();
  return fd >= 0 ? status : ENODEV;
}

// An interface that went away takes the socket with it; one that is down keeps it.
PortStatus SocketCan::State::fail(int error) {
  stats.refused += waiting_count;
  waiting_count = 0;
  // The kernel tells whoever asks first, sender or receiver, that it went down.
  if (error == ENETDOWN && !std::exchange(down, true)) ++stats.downs;
  if (is_gone(error)) {
    ++stats.losses;
    searched_ns = calls.monotonic_ns();
    close();
    return ENODEV;
  }
  return error;
}

void SocketCan::State::read_control(const msghdr& header, std::int64_t realtime_ns, std::int64_t monotonic_ns, Time& stamp) {
  std::int64_t age_ns = -1;
  for (cmsghdr* control = CMSG_FIRSTHDR(&header); control != nullptr; control = CMSG_NXTHDR(const_cast<msghdr*>(&header), control)) {
    if (control->cmsg_level != SOL_SOCKET) continue;
    if (control->cmsg_type == SCM_TIMESTAMPNS) {
      timespec received{};
      std::memcpy(&received, CMSG_DATA(control), sizeof received);
      age_ns = realtime_ns - (received.tv_sec * std::int64_t{1'000'000'000} + received.tv_nsec);
    } else if (control->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t lost = 0;
      std::memcpy(&lost, CMSG_DATA(control), sizeof lost);
      stats.overflowed += lost - overflow_seen;  // the kernel's counter wraps as ours does
      overflow_seen = lost;
    }
  }
  // Stamps are wall-clock time. A frame is younger than the moment the queue was last empty: what says otherwise was spoilt by a jump of that clock.
  const bool valid = age_ns >= 0 && monotonic_ns - age_ns >= drained_ns;
  if (!valid) ++stats.stamps_missed;
  stamp = Time::from_ns(valid ? monotonic_ns - age_ns : monotonic_ns);
}

PortStatus SocketCan::State::fill() {
  inbox.count = inbox.next = 0;
  for (unsigned i = 0; i < batch; ++i) {
    msghdr& header = inbox.messages[i].msg_hdr;
    header = {};
    header.msg_iov = &inbox.vectors[i];
    header.msg_iovlen = 1;
    header.msg_control = inbox.controls[i].bytes.data();
    header.msg_controllen = inbox.controls[i].bytes.size();
  }
  const std::int64_t before_ns = calls.monotonic_ns();
  const int count = calls.receive_many(fd, inbox.messages.data(), batch);
  if (count == -EAGAIN || count == -EINTR || count == 0) {
    drained_ns = before_ns;
    return port_empty;
  }
  if (count < 0) return fail(-count);
  down = false;
  const std::int64_t realtime_ns = calls.realtime_ns(), monotonic_ns = calls.monotonic_ns();
  inbox.count = static_cast<unsigned>(count);
  for (unsigned i = 0; i < inbox.count; ++i) read_control(inbox.messages[i].msg_hdr, realtime_ns, monotonic_ns, stamps[i]);
  if (inbox.count < batch) drained_ns = before_ns;
  return port_ok;
}

void SocketCan::State::expire(std::int64_t now_ns) {
  while (waiting_count > 0 && waiting[first_waiting].deadline_ns < now_ns) {
    first_waiting = (first_waiting + 1) % queue;
    --waiting_count;
    ++stats.expired;
    dropped = true;
  }
}

PortStatus SocketCan::State::drops() { return std::exchange(dropped, false) ? ENOBUFS : port_ok; }

// The kernel counts what a socket has in its queues (SO_MEMINFO). One that cannot say so is taken to be empty.
bool SocketCan::State::stuck(std::int64_t now_ns) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> bytes{};
  const bool told = calls.get_option(fd, SOL_SOCKET, SO_MEMINFO, bytes.data(), sizeof bytes) >= 0;
  if (!told || bytes[SK_MEMINFO_WMEM_ALLOC] == 0) emptied_ns = now_ns;
  return now_ns - emptied_ns > config.transmit_deadline.ns();
}

PortStatus SocketCan::State::flush() {
  const std::int64_t now_ns = calls.monotonic_ns();
  expire(now_ns);
  if (waiting_count > 0 && stuck(now_ns)) {
    ++stats.stuck;
    return drops();
  }
  while (waiting_count > 0) {
    const auto count = static_cast<unsigned>(std::min<std::size_t>(waiting_count, batch));
    for (unsigned i = 0; i < count; ++i) outbox_frames[i] = raw_of(waiting[(first_waiting + i) % queue].frame);
    const int sent = calls.send_many(fd, outbox.data(), count);
    if (sent == -ENOBUFS || sent == -EAGAIN || sent == -EINTR) {
      ++stats.full;
      break;
    }
    if (sent < 0) return fail(-sent);
    down = false;
    for (int i = 0; i < sent; ++i) {
      if (tap != nullptr) tap->on_frame(waiting[first_waiting].frame, Time::from_ns(now_ns), true);
      first_waiting = (first_waiting + 1) % queue;
      --waiting_count;
    }
    stats.sent += static_cast<unsigned>(sent);
  }
  return drops();
}

SocketCan::SocketCan(const Config& config, LinuxCalls& calls) : state_(std::make_unique<State>(config, calls)) {}
SocketCan::~SocketCan() = default;
SocketCan::SocketCan(SocketCan&&) noexcept = default;
SocketCan& SocketCan::operator=(SocketCan&&) noexcept = default;

PortStatus SocketCan::open() { return state_->open(); }
bool SocketCan::is_open() const { return state_->fd >= 0; }
int SocketCan::fd() const { return state_->fd; }
std::size_t SocketCan::waiting() const { return state_->waiting_count; }
void SocketCan::set_tap(CanTap* tap) { state_->tap = tap; }
const SocketCan::Stats& SocketCan::stats() const { return state_->stats; }
const std::string& SocketCan::interface() const { return state_->config.interface; }

std::string SocketCan::explain(PortStatus error, const std::string& interface) {
  switch (error) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT: return "this kernel has no CAN: load the modules with `modprobe can-raw`";
    case ENODEV:
      return "there is no interface " + interface + ": `ip link` lists them; a virtual one is made by `ip link add " + interface +
             " type vcan`";
    case ENETDOWN:
      return interface + " is down: `ip link set " + interface + " up`, a real one with `type can bitrate " +
             std::to_string(can_map::bitrate) + "`";
    case EPERM:
    case EACCES: return "no permission to open " + interface;
    case ENOBUFS: return interface + ": frames were not sent in time, its queue was full (`ip -s link show " + interface + "`)";
    default: return interface + ": " + std::strerror(error);
  }
}

PortStatus SocketCan::receive(ReceivedFrame& received) {
  State& own = *state_;
  for (;;) {
    if (own.inbox.next >= own.inbox.count) {
      if (own.fd < 0) {
        if (const PortStatus status = own.look_for_it(); status != port_ok) return status;
      }
      // A batch that was not full left the queue empty: the next look is worth a call only in the next turn, and tells of an interface that went down.
      if (const PortStatus status = own.fill(); status != port_ok) return status;
    }
    const unsigned i = own.inbox.next++;
    const bool complete = own.inbox.messages[i].msg_len == sizeof(can_frame) && own.inbox.frames[i].len <= 8;
    if (!complete) {
      ++own.stats.malformed;
      continue;
    }
    received.frame = frame_of(own.inbox.frames[i]);
    received.t = own.stamps[i];
    const bool error_frame = (received.frame.id & CanFrame::error_flag) != 0;
    if (error_frame) {
      own.stats.errors.add(received.frame);
    } else {
      ++own.stats.received;
    }
    if (own.tap != nullptr) own.tap->on_frame(received.frame, received.t, false);
    return port_ok;
  }
}

PortStatus SocketCan::send(std::span<const CanFrame> frames) {
  State& own = *state_;
  if (own.fd < 0) {
    own.stats.refused += frames.size();
    return ENODEV;
  }
  const std::int64_t deadline_ns = own.calls.monotonic_ns() + own.config.transmit_deadline.ns();
  for (const CanFrame& frame : frames) {
    if (own.waiting_count == queue) {
      ++own.stats.refused;
      own.dropped = true;
      continue;
    }
    own.waiting[(own.first_waiting + own.waiting_count++) % queue] = {frame, deadline_ns};
  }
  return own.flush();
}

PortStatus SocketCan::flush() { return state_->fd < 0 ? ENODEV : state_->flush(); }

bool SocketCan::wait_readable(Time until) {
  State& own = *state_;
  if (own.inbox.next < own.inbox.count) return true;
  const std::int64_t left_ns = std::max<std::int64_t>(0, until.ns() - own.calls.monotonic_ns());
  // Without a socket poll() only waits, as it does with a negative descriptor.
  return own.calls.poll(own.fd, POLLIN, left_ns) != 0;
}

}  // namespace lf::hal
