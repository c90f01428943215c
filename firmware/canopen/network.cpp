#include "firmware/canopen/network.hpp"

#include <algorithm>
#include <utility>

#include "firmware/canopen/bus_load.hpp"
#include "firmware/canopen/cob_id.hpp"
#include "firmware/canopen/codec.hpp"

namespace lf::canopen {

const char* name(Refusal refusal) {
  switch (refusal) {
    case Refusal::error_frame: return "error frame";
    case Refusal::not_classic: return "extended or remote frame";
    case Refusal::bad_length: return "wrong length";
    case Refusal::unknown_node: return "unknown node";
    case Refusal::unknown_id: return "unknown identifier";
    case Refusal::foreign_master: return "another master";
    case Refusal::pdo_too_short: return "PDO too short";
    case Refusal::pdo_too_long: return "PDO too long";
    case Refusal::pdo_unmapped: return "PDO that was disabled";
    case Refusal::pdo_before_start: return "PDO of a node not started";
    case Refusal::sdo_refused: return "SDO answer nobody waits for";
    case Refusal::heartbeat_state: return "heartbeat with an unknown state";
  }
  return "unknown";
}

Network::Network(const NetworkConfig& config) : NetworkState(config) {
  for (const DriveSetup& drive : config_.drives) {
    (void)nodes_.push_back(Node(drive.node, config));  // as many as the configuration has room for
    (void)axes_.push_back(Axis(drive, config));
  }
  (void)nodes_.push_back(Node(config.io.node, config));
}

// The axes of a copy have their set-ups in it.
Network::Network(const Network& other) : NetworkState(other) {
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].find_setup(config_.drives[i]);
}

BootContext Network::context(std::size_t node) const {
  return {&config_, node < drive_count() ? &config_.drives[node] : nullptr, nodes_[node].id(), 0};
}

void Network::start_boot(Time now) {
  std::size_t offender = 0;
  if (check(config_, offender) != ConfigError::none) {
    misconfigured_node_ = offender;
    boot_ = BootState::failed;
    return;
  }
  go_offline();
  nmt_due_ = {};
  shut_down_syncs_ = 0;
  nodes_started_ = false;
  running_ = true;
  boot_ = BootState::running;
  for (std::size_t i = 0; i < node_count(); ++i) nodes_[i].start_boot(now, context(i));
}

void Network::go_offline() {
  for (Axis& axis : axes_) axis.go_offline();
  io_.go_offline();
}

BootReport Network::boot() const {
  BootReport report;
  report.state = boot_;
  for (const Node& node : nodes_) (void)report.nodes.push_back(node.boot().report());
  if (misconfigured_node_) {
    NodeBoot& node = report.nodes[*misconfigured_node_];
    node.node = nodes_[*misconfigured_node_].id();
    node.state = BootState::failed;
    node.failure = BootFailure::configuration;
  }
  return report;
}

bool Network::operational() const {
  const auto works = [](const Node& node) { return !node.fault().link() && node.nmt() == NmtState::operational; };
  return boot_ == BootState::done && std::all_of(nodes_.begin(), nodes_.end(), works);
}

bool Network::may_have_power() const {
  return std::all_of(axes_.begin(), axes_.end(), [](const Axis& axis) { return axis.may_have_power(); });
}

bool Network::any_fault() const {
  return std::any_of(nodes_.begin(), nodes_.end(), [](const Node& node) { return node.fault().any(); });
}

std::optional<Emcy> Network::take_emcy() {
  if (emcy_count_ == 0) return std::nullopt;
  const Emcy emcy = emcys_[emcy_first_];
  emcy_first_ = (emcy_first_ + 1) % emcy_history;
  --emcy_count_;
  return emcy;
}

void Network::quick_stop_all() {
  for (Axis& axis : axes_) axis.request(AxisRequest::quick_stop);
}

void Network::disable_all() {
  for (Axis& axis : axes_) axis.request(AxisRequest::disable);
}

void Network::remove_power() {
  for (Axis& axis : axes_) axis.request(AxisRequest::remove_power);
}

void Network::reset_node(std::size_t node, Time now) {
  nmt_due_[node] = NmtCommand::reset_node;
  nodes_[node].expect_restart(!foreign_nmt_since(now, longest_restart));
}

void Network::shut_down() {
  if (!running_ || shut_down_syncs_ > 0) return;
  remove_power();
  io_.set_outputs(0);
  shut_down_syncs_ = Axis::handshake_syncs + 1;
}

std::optional<std::size_t> Network::index_of(std::uint8_t node) const {
  for (std::size_t i = 0; i < node_count(); ++i) {
    if (nodes_[i].id() == node) return i;
  }
  return std::nullopt;
}

// ---- frames in ----

