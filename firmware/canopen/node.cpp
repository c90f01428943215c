#include "firmware/canopen/node.hpp"

#include <utility>

#include "firmware/canopen/cob_id.hpp"
#include "firmware/canopen/codec.hpp"

namespace lf::canopen {

Node::Node(std::uint8_t id, const NetworkConfig& config) : id_(id), sdo_(id, config.sdo_timeout), boot_(config) {}

void Node::start_boot(Time now, const BootContext& context) {
  fault_ = NodeFault{};
  nmt_ = NmtState::unknown;
  guarded_ = context.drive != nullptr && context.drive->profile.guarded;
  guarding_ = false;
  restart_expected_ = false;
  restarted_as_told_ = false;
  sdo_.reset();
  boot_.begin(context, now);
}

bool Node::on_heartbeat(std::uint8_t state, Time now) {
  constexpr std::uint8_t toggle = 0x80;
  const auto nmt = static_cast<NmtState>(guarded_ ? state & ~toggle : state);
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
    if (!boot_.on_boot_up(now, sdo_)) {
      restarted_ = true;
      restarted_as_told_ = restarted_as_told_ || std::exchange(restart_expected_, false);
    }
  }
  if (nmt == NmtState::operational) {
    operational_at_ = now;
    boot_.on_operational(now);
  }
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
    restarted_ = true;  // a node without power is as silent as one behind a cut cable
    nmt_ = NmtState::unknown;
  }
}

bool Node::take_guard_request(Time now, CanFrame& frame) {
  if (!guarded_) return false;
  if (!guarding_) next_guard_ = now;
  guarding_ = guarding_ || boot_.started();
  if (!guarding_ || now < next_guard_) return false;
  next_guard_ = now + can_map::master_heartbeat;
  frame = empty_frame(cob_id::heartbeat + id_, 1);
  frame.id |= CanFrame::remote_flag;
  return true;
}

void Node::expect_restart(bool proves) {
  restart_expected_ = proves;
  restarted_as_told_ = false;
}

bool Node::take_restart() { return std::exchange(restarted_, false); }

}  // namespace lf::canopen
