// The front door of the CAN bus: the master of the joints' CiA 402 drives and of one CiA 401 output node.
//
// Feed it every frame that arrives and call `tick` once a SYNC period; it answers with the frames to send, in the order to send them: SYNC, RPDOs,
// master heartbeat, NMT, SDO. Nothing blocks, allocates or reads a clock. A frame that is not understood is refused and counted by its cause.
//
//   Network network(config);
//   network.start_boot(now);
//   every 4 ms:  for (frames that arrived) network.on_frame(frame, time_of_arrival);
//                decide: network.axis(2).set_target_counts(...), network.io().trigger_camera(...)
//                outbox.clear(); network.tick(now, outbox); send(outbox)
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/canopen/axis.hpp"
#include "firmware/canopen/boot_report.hpp"
#include "firmware/canopen/emcy.hpp"
#include "firmware/canopen/foreign_frames.hpp"
#include "firmware/canopen/io_module.hpp"
#include "firmware/canopen/node.hpp"
#include "firmware/canopen/setup.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf::canopen {

// A tick sends at most SYNC, heartbeat, and for each node an RPDO, a guard request, NMT, an SDO abort and an SDO request: 52 of ten nodes.
using Outbox = StaticVector<CanFrame, 64>;

// Why a frame was refused.
enum class Refusal : std::uint8_t {
  error_frame,     // made by the CAN controller: the platform's business
  not_classic,     // extended or remote
  bad_length,      // over 8 bytes, or an EMCY, SDO or heartbeat of the wrong length
  unknown_node,    // a node that is not configured
  unknown_id,      // no message of the predefined connection set
  foreign_master,  // NMT, SYNC, RPDO, SDO request or heartbeat in the master's name from somebody else
  pdo_too_short,
  pdo_too_long,
  pdo_unmapped,      // TPDO 2, 3 or 4: disabled at boot
  pdo_before_start,  // from a node that was not started
  sdo_refused,       // unexpected or about another object; SdoClient::Stats has more
  heartbeat_state,   // none of boot-up, stopped, operational, pre-operational
};
inline constexpr std::size_t refusal_count = 12;
const char* name(Refusal refusal);

// Counted from construction on, never reset.
struct NetworkStats {
  std::uint64_t frames_in = 0;
  std::uint64_t frames_out = 0;
  std::uint64_t bits_on_bus = 0;  // of all of them but error frames, exactly: stuffing and interframe space included
  std::array<std::uint32_t, refusal_count> refused{};
  std::uint32_t outbox_overflows = 0;  // frames that found no room
  std::uint32_t syncs = 0;
  std::uint32_t emcys = 0;
  std::uint32_t emcys_forgotten = 0;  // overwritten before `take_emcy`
  std::uint32_t pdo_repeated = 0;     // second TPDO of a node in one SYNC cycle: taken, the last one counts
  std::uint32_t time_backwards = 0;   // before the last SYNC: a tick is ignored, a frame is taken as of that SYNC

  std::uint32_t refused_total() const {
    std::uint32_t total = 0;
    for (const std::uint32_t n : refused) total += n;
    return total;
  }
};

// What a network remembers.
class NetworkState {
 protected:
  explicit NetworkState(const NetworkConfig& config) : config_(config), io_(config) {}

  NetworkConfig config_;
  StaticVector<Node, capacity::nodes> nodes_;
  StaticVector<Axis, capacity::joints> axes_;
  IoModule io_;
  BootState boot_ = BootState::idle;
  bool running_ = false;  // SYNC and heartbeat are produced
  bool nodes_started_ = false;
  bool boot_up_sent_ = false;
  bool bus_off_ = false;
  ForeignFrames foreign_;
  std::optional<Time> foreign_nmt_;
  std::optional<std::size_t> misconfigured_node_;  // what `check` found
  std::uint8_t shut_down_syncs_ = 0;               // left until NMT stop; 0: not shutting down
  std::array<std::optional<NmtCommand>, capacity::nodes> nmt_due_{};
  Time last_sync_;
  Time next_heartbeat_;
  static constexpr std::size_t emcy_history = 16;  // a drive sends one or two at a fault: those of eight nodes fit
  std::array<Emcy, emcy_history> emcys_{};
  std::size_t emcy_first_ = 0, emcy_count_ = 0;
  NetworkStats stats_;
};

class Network : NetworkState {
 public:
  // Nodes are indexed as the joints, then the output node.
  std::size_t drive_count() const { return axes_.size(); }
  std::size_t node_count() const { return nodes_.size(); }
  std::size_t io_index() const { return axes_.size(); }

  explicit Network(const NetworkConfig& config);
  Network(const Network& other);
  Network& operator=(const Network&) = delete;

