// The CAN interface: is it there, up, at the right bit rate, with a short queue, and does its controller take part in the bus.
#include <linux/can.h>
#include <linux/can/netlink.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "hal/vehicle/doctor/can_link.hpp"
#include "hal/vehicle/doctor/examination.hpp"
#include "shared/can/can_map.hpp"

namespace lf::hal::doctor {

namespace {

constexpr const char* key = "can.interface";
// Two ticks' frames; more of them delay a quick stop.
constexpr std::uint32_t longest_queue = 64;

void examine_sockets(const Machine& machine, Examinations& found) {
  const int fd = machine.calls->socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (fd >= 0) {
    machine.calls->close(fd);
    found.push_back({"CAN sockets", "can", Grade::good, "the kernel has them", ""});
  } else {
    found.push_back({"CAN sockets", "can", Grade::bad, std::string("this kernel gives no CAN socket: ") + std::strerror(-fd),
                     "`modprobe can_raw`, or a kernel with CONFIG_CAN"});
  }
}

std::string bring_up(const std::string& name, bool real) {
  return "`ip link set " + name + " up" + (real ? " type can bitrate " + std::to_string(can_map::bitrate) + " restart-ms 0`" : "`");
}

void examine_rate(const std::string& name, const CanLink& link, Examinations& found) {
  if (!link.bit_rate) {
    const bool real = link.kind == "can";
    found.push_back(
        {"bit rate", key, real ? Grade::bad : Grade::good,
         real ? name + " has none" : name + " has none: it is " + (link.kind.empty() ? "of a driver that says none" : link.kind),
         real ? bring_up(name, true) : ""});
    return;
  }
  char text[96];
  std::snprintf(text, sizeof text, "%u bit/s, sampled at %.1f %% of a bit", *link.bit_rate, 1e2 * link.sample_point);
  const bool good = *link.bit_rate == can_map::bitrate;
  found.push_back({"bit rate", key, good ? Grade::good : Grade::bad,
                   good ? text : text + std::string("; the drives have ") + std::to_string(can_map::bitrate) + " bit/s",
                   good ? "" : "`ip link set " + name + " down`, then " + bring_up(name, true)});
}

void examine_queue(const std::string& name, const CanLink& link, Examinations& found) {
  const std::string frames = name + " queues " + std::to_string(link.queue) + " frames";
  // A virtual one is delivered at once.
  if (link.kind != "can" || link.queue <= longest_queue) return found.push_back({"transmit queue", key, Grade::good, frames, ""});
  found.push_back({"transmit queue", key, Grade::bad, frames + ": old set points reach the drives before a quick stop",
                   "`ip link set " + name + " txqueuelen 32`"});
}

void examine_controller(const std::string& name, const CanLink& link, Examinations& found) {
  if (link.restart_ms && *link.restart_ms > 0)
    found.push_back({"restart", key, Grade::bad,
                     name + " comes back by itself " + std::to_string(*link.restart_ms) + " ms after bus-off: nobody hears of it",
                     "`ip link set " + name + " down`, then " + bring_up(name, true)});
  if (!link.state || !link.up) return;
  switch (*link.state) {
    case CAN_STATE_ERROR_ACTIVE: return found.push_back({"controller", key, Grade::good, "error active: it takes part in the bus", ""});
    case CAN_STATE_ERROR_WARNING:
    case CAN_STATE_ERROR_PASSIVE:
      return found.push_back({"controller", key, Grade::note, "its error counters are high: frames are not acknowledged, or disturbed",
                              "look at the drives' power, the bit rate, the two terminations, the cable"});
    case CAN_STATE_BUS_OFF:
      return found.push_back({"controller", key, Grade::bad, "bus-off: it takes no part in the bus",
                              "`lanternfishd restart-bus`, or `ip link set " + name + " type can restart`, once the cable is right"});
    default: return found.push_back({"controller", key, Grade::bad, "it is stopped or asleep", bring_up(name, true)});
  }
}

}  // namespace

void examine_bus(const VehicleConfig& config, const Machine& machine, Examinations& found) {
  examine_sockets(machine, found);
  const std::string& name = config.interface;
  const CanLink link = read_can_link(name, *machine.calls);
  const auto refuse = [&](const std::string& problem, const std::string& remedy) {
    found.push_back({"interface", key, Grade::bad, problem, remedy});
  };
  if (link.error == ENODEV)
    return refuse("there is no interface " + name,
                  "`ip link` lists them; the service's is in a network namespace: `ip netns exec lanternfish lanternfishd ...`");
  if (link.error != 0)
    return refuse(name + ": the kernel does not describe it: " + std::strerror(link.error), "run it as the service does");
  if (!link.is_can) return refuse(name + " is no CAN interface", "`ip -details link show type can` lists those");
  const bool real = link.kind == "can";
  if (link.up) {
    found.push_back({"interface", key, Grade::good, name + " is up, " + (link.kind.empty() ? "a CAN interface" : "kind " + link.kind), ""});
  } else {
    refuse(name + " is down", bring_up(name, real));
  }
  examine_rate(name, link, found);
  examine_queue(name, link, found);
  examine_controller(name, link, found);
}

}  // namespace lf::hal::doctor
