#include "host_sim/devices/canopen/node.hpp"

#include <algorithm>

namespace lf::devices {
namespace {

constexpr std::uint8_t nmt_start = 1, nmt_stop = 2, nmt_pre_operational = 128, nmt_reset_node = 129, nmt_reset_communication = 130;
constexpr Duration communication_reset_time = Duration::from_ms(20);

CanFrame make(std::uint32_t id, std::span<const std::uint8_t> data) {
  CanFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

std::uint16_t at(std::uint16_t base, std::size_t i) { return static_cast<std::uint16_t>(base + i); }

}  // namespace

std::uint8_t emcy::register_bit(std::uint16_t code) {
  switch (code >> 8) {
    case 0x23: return 0x02;  // current
    case 0x42: return 0x08;  // temperature
    case 0x81:
    case 0x82: return 0x10;  // communication
    case 0x86: return 0x20;  // device profile
    default: return 0x80;    // manufacturer
  }
}

Node::Node(std::uint8_t id, std::vector<Object> objects, Duration boot_time, Application& application)
    : id_(id),
      boot_time_(boot_time),
      objects_(std::move(objects)),
      application_(application),
      sdo_(*this),
      error_register_(objects_.at(0x1001)),
      heartbeat_ms_(objects_.at(0x1017)),
      sync_id_(objects_.at(0x1005)) {}

void Node::power_on(Time now) {
  objects_.reset(0x0000, 0xFFFF);
  boot(now, boot_time_);
  application_.restarted(now);
}

void Node::boot(Time now, Duration time) {
  powered_ = true;
  errors_.clear();
  error_register_.value = 0;
  guarded_ = guard_toggle_ = false;
  outbox_.clear();
  sdo_.reset();
  configure_pdos();
  configure_consumers();
  boot_done_ = now + time;
  state_ = NmtState::booting;
}

void Node::enter(NmtState state, Time now) {
  if (state == state_) return;
  state_ = state;
  if (state == NmtState::operational) {
    configure_pdos();
  } else {
    for (Pdo& pdo : receive_) pdo.holding = pdo.seen = false;
  }
  if (!talks()) sdo_.reset();
  application_.state_changed(state, now);
}

void Node::reset_communication(Time now) {
  if (state_ == NmtState::operational) application_.connection_lost(emcy::stopped_by_master, now);
  objects_.reset(0x1000, 0x1FFF);
  boot(now, communication_reset_time);
  application_.state_changed(state_, now);
}

void Node::receive(const CanFrame& frame, Time now) {
  if (!powered_ || state_ == NmtState::booting) return;
  if (frame.id == (CanFrame::remote_flag | (0x700u + id_))) return on_guard_request(now);
  if (frame.id > 0x7FF) return;
  const std::uint32_t id = frame.id;
  if (id == 0) return on_nmt(frame, now);
  if (id == (sync_id_.value & 0x7FF)) return on_sync(now);
  if (id == 0x600u + id_) return on_sdo(frame, now);
  if (id > 0x700) return on_heartbeat(frame, now);
  on_pdo(frame, now);
}

void Node::on_nmt(const CanFrame& frame, Time now) {
  if (frame.length != 2 || (frame.data[1] != 0 && frame.data[1] != id_)) return;
  switch (frame.data[0]) {
    case nmt_start: return enter(NmtState::operational, now);
    case nmt_stop:
      if (state_ != NmtState::stopped) application_.connection_lost(emcy::stopped_by_master, now);
      return enter(NmtState::stopped, now);
    case nmt_pre_operational: return enter(NmtState::pre_operational, now);
    case nmt_reset_node: return power_on(now);
    case nmt_reset_communication: return reset_communication(now);
    default: return;
  }
}

// What is sent was latched before what is received acts: an answer to this SYNC's data comes with the next.
void Node::on_sync(Time now) {
  if (state_ != NmtState::operational) return;
  for (Pdo& pdo : transmit_) {
    if (!pdo.valid() || !pdo.synchronous()) continue;
    const CanFrame frame = pdo.pack();
    const bool due = pdo.type() == 0 ? !(frame == pdo.previous) : ++pdo.syncs >= pdo.type();
    if (!due || (inhibits_synchronous_ && now - pdo.last < pdo.inhibit)) continue;
    pdo.syncs = 0;
    pdo.previous = frame;
    pdo.last = now;
    outbox_.push_back(frame);
  }
  bool received = false;
  for (Pdo& pdo : receive_) {
    if (!pdo.holding) continue;
    pdo.holding = false;
    pdo.unpack(pdo.held.data);
    received = true;
  }
  if (received) application_.received(now);
  application_.synced(now);
}

bool Node::on_pdo(const CanFrame& frame, Time now) {
  if (state_ != NmtState::operational) return false;
  for (Pdo& pdo : receive_) {
    if (!pdo.valid() || pdo.cob_id() != frame.id) continue;
    if (frame.length < pdo.bytes()) {
      raise(emcy::pdo_too_short, now);
      return true;
    }
    if (frame.length > pdo.bytes()) raise(emcy::pdo_too_long, now);  // the first bytes are used all the same
    if (frame.length == pdo.bytes()) {
      clear(emcy::pdo_too_short, now);
      clear(emcy::pdo_too_long, now);
    }
    pdo.last = now;
    pdo.seen = true;
    if (pdo.overdue) {
      pdo.overdue = false;
      clear(emcy::pdo_timeout, now);
    }
    if (pdo.synchronous()) {
      pdo.held = frame;
      pdo.holding = true;
    } else {
      pdo.unpack(frame.data);
      application_.received(now);
    }
    return true;
  }
  return false;
}

void Node::on_sdo(const CanFrame& frame, Time now) {
  std::array<std::uint8_t, 8> answer;
  if (!talks() || !sdo_.on_request(std::span(frame.data.data(), std::min<std::size_t>(frame.length, 8)), now, answer)) return;
  outbox_.push_back(make(0x580u + id_, answer));
}

void Node::on_heartbeat(const CanFrame& frame, Time now) {
  if (frame.length != 1) return;
  for (Consumer& consumer : consumers_) {
    if (consumer.node == 0 || frame.id != 0x700u + consumer.node) continue;
    consumer.last = now;
    consumer.watching = true;
  }
}

void Node::tick(Time now) {
  if (!powered_) return;
  if (state_ == NmtState::booting) {
    if (now < boot_done_) return;
    outbox_.push_back(make(0x700u + id_, std::array<std::uint8_t, 1>{0}));
    next_heartbeat_ = now + Duration::from_ms(heartbeat_ms_.value);
    enter(NmtState::pre_operational, now);
    return;
  }
  if (heartbeat_ms_.value > 0 && now >= next_heartbeat_) {
    next_heartbeat_ = now + Duration::from_ms(heartbeat_ms_.value);
    outbox_.push_back(make(0x700u + id_, std::array<std::uint8_t, 1>{static_cast<std::uint8_t>(state_)}));
  }
  std::array<std::uint8_t, 8> abort;
  if (sdo_.expired(now, abort)) outbox_.push_back(make(0x580u + id_, abort));
  check_consumers(now);
  check_guard(now);
  if (state_ != NmtState::operational) return;
  check_deadlines(now);
  send_events(now);
}

// A lost heartbeat stays an error until the master resets the communication: a master that died must set the node up again.
void Node::check_consumers(Time now) {
  for (Consumer& consumer : consumers_) {
    if (!consumer.watching || now - consumer.last <= consumer.timeout) continue;
    consumer.watching = false;
    raise(emcy::heartbeat, now);
    application_.connection_lost(emcy::heartbeat, now);
    const std::int64_t behaviour = objects_.at(0x1029, 1).value;
    if (behaviour == 0 && state_ == NmtState::operational) enter(NmtState::pre_operational, now);
    if (behaviour == 2) enter(NmtState::stopped, now);
  }
}

// A node with a heartbeat of its own is not guarded (CiA 301).
void Node::on_guard_request(Time now) {
  if (heartbeat_ms_.value > 0) return;
  const auto toggle = static_cast<std::uint8_t>(guard_toggle_ ? 0x80 : 0);
  outbox_.push_back(make(0x700u + id_, std::array<std::uint8_t, 1>{static_cast<std::uint8_t>(toggle | static_cast<std::uint8_t>(state_))}));
  guard_toggle_ = !guard_toggle_;
  guarded_ = true;
  last_guard_ = now;
}

// Life guarding: as a lost heartbeat, an error until the master resets the communication.
void Node::check_guard(Time now) {
  const Object* time = objects_.find(0x100C, 0);
  const Object* factor = objects_.find(0x100D, 0);
  if (!guarded_ || time == nullptr || factor == nullptr) return;
  const Duration life = Duration::from_ms(time->value * factor->value);
  if (life == Duration{} || now - last_guard_ <= life) return;
  guarded_ = false;
  raise(emcy::heartbeat, now);
  application_.connection_lost(emcy::heartbeat, now);
  if (state_ == NmtState::operational) enter(NmtState::pre_operational, now);
}

void Node::check_deadlines(Time now) {
  if (ignores_deadlines_) return;
  for (Pdo& pdo : receive_) {
    if (!pdo.valid() || !pdo.seen || pdo.overdue || pdo.event_timer == Duration{} || now - pdo.last <= pdo.event_timer) continue;
    pdo.overdue = true;
    raise(emcy::pdo_timeout, now);
    application_.connection_lost(emcy::pdo_timeout, now);
  }
}

void Node::send_events(Time now) {
  for (Pdo& pdo : transmit_) {
    if (!pdo.valid() || pdo.synchronous() || now - pdo.last < pdo.inhibit) continue;
    const bool due = pdo.event_timer > Duration{} && now - pdo.last >= pdo.event_timer;
    const CanFrame frame = pdo.pack();
    if (!due && frame == pdo.previous) continue;
    pdo.previous = frame;
    pdo.last = now;
    outbox_.push_back(frame);
  }
}

void Node::configure_pdos() {
  for (std::size_t i = 0; i < pdo_count; ++i) {
    receive_[i].configure(objects_, at(0x1400, i));
    transmit_[i].configure(objects_, at(0x1800, i));
  }
}

void Node::configure_consumers() {
  for (std::size_t i = 0; i < consumer_count; ++i) {
    const auto value = static_cast<std::uint32_t>(objects_.at(0x1016, static_cast<std::uint8_t>(i + 1)).value);
    const Duration timeout = Duration::from_ms(value & 0xFFFF);
    consumers_[i] = {};
    if (timeout > Duration{}) consumers_[i] = {static_cast<std::uint8_t>((value >> 16) & 0x7F), timeout, {}, false};
  }
}

void Node::raise(std::uint16_t code, Time) {
  if (active(code)) return;
  errors_.push_back(code);
  error_register_.value |= 0x01 | emcy::register_bit(code);
  remember(code);
  send_emergency(code);
}

void Node::clear(std::uint16_t code, Time) {
  const auto found = std::find(errors_.begin(), errors_.end(), code);
  if (found == errors_.end()) return;
  errors_.erase(found);
  std::int64_t bits = 0;
  for (const std::uint16_t error : errors_) bits |= 0x01 | emcy::register_bit(error);
  error_register_.value = bits;
  send_emergency(0);
}

bool Node::active(std::uint16_t code) const { return std::find(errors_.begin(), errors_.end(), code) != errors_.end(); }

void Node::remember(std::uint16_t code) {
  Object& count = objects_.at(0x1003, 0);
  count.value = std::min<std::int64_t>(count.value + 1, error_history_length);
  for (auto sub = static_cast<std::uint8_t>(count.value); sub > 1; --sub) {
    objects_.at(0x1003, sub).value = objects_.at(0x1003, static_cast<std::uint8_t>(sub - 1)).value;
  }
  objects_.at(0x1003, 1).value = code;
}

void Node::send_emergency(std::uint16_t code) {
  if (!talks()) return;
  const std::uint8_t data[8] = {static_cast<std::uint8_t>(code & 0xFF),
                                static_cast<std::uint8_t>(code >> 8),
                                static_cast<std::uint8_t>(error_register_.value),
                                0,
                                0,
                                0,
                                0,
                                0};
  outbox_.push_back(make(0x080u + id_, data));
}

void Node::bus_off(Time now) {
  if (state_ == NmtState::booting) return;
  outbox_.clear();
  application_.connection_lost(emcy::bus_off_recovered, now);
}

void Node::bus_recovered(Time now) {
  if (state_ == NmtState::booting) return;
  if (active(emcy::bus_off_recovered)) return send_emergency(emcy::bus_off_recovered);  // the drive's fault: nobody heard of it yet
  raise(emcy::bus_off_recovered, now);
  clear(emcy::bus_off_recovered, now);
}

}  // namespace lf::devices
