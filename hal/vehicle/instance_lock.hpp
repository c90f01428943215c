// One master a bus: a lock file keyed by interface and network namespace, and an ear for masters that know nothing of it.
#pragma once

#include <optional>
#include <string>

#include "hal/vehicle/socket_can.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

class InstanceLock {
 public:
  InstanceLock() = default;
  ~InstanceLock();
  InstanceLock(const InstanceLock&) = delete;
  InstanceLock& operator=(const InstanceLock&) = delete;

  // The folder is one that only the daemon's user can write to, such as the service's RuntimeDirectory: elsewhere anybody could hold the lock.
  // Locks FOLDER/lanternfishd-INTERFACE-NAMESPACE.lock (flock(2): gone with the process, however it ends). An empty text when it is ours, else what is
  // in the way, with the other's process number where the file has it.
  std::string take(const std::string& folder, const std::string& interface);
  const std::string& path() const { return path_; }
  // Where that file is.
  static std::string file_of(const std::string& folder, const std::string& interface);

 private:
  int fd_ = -1;
  std::string path_;
};

// Who holds the lock that InstanceLock::take() would take, in its words. Nothing where nobody does, or where no lock file can be read: whoever is the
// master of the bus then has its lock in another folder.
std::optional<std::string> locked_by_another(const std::string& folder, const std::string& interface);

// Three heartbeats of a master, and many of its SYNCs.
inline constexpr Duration listen_for_a_master = Duration::from_ms(350);

// Listens for `how_long` to a bus that should be silent of masters. What gives another one away, in words: SYNC, NMT, its heartbeat, set points, SDO requests.
std::optional<std::string> hear_another_master(SocketCan& can, Duration how_long);

}  // namespace lf::hal
