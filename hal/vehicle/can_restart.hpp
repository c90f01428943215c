// The explicit restart of a CAN controller that went bus-off.
#pragma once

#include <string>

namespace lf::hal {

// What `ip link set INTERFACE type can restart` does: a netlink request (linux/can/netlink.h, IFLA_CAN_RESTART). Needs CAP_NET_ADMIN.
// 0, or errno: EPERM, ENODEV, EBUSY (it is not bus-off), EOPNOTSUPP (a virtual interface has no controller). Waits for the kernel's answer,
// a second at most: not for the control thread.
int restart_can(const std::string& interface);

}  // namespace lf::hal
