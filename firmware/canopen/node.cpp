#include "firmware/canopen/node.hpp"

namespace lf::canopen {

Node::Node(std::uint8_t id, const NetworkConfig& config) : id_(id), sdo_(id, config.sdo_timeout), boot_(config) {}

void Node::start_boot(Time now, const BootContext& context) {
  fault_ = NodeFault{};
  nmt_ = NmtState::unknown;
  sdo_.reset();
  boot_.begin(context, now);
}

bool Node::on_heartbeat(std::uint8_t state, Time now) {
  const auto nmt = static_cast<NmtState>(state);
  const bool valid =
      nmt == NmtState::boot_up || nmt == NmtState::stopped || nmt == NmtState::operational || nmt == NmtState::pre_operational;
  if (!valid) return false;
  last_heartbeat_ = now;
  nmt_ = nmt;
  if (nmt == NmtState::boot_up) {
    if (boot_.done()) {
      fault_.rebooted = true;
      sdo_.reset();
    }
    boot_.on_boot_up(now, sdo_);
  }
  if (nmt == NmtState::operational) boot_.on_operational(now);
  if (boot_.done() && (nmt == NmtState::stopped || nmt == NmtState::pre_operational)) fault_.left_operational = true;
  return true;
}

void Node::on_emcy(const Emcy& emcy) {
  fault_.emcy_active = emcy.code != 0;
  fault_.error_register = emcy.error_register;
  if (emcy.code != 0) fault_.emcy_code = emcy.code;
}

void Node::step(Time now, const BootContext& context) {
  boot_.step(now, sdo_, context);
  const bool silent = boot_.done() && now - last_heartbeat_ > can_map::node_heartbeat_timeout;
  if (silent) {
    fault_.heartbeat_lost = true;
    nmt_ = NmtState::unknown;
  }
}

}  // namespace lf::canopen
