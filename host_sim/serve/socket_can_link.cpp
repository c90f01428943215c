#include "host_sim/serve/socket_can_link.hpp"

#include <time.h>

#include <cerrno>
#include <stdexcept>

namespace lf::serve {

namespace {

hal::SocketCan::Config config_for(const std::string& interface) {
  hal::SocketCan::Config config;
  config.interface = interface;
  // A real controller tries until it is told otherwise; five SYNC periods outlast a burst, and an older answer helps nobody.
  config.transmit_deadline = Duration::from_ms(20);
  return config;
}

}  // namespace

SocketCanLink::SocketCanLink(const std::string& interface) : can_(config_for(interface)) {
  const hal::PortStatus status = can_.open();
  if (status != hal::port_ok && status != ENETDOWN) throw std::runtime_error(hal::SocketCan::explain(status, interface));
}

Time SocketCanLink::now() { return Time::from_ns(hal::linux_calls().monotonic_ns()); }

void SocketCanLink::sleep(Time until) {
  const timespec t{until.ns() / 1'000'000'000, until.ns() % 1'000'000'000};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
}

}  // namespace lf::serve
