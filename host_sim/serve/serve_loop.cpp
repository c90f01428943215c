#include "host_sim/serve/serve_loop.hpp"

#include <cstring>

#include "shared/arm/make_model.hpp"

namespace lf::serve {

ServeLoop::ServeLoop(const hal::SimConfig& config, const NodeSet& served, CanLink& link, LoopCamera* camera, Say say,
                     const PerJoint<std::int32_t>& real_zero_counts)
    : joints_(config.world.arm.names()),
      world_(config.world),
      rack_(config.devices, Time{}),
      link_(link),
      bus_(rack_, link, served, make_model(config.world.arm), real_zero_counts),
      camera_(camera),
      say_(std::move(say)),
      pace_(link.now()) {}

void ServeLoop::turn() {
  while (link_.wait(pace_.due())) {
    if (!bus_.receive(pace_)) {
      link_.sleep(pace_.due());
      break;
    }
    if (link_.now() >= pace_.due()) break;  // a flooded bus does not stop the world
  }
  const Time t = pace_.begin(link_.now());
  world_.set_drives(bus_.drives(world_.readings()));
  world_.step();
  bus_.step(t, world_.readings());
  while (const std::optional<devices::Exposure> exposure = bus_.take_exposure()) {
    if (camera_ != nullptr) camera_->expose(*exposure);
  }
  if (camera_ != nullptr) camera_->step(t, bus_.outputs(), world_.base_from_body(), pace_);
  if (const std::optional<std::string> report = pace_.second_report(link_.now()); report && say_) say_(*report);
  say_link_changes();
}

void ServeLoop::say_link_changes() {
  const int error = bus_.link_error();
  if (error == said_error_) return;
  said_error_ = error;
  if (!say_) return;
  say_(error == hal::port_ok ? "the bus is back" : std::string("the bus: ") + std::strerror(error));
}

}  // namespace lf::serve
