// A remote node's link: its NMT state by heartbeat, its SDO client, its boot, and what went wrong with it.
#pragma once

#include <cstdint>

#include "firmware/canopen/boot_sequence.hpp"
#include "firmware/canopen/emcy.hpp"
#include "firmware/canopen/sdo_client.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::canopen {

enum class NmtState : std::uint8_t { boot_up = 0, stopped = 4, operational = 5, pre_operational = 127, unknown = 255 };

struct NodeFault {
  bool heartbeat_lost = false;    // none for the consumer time-out, or no answer to guard requests
  bool rebooted = false;          // boot-up message in operation: the node forgot its configuration
  bool left_operational = false;  // a heartbeat says stopped or pre-operational
  std::uint16_t emcy_code = 0;    // last EMCY other than 0x0000; stays after the node withdrew it, see `emcy_active`
  std::uint8_t error_register = 0;
  bool emcy_active = false;  // not withdrawn by an EMCY 0x0000

  bool link() const { return heartbeat_lost || rebooted || left_operational; }
  bool any() const { return link() || emcy_code != 0; }
};

class Node {
 public:
  Node() = default;
  Node(std::uint8_t id, const NetworkConfig& config);

  std::uint8_t id() const { return id_; }
  NmtState nmt() const { return nmt_; }
  const NodeFault& fault() const { return fault_; }
  Time operational_at() const { return operational_at_; }  // by its newest heartbeat that said so
  void acknowledge() { fault_ = NodeFault{}; }
  SdoClient& sdo() { return sdo_; }
  const SdoClient& sdo() const { return sdo_; }
  BootSequence& boot() { return boot_; }
  const BootSequence& boot() const { return boot_; }
  bool started() const { return boot_.started() && !fault_.rebooted; }  // its process data count

  void start_boot(Time now, const BootContext& context);
  // The guard request that is due, if the node is guarded: a remote frame that the node answers with its state, and by which it knows that the master lives.
  bool take_guard_request(Time now, CanFrame& frame);
  // The node restarted, or may have: what it keeps without power is not known. True once.
  bool take_restart();
  // NMT reset node is on its way to it: the next boot-up that no reset of the boot has caused is the answer.
  void expect_restart(bool proves);  // `proves`: the boot-up that follows can only be this one's
  // It has answered `expect_restart`, and nobody has started it since: it has no power.
  bool restarted_as_told() const { return restarted_as_told_; }
  // Another master spoke, and may have started it.
  void doubt_restart(bool by_nmt) {
    restarted_as_told_ = false;
    restart_expected_ = restart_expected_ && !by_nmt;
  }
  // A heartbeat, or a guarded node's answer, whose bit 7 alternates. False when `state` is not one of CiA 301's.
  bool on_heartbeat(std::uint8_t state, Time now);
  void on_emcy(const Emcy& emcy);
  void on_process_data() { boot_.on_process_data(); }
  // Watches the heartbeat and drives the boot. Once a SYNC.
  void step(Time now, const BootContext& context);

 private:
  std::uint8_t id_ = 0;
  NmtState nmt_ = NmtState::unknown;
  bool guarded_ = false;
  bool guarding_ = false;  // from its start on
  bool restarted_ = false;
  bool restart_expected_ = false;
  bool restarted_as_told_ = false;
  Time next_guard_;
  Time last_heartbeat_;
  Time operational_at_;
  NodeFault fault_;
  SdoClient sdo_;
  BootSequence boot_;
};

}  // namespace lf::canopen