void Network::on_frame(const CanFrame& frame, Time now) {
  ++stats_.frames_in;
  if (now < last_sync_) {
    ++stats_.time_backwards;
    now = last_sync_;
  }
  if ((frame.id & CanFrame::error_flag) != 0) return on_error_frame(frame);
  bus_off_ = false;
  if ((frame.id & (CanFrame::extended_flag | CanFrame::remote_flag)) != 0 || frame.id > 0x7FF) return refuse(Refusal::not_classic);
  if (frame.length > 8) return refuse(Refusal::bad_length);
  stats_.bits_on_bus += bus_load::exact_bits(frame);
  dispatch(frame, now);
}

// SocketCAN's classes (linux/can/error.h).
void Network::on_error_frame(const CanFrame& frame) {
  constexpr std::uint32_t is_off = 0x40, restarted = 0x100;
  if ((frame.id & is_off) != 0) bus_off_ = true;
  if ((frame.id & restarted) != 0) bus_off_ = false;
  refuse(Refusal::error_frame);
}

void Network::dispatch(const CanFrame& frame, Time now) {
  const std::uint8_t id = cob_id::node_of(frame.id);
  const std::uint32_t function = cob_id::function_of(frame.id);
  if (frame.id == cob_id::nmt) foreign_nmt_ = now;
  if (frame.id == cob_id::nmt || frame.id == cob_id::sync || frame.id == cob_id::heartbeat + can_map::master_node) {
    return refuse_foreign_master(frame.id);
  }
  const bool for_nodes = function == cob_id::rpdo1 || function == cob_id::rpdo2 || function == cob_id::rpdo3 || function == cob_id::rpdo4 ||
                         function == cob_id::sdo_request;
  if (for_nodes && id != 0) return refuse_foreign_master(frame.id);

  const bool from_nodes = function == cob_id::emcy || function == cob_id::tpdo1 || function == cob_id::tpdo2 || function == cob_id::tpdo3 ||
                          function == cob_id::tpdo4 || function == cob_id::sdo_answer || function == cob_id::heartbeat;
  if (!from_nodes || id == 0) return refuse(Refusal::unknown_id);
  const std::optional<std::size_t> node = index_of(id);
  if (!node) return refuse(Refusal::unknown_node);
  switch (function) {
    case cob_id::emcy: return on_emcy(*node, frame, now);
    case cob_id::tpdo1: return on_tpdo(*node, frame);
    case cob_id::sdo_answer: return on_sdo(*node, frame, now);
    case cob_id::heartbeat: return on_heartbeat(*node, frame, now);
    default: return refuse(Refusal::pdo_unmapped);
  }
}

void Network::refuse_foreign_master(std::uint32_t id) {
  foreign_.add(id);
  for (Node& node : nodes_) node.doubt_restart(id == cob_id::nmt);
  refuse(Refusal::foreign_master);
}

void Network::on_tpdo(std::size_t node, const CanFrame& frame) {
  const std::uint8_t length = node == io_index() ? IoModule::tpdo_length : can_map::drive_tpdo1::length;
  if (frame.length < length) return refuse(Refusal::pdo_too_short);
  if (frame.length > length) return refuse(Refusal::pdo_too_long);
  if (!nodes_[node].started()) return refuse(Refusal::pdo_before_start);
  nodes_[node].on_process_data();
  if (node == io_index()) {
    if (io_.seen() && io_.actual_time() == last_sync_) ++stats_.pdo_repeated;
    return io_.on_tpdo(frame, last_sync_);
  }
  Axis& axis = axes_[node];
  if (axis.seen() && axis.actual_time() == last_sync_) ++stats_.pdo_repeated;
  axis.on_tpdo(frame, last_sync_);
}

void Network::on_emcy(std::size_t node, const CanFrame& frame, Time now) {
  if (frame.length != 8) return refuse(Refusal::bad_length);
  const Emcy emcy = decode_emcy(frame, now);
  nodes_[node].on_emcy(emcy);
  if (node < drive_count()) axes_[node].on_emcy(emcy.code);
  ++stats_.emcys;
  if (emcy_count_ == emcy_history) {
    ++stats_.emcys_forgotten;
    (void)take_emcy();
  }
  emcys_[(emcy_first_ + emcy_count_) % emcy_history] = emcy;
  ++emcy_count_;
}

void Network::on_heartbeat(std::size_t node, const CanFrame& frame, Time now) {
  if (frame.length != 1) return refuse(Refusal::bad_length);
  if (!nodes_[node].on_heartbeat(frame.data[0], now)) return refuse(Refusal::heartbeat_state);
}

void Network::on_sdo(std::size_t node, const CanFrame& frame, Time now) {
  if (frame.length != 8) return refuse(Refusal::bad_length);
  if (!nodes_[node].sdo().on_frame(frame, now)) refuse(Refusal::sdo_refused);
}

// ---- a SYNC cycle ----

