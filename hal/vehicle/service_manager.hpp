// systemd's notification protocol (sd_notify(3)): a datagram of assignments to the socket in NOTIFY_SOCKET. Nothing happens without one.
#pragma once

#include <optional>
#include <string>

#include "shared/messages/time.hpp"

namespace lf::hal {

// "READY=1", "STATUS=...", "WATCHDOG=1", "STOPPING=1"; several are joined by newlines. False when there was a socket and it did not take it.
bool notify_service_manager(const std::string& assignments);

// Half of the time within which the manager wants "WATCHDOG=1", where it wants it of this process (WATCHDOG_USEC, WATCHDOG_PID).
std::optional<Duration> watchdog_interval();

}  // namespace lf::hal
