#include "hal/vehicle/instance_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "hal/vehicle/tick_clock.hpp"
#include "shared/can/can_map.hpp"

namespace lf::hal {

namespace {

constexpr std::uint32_t sync_id = 0x080;
constexpr std::uint32_t master_heartbeat_id = 0x700U + can_map::master_node;

// Interfaces of two network namespaces may have one name and are two buses.
std::string namespace_number() {
  struct stat status {};
  return stat("/proc/self/ns/net", &status) == 0 ? std::to_string(status.st_ino) : "0";
}

std::string owner_of(int fd) {
  std::array<char, 32> text{};
  const ssize_t bytes = pread(fd, text.data(), text.size() - 1, 0);
  std::string owner(text.data(), bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
  while (!owner.empty() && owner.back() == '\n') owner.pop_back();
  return owner.empty() ? "" : " (process " + owner + ")";
}

std::string held_by(int fd, const std::string& path, const std::string& interface) {
  return "another lanternfishd" + owner_of(fd) + " is the master of " + interface + ", says " + path;
}

}  // namespace

std::string InstanceLock::file_of(const std::string& folder, const std::string& interface) {
  return folder + "/lanternfishd-" + interface + "-" + namespace_number() + ".lock";
}

InstanceLock::~InstanceLock() {
  if (fd_ >= 0) close(fd_);
}

std::string InstanceLock::take(const std::string& folder, const std::string& interface) {
  path_ = file_of(folder, interface);
  fd_ = open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (fd_ < 0 && errno == ENOENT) fd_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (fd_ < 0) return path_ + ": " + std::strerror(errno) + "; `lock_folder` names where lock files may be";
  if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    std::string held = held_by(fd_, path_, interface);
    close(fd_);
    fd_ = -1;
    return held;
  }
  const std::string own = std::to_string(getpid()) + "\n";
  // One that root has made, by hand, must not keep the service out afterwards.
  if (struct stat owner{}; geteuid() == 0 && stat(folder.c_str(), &owner) == 0) (void)!fchown(fd_, owner.st_uid, owner.st_gid);
  if (ftruncate(fd_, 0) != 0 || pwrite(fd_, own.data(), own.size(), 0) < 0) return path_ + ": " + std::strerror(errno);
  return "";
}

std::optional<std::string> locked_by_another(const std::string& folder, const std::string& interface) {
  const std::string path = InstanceLock::file_of(folder, interface);
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return std::nullopt;
  std::optional<std::string> held;
  if (flock(fd, LOCK_SH | LOCK_NB) != 0) held = held_by(fd, path, interface);
  close(fd);
  return held;
}

std::optional<std::string> hear_another_master(SocketCan& can, Duration how_long) {
  const Time end = monotonic_now() + how_long;
  while (monotonic_now() < end) {
    if (!can.wait_readable(end)) break;
    ReceivedFrame received;
    const PortStatus status = can.receive(received);
    if (status != port_ok) {
      if (status != port_empty) sleep_until(monotonic_now() + Duration::from_ms(10));  // down or gone: nobody to be heard
      continue;
    }
    if (received.frame.id > 0x7FF) continue;  // error frames, and what no CANopen node sends
    const std::uint32_t function = received.frame.id & 0x780U;
    const bool rpdo = function == 0x200 || function == 0x300 || function == 0x400 || function == 0x500;
    if (rpdo) return "another master sends set points (RPDOs)";
    if (function == 0x600) return "another master asks for objects (SDO)";
    if (received.frame.id == 0) return "another master sends NMT commands (0x000)";
    if (received.frame.id == sync_id) return "another master sends SYNC (0x080)";
    if (received.frame.id == master_heartbeat_id) return "another master sends its heartbeat (0x77F)";
  }
  return std::nullopt;
}

}  // namespace lf::hal