void Network::tick(Time now, Outbox& outbox) {
  if (!running_) return send_nmt(outbox);
  if (now < last_sync_) {
    ++stats_.time_backwards;
    return;
  }
  send(outbox, empty_frame(cob_id::sync, 0));
  last_sync_ = now;
  ++stats_.syncs;

  for (std::size_t i = 0; i < node_count(); ++i) {
    nodes_[i].step(now, context(i));
    if (nodes_[i].take_restart() && i < drive_count()) axes_[i].forget_home();
  }
  if (boot_ == BootState::running) step_boot(now);
  // Until the nodes are stopped, no later order gives power back.
  if (shut_down_syncs_ > 0) remove_power();
  if (shut_down_syncs_ > 0 && --shut_down_syncs_ == 0) stop_nodes();
  step_axes(now);
  send_process_data(outbox);
  send_heartbeat(now, outbox);
  send_guard_requests(now, outbox);
  send_nmt(outbox);
  send_sdo(now, outbox);
}

void Network::step_boot(Time now) {
  const auto all = [this](auto&& predicate) { return std::all_of(nodes_.begin(), nodes_.end(), predicate); };
  if (all([](const Node& n) { return n.boot().configured(); })) nodes_started_ = true;
  if (nodes_started_) start_configured(now);
  if (all([](const Node& n) { return n.boot().done(); })) boot_ = BootState::done;
  // A node that failed does not stop the others from being configured: the report then tells of all that is wrong.
  const bool failed = !all([](const Node& n) { return !n.boot().failed(); });
  const bool settled = all([](const Node& n) { return n.boot().failed() || n.boot().configured() || n.boot().done(); });
  if (failed && settled) give_up_boot();
}

// All of them at first; later one that restarted before its first data and was configured anew.
void Network::start_configured(Time now) {
  for (std::size_t i = 0; i < node_count(); ++i) {
    if (!nodes_[i].boot().configured()) continue;
    if (i < drive_count()) axes_[i].go_online(nodes_[i].boot().report(), now);
    if (i == io_index()) io_.go_online();
    nodes_[i].boot().release(now);
  }
}

void Network::give_up_boot() {
  boot_ = BootState::failed;
  go_offline();
  if (!nodes_started_) return;
  for (std::size_t i = 0; i < node_count(); ++i) {
    nmt_due_[i] = NmtCommand::enter_pre_operational;
    nodes_[i].boot().stand_down();
  }
}

void Network::stop_nodes() {
  boot_ = BootState::idle;
  go_offline();
  for (std::size_t i = 0; i < node_count(); ++i) {
    nmt_due_[i] = NmtCommand::stop;
    nodes_[i].boot().stand_down();
  }
}

void Network::step_axes(Time now) {
  for (std::size_t i = 0; i < drive_count(); ++i) {
    if (nodes_[i].fault().link()) axes_[i].lose_node();
    axes_[i].step(now, nodes_[i].sdo());
  }
  io_.step(now);
}

// ---- frames out ----

void Network::send(Outbox& outbox, const CanFrame& frame) {
  if (!outbox.push_back(frame)) {
    ++stats_.outbox_overflows;
    return;
  }
  ++stats_.frames_out;
  stats_.bits_on_bus += bus_load::exact_bits(frame);
}

void Network::send_process_data(Outbox& outbox) {
  CanFrame frame;
  for (const Axis& axis : axes_) {
    if (axis.make_rpdo(frame)) send(outbox, frame);
  }
  if (io_.make_rpdo(frame, config_.io.node)) send(outbox, frame);
}

void Network::send_heartbeat(Time now, Outbox& outbox) {
  if (boot_up_sent_ && now < next_heartbeat_) return;
  CanFrame frame = empty_frame(cob_id::heartbeat + can_map::master_node, 1);
  const NmtState own = boot_ == BootState::done ? NmtState::operational : NmtState::pre_operational;
  frame.data[0] = static_cast<std::uint8_t>(boot_up_sent_ ? own : NmtState::boot_up);
  // On a fixed grid; after a pause (the caller did not tick) the grid starts anew.
  const bool late = !boot_up_sent_ || now - next_heartbeat_ > can_map::master_heartbeat;
  next_heartbeat_ = (late ? now : next_heartbeat_) + can_map::master_heartbeat;
  boot_up_sent_ = true;
  send(outbox, frame);
}

void Network::send_guard_requests(Time now, Outbox& outbox) {
  CanFrame frame;
  for (Node& node : nodes_) {
    if (node.take_guard_request(now, frame)) send(outbox, frame);
  }
}

void Network::send_nmt(Outbox& outbox) {
  for (std::size_t i = 0; i < node_count(); ++i) {
    std::optional<NmtCommand> command = nodes_[i].boot().take_nmt();
    if (!command) command = std::exchange(nmt_due_[i], std::nullopt);
    if (!command) continue;
    CanFrame frame = empty_frame(cob_id::nmt, 2);
    frame.data[0] = static_cast<std::uint8_t>(*command);
    frame.data[1] = nodes_[i].id();
    send(outbox, frame);
  }
}

void Network::send_sdo(Time now, Outbox& outbox) {
  CanFrame frame;
  for (Node& node : nodes_) {
    while (node.sdo().poll(now, frame)) send(outbox, frame);
  }
}

}  // namespace lf::canopen
