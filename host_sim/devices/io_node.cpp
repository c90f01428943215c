#include "host_sim/devices/io_node.hpp"

#include "host_sim/devices/canopen/communication_objects.hpp"
#include "shared/can/can_map.hpp"

namespace lf::devices {
namespace {

std::int64_t no_figure(can_map::Figure) { return 0; }

}  // namespace

IoNode::IoNode(const IoConfig& config, Duration boot_time)
    : node_(config.node, node_objects(can_map::output_node_objects(), config.node, can_map::output_node_title(), no_figure), boot_time,
            *this),
      inputs_(node_.objects().at(0x6000, 1)),
      outputs_(node_.objects().at(0x6200, 1)),
      error_mode_(node_.objects().at(0x6206, 1)),
      error_value_(node_.objects().at(0x6207, 1)),
      trigger_(node_.objects().at(0x2100, 1)),
      exposure_us_(node_.objects().at(0x2100, 2)),
      outputs_shown_(node_.objects().at(0x2101, 1)),
      last_trigger_(node_.objects().at(0x2101, 2)),
      last_exposure_us_(node_.objects().at(0x2101, 3)) {}

void IoNode::tick(Time now) {
  inputs_.value = (estop_closed_ ? can_map::input_estop_closed : 0) | (interlock_closed_ ? can_map::input_interlock_closed : 0);
  node_.tick(now);
}

void IoNode::set_interlock_closed(bool closed) {
  interlock_closed_ = closed;
  switch_outputs();
}

void IoNode::switch_outputs() {
  on_ = 0;
  if (node_.state() == NmtState::operational) on_ = static_cast<std::uint8_t>(outputs_.value);
  if (node_.state() == NmtState::stopped) on_ = static_cast<std::uint8_t>(error_mode_.value & error_value_.value);
  if (!interlock_closed_) on_ &= static_cast<std::uint8_t>(~can_map::output_laser);
  outputs_shown_.value = on_;
}

void IoNode::written(const Object& object, Time now) {
  if (node_.state() == NmtState::operational && (object.index == 0x6200 || object.index == 0x2100)) received(now);
}

void IoNode::received(Time now) {
  switch_outputs();
  if (trigger_.value == last_trigger_.value) return;
  last_trigger_.value = trigger_.value;
  last_exposure_us_.value = exposure_us_.value;
  if (exposure_us_.value == 0) return;
  exposures_.push_back({now, Duration::from_us(exposure_us_.value), static_cast<std::uint8_t>(trigger_.value), laser_on(), lamps_on()});
}

void IoNode::state_changed(NmtState state, Time) {
  if (state != NmtState::operational) outputs_.value = 0;  // who starts the node again asks again
  switch_outputs();
}

void IoNode::restarted(Time) { switch_outputs(); }

bool IoNode::laser_on() const { return (on_ & can_map::output_laser) != 0; }
bool IoNode::lamps_on() const { return (on_ & can_map::output_lamps) != 0; }

std::optional<Exposure> IoNode::take_exposure() {
  if (exposures_.empty()) return std::nullopt;
  const Exposure oldest = exposures_.front();
  exposures_.erase(exposures_.begin());
  return oldest;
}

}  // namespace lf::devices