  // Resets and configures every node, all at once, and starts them when all are configured. Call again to boot anew after a failure or a reboot:
  // every axis goes offline, disabled and without latched faults. An invalid configuration fails at once.
  void start_boot(Time now);
  void on_frame(const CanFrame& frame, Time now);
  void tick(Time now, Outbox& outbox);

  BootReport boot() const;
  // Booted, and every node answers, is operational and has no unacknowledged fault of its link (`NodeFault`, not the drives' own faults).
  bool operational() const;

  // Every joint has a known zero, or a drive that finds it.
  bool may_have_power() const;
  Axis& axis(std::size_t joint) { return axes_[joint]; }
  const Axis& axis(std::size_t joint) const { return axes_[joint]; }
  IoModule& io() { return io_; }
  const IoModule& io() const { return io_; }

  // What is wrong with a node's link, latched until acknowledged. Acknowledging does not repair: a node that rebooted needs `start_boot`.
  const NodeFault& fault(std::size_t node) const { return nodes_[node].fault(); }
  bool any_fault() const;
  // When a heartbeat said last that the node is operational.
  Time operational_at(std::size_t node) const { return nodes_[node].operational_at(); }
  void acknowledge(std::size_t node) { nodes_[node].acknowledge(); }
  // EMCY messages in the order of their arrival, the last 16.
  std::optional<Emcy> take_emcy();

  void quick_stop_all();  // every axis; the laser and the lamps are the caller's
  void disable_all();     // power off, each drive on its way down through every state
  void remove_power();    // disable voltage for every axis, at once
  // NMT stop of one node with the next tick, for a drive that does not heed its process data: 6007 makes it a quick stop. Only `start_boot` leads back.
  void stop_node(std::size_t node) { nmt_due_[node] = NmtCommand::stop; }
  // NMT reset node, also before the first boot: whatever its make, a drive restarts without power.
  void reset_node(std::size_t node, Time now);
  static constexpr Duration longest_restart = Duration::from_ms(1000);  // from NMT to the boot-up; an assumption: makers do not say
  // It said so since `reset_node`, and neither this master nor another one has started it after that. Where another master has sent NMT, a boot-up may be its doing:
  // a node that resets its communication hears nothing meanwhile, and its drive may keep its power.
  bool restarted_as_told(std::size_t node) const { return nodes_[node].restarted_as_told(); }
  // Another master was heard, and this one never took the bus.
  bool bus_is_anothers() const { return !running_ && foreign_frames() > 0; }
  // Power and outputs off, and NMT stop of every node four SYNC periods later, when the drives have heard of it. Only `start_boot` leads back.
  void shut_down();

  // Frames that only this master may send and somebody else sent, by their identifiers. The core never receives what it sent itself.
  const ForeignFrames& foreign() const { return foreign_; }
  // Another master sent an NMT command within the last `window`.
  bool foreign_nmt_since(Time now, Duration window) const { return foreign_nmt_ && now - *foreign_nmt_ < window; }
  std::uint32_t foreign_frames() const { return stats_.refused[static_cast<std::size_t>(Refusal::foreign_master)]; }
  // The CAN controller said in an error frame that it is off the bus, and neither that it restarted nor any other frame came since.
  bool bus_off() const { return bus_off_; }
  Time last_sync() const { return last_sync_; }
  const NetworkStats& stats() const { return stats_; }
  const SdoClient& sdo(std::size_t node) const { return nodes_[node].sdo(); }
  const NetworkConfig& config() const { return config_; }

 private:
  void refuse(Refusal cause) { ++stats_.refused[static_cast<std::size_t>(cause)]; }
  std::optional<std::size_t> index_of(std::uint8_t node) const;
  BootContext context(std::size_t node) const;
  void on_error_frame(const CanFrame& frame);
  void dispatch(const CanFrame& frame, Time now);
  void refuse_foreign_master(std::uint32_t id);
  void on_tpdo(std::size_t node, const CanFrame& frame);
  void on_emcy(std::size_t node, const CanFrame& frame, Time now);
  void on_heartbeat(std::size_t node, const CanFrame& frame, Time now);
  void on_sdo(std::size_t node, const CanFrame& frame, Time now);
  void step_boot(Time now);
  void start_configured(Time now);
  void give_up_boot();
  void go_offline();
  void stop_nodes();
  void step_axes(Time now);
  void send(Outbox& outbox, const CanFrame& frame);
  void send_process_data(Outbox& outbox);
  void send_heartbeat(Time now, Outbox& outbox);
  void send_guard_requests(Time now, Outbox& outbox);
  void send_nmt(Outbox& outbox);
  void send_sdo(Time now, Outbox& outbox);
};

}  // namespace lf::canopen
