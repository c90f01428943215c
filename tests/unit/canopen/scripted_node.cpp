#include "tests/unit/canopen/scripted_node.hpp"

#include <cstdio>

#include "tests/arm5e_joints.hpp"

namespace lf::canopen::test {

Bytes little_endian(std::uint32_t value, std::size_t width) {
  Bytes bytes;
  for (std::size_t i = 0; i < width; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  return bytes;
}

namespace {

std::uint32_t number(const Bytes& bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size() && i < 4; ++i) value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return value;
}

std::uint32_t u32_at(const CanFrame& f, std::size_t at) {
  return number(Bytes(f.data.begin() + static_cast<long>(at), f.data.begin() + static_cast<long>(at) + 4));
}
std::uint16_t u16_at(const CanFrame& f, std::size_t at) { return static_cast<std::uint16_t>(f.data[at] | (f.data[at + 1] << 8)); }

CanFrame sdo_answer(std::uint8_t node, std::uint8_t command, std::uint16_t index, std::uint8_t sub, std::uint32_t value = 0) {
  CanFrame f;
  f.id = 0x580u + node;
  f.length = 8;
  const auto bytes = little_endian(value, 4);
  f.data = {command, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8), sub, bytes[0], bytes[1], bytes[2], bytes[3]};
  return f;
}

}  // namespace

ScriptedNode::ScriptedNode(std::uint8_t id, Kind kind) : id_(id), kind_(kind) { make_dictionary(); }

void ScriptedNode::make_dictionary() {
  const auto add = [this](std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::size_t width) {
    set_object(index, sub, value, width);
  };
  objects_.clear();
  add(0x1000, 0, kind_ == Kind::drive ? 0x00020192 : 0x00030191, 4);
  add(0x1005, 0, 0x80, 4);
  add(0x1006, 0, 0, 4);
  add(0x1014, 0, 0x80u + id_, 4);
  add(0x1016, 1, 0, 4);
  add(0x1017, 0, 0, 2);
  add(0x1018, 1, 0x1234, 4);
  add(0x1018, 2, 0x5678, 4);
  const std::string name = "A scripted node with a long name";
  objects_[key(0x1008, 0)] = Bytes(name.begin(), name.end());
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    add(static_cast<std::uint16_t>(0x1400 + pdo), 1, 0x200u + 0x100u * pdo + id_, 4);
    add(static_cast<std::uint16_t>(0x1400 + pdo), 2, 255, 1);
    add(static_cast<std::uint16_t>(0x1400 + pdo), 5, 0, 2);
    add(static_cast<std::uint16_t>(0x1800 + pdo), 1, 0x40000180u + 0x100u * pdo + id_, 4);
    add(static_cast<std::uint16_t>(0x1800 + pdo), 2, 255, 1);
  }
  for (const std::uint16_t map : {0x1600, 0x1A00}) {
    for (std::uint8_t sub = 0; sub <= 8; ++sub) add(map, sub, 0, sub == 0 ? 1 : 4);
  }
  if (kind_ == Kind::io) {
    add(0x1029, 1, 0, 1);
    add(0x6206, 1, 0, 1);
    add(0x6207, 1, 0x55, 1);
    return;
  }
  for (const std::uint16_t index : {0x6007, 0x605A, 0x6066, 0x6072}) add(index, 0, 0, 2);
  for (const std::uint16_t index : {0x6065, 0x607F, 0x6080, 0x6085, 0x609A, 0x607C}) add(index, 0, 0, 4);
  add(0x6076, 0, 12'000, 4);
  for (const std::uint8_t sub : {1, 2}) {
    add(0x607D, sub, 0, 4);
    add(0x6099, sub, 0, 4);
    add(0x60C2, sub, sub == 1 ? 1 : 0xFD, 1);
  }
  for (const std::uint16_t index : {0x6060, 0x6061, 0x6098}) add(index, 0, 0, 1);
}

void ScriptedNode::set_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::size_t width) {
  objects_[key(index, sub)] = little_endian(value, width);
}
void ScriptedNode::remove_object(std::uint16_t index, std::uint8_t sub) { objects_.erase(key(index, sub)); }
std::uint32_t ScriptedNode::object(std::uint16_t index, std::uint8_t sub) const { return number(objects_.at(key(index, sub))); }

std::vector<CanFrame> ScriptedNode::take() {
  std::vector<CanFrame> frames;
  frames.swap(out_);
  return dead ? std::vector<CanFrame>{} : frames;
}

void ScriptedNode::receive(const CanFrame& frame, Time now) {
  if (dead) return;
  if (frame.id == 0x000 && (frame.data[1] == id_ || frame.data[1] == 0)) {
    on_nmt(frame.data[0]);
    next_heartbeat_ = now;
  }
  if (frame.id == 0x080) on_sync();
  if (frame.id == 0x600u + id_) on_sdo(frame);
  if (frame.id == 0x200u + id_ && nmt_ == 5 && (object(0x1400, 1) & 0x80000000u) == 0) rpdo_ = frame;
}

void ScriptedNode::on_nmt(std::uint8_t command) {
  if (command == 1 && !ignores_start) nmt_ = 5;
  if (command == 2) nmt_ = 4;
  if (command == 128) nmt_ = 127;
  if (command == 129) state_ = 0x40;  // switch on disabled; NMT reset communication leaves the drive as it is
  if (command == 129 || command == 130) reboot();
}

void ScriptedNode::reboot() {
  nmt_ = 127;
  sdo_requests = 0;
  sdo_log.clear();
  rpdo_.reset();
  segment_.clear();
  CanFrame boot_up;
  boot_up.id = 0x700u + id_;
  boot_up.length = 1;
  if (silent_boot) return;
  if (boot_ups_to_lose > 0) {
    --boot_ups_to_lose;
    return;
  }
  out_.push_back(boot_up);
}

void ScriptedNode::pass_time(Time now) {
  if (nmt_ == 0 || mute_heartbeat || !has(0x1017, 0) || object(0x1017, 0) == 0 || now < next_heartbeat_) return;
  next_heartbeat_ = now + Duration::from_ms(object(0x1017, 0));
  CanFrame heartbeat;
  heartbeat.id = 0x700u + id_;
  heartbeat.length = 1;
  heartbeat.data[0] = nmt_;
  out_.push_back(heartbeat);
}

void ScriptedNode::send_emcy(std::uint16_t code, std::uint8_t error_register) {
  CanFrame f;
  f.id = 0x080u + id_;
  f.length = 8;
  f.data = {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8), error_register};
  out_.push_back(f);
}

void ScriptedNode::enter_fault(std::uint16_t code) {
  state_ = 0x08;
  send_emcy(code, 0x21);
}

// ---- process data ----

void ScriptedNode::on_sync() {
  if (nmt_ != 5) return;
  if (!mute_tpdo) send_tpdo();  // values at the SYNC, before the RPDO acts
  if (!rpdo_) return;
  const CanFrame rpdo = *rpdo_;
  if (kind_ == Kind::io) {
    if (!ignores_outputs) outputs = rpdo.data[0];
    if (rpdo.data[1] != trigger_counter) {
      ++exposures;
      last_exposure_us = u16_at(rpdo, 2);
    }
    trigger_counter = rpdo.data[1];
    return;
  }
  if (!ignores_controlword) latch_controlword(u16_at(rpdo, 0));
  run_homing();
  if (state_ != 0x27 || mode_ != 8) return;
  const auto target = static_cast<std::int32_t>(u32_at(rpdo, 2));
  if (!jammed) actual_counts = target;
  targets_while_enabled.push_back(target);
}

void ScriptedNode::send_tpdo() {
  CanFrame f;
  f.id = 0x180u + id_;
  if (kind_ == Kind::io) {
    f.length = 5;
    f.data = {inputs, outputs, trigger_counter, static_cast<std::uint8_t>(last_exposure_us),
              static_cast<std::uint8_t>(last_exposure_us >> 8)};
  } else {
    f.length = 8;
    const auto status = static_cast<std::uint16_t>(state_ | extra_status);
    const auto position = little_endian(static_cast<std::uint32_t>(actual_counts), 4);
    const auto torque = static_cast<std::uint16_t>(torque_permille);
    f.data = {static_cast<std::uint8_t>(status), static_cast<std::uint8_t>(status >> 8), position[0], position[1], position[2], position[3],
              static_cast<std::uint8_t>(torque), static_cast<std::uint8_t>(torque >> 8)};
  }
  out_.push_back(f);
}

// The transitions of CiA 402-2 by their numbers; 2 to 12, 15 and 16.
void ScriptedNode::latch_controlword(std::uint16_t word) {
  const std::uint16_t before = controlword_;
  controlword_ = word;
  if (word != before) controlwords.push_back(word);
  const bool reset_edge = (word & 0x80) != 0 && (before & 0x80) == 0;
  if (state_ == 0x08) {
    if (reset_edge && !refuses_reset) state_ = 0x40;  // 15
    return;
  }
  const bool shutdown = (word & 0x87) == 0x06, switch_on = (word & 0x8F) == 0x07, enable = (word & 0x8F) == 0x0F;
  const bool disable_voltage = (word & 0x82) == 0x00, quick_stop = (word & 0x86) == 0x02;
  if (state_ == 0x40 && shutdown)
    state_ = 0x21;  // 2
  else if (state_ == 0x21 && (switch_on || enable))
    state_ = 0x23;  // 3
  else if (state_ == 0x23 && enable)
    state_ = 0x27;  // 4
  else if (state_ == 0x27 && switch_on)
    state_ = 0x23;  // 5
  else if (state_ == 0x23 && shutdown)
    state_ = 0x21;  // 6
  else if (state_ == 0x27 && shutdown)
    state_ = 0x21;  // 8
  else if (state_ == 0x27 && quick_stop)
    state_ = object(0x605A, 0) >= 5 ? 0x07 : 0x40;  // 11, and 12 when stopped
  else if (state_ == 0x07 && enable && object(0x605A, 0) >= 5)
    state_ = 0x27;  // 16
  else if (state_ != 0x27 && state_ != 0x07 && quick_stop)
    state_ = 0x40;  // 7, 10
  else if (disable_voltage)
    state_ = 0x40;  // 7, 9, 10, 12
}

void ScriptedNode::run_homing() {
  if (mode_ != 6) return;
  if (state_ != 0x27 || (controlword_ & 0x10) == 0) {
    homing_left_ = -1;
    extra_status = 0x1400;  // an earlier homing is still shown: a hasty master would take it for this one
    return;
  }
  if (homing_left_ < 0) homing_left_ = homing_cycles;
  extra_status = 0;
  if (homing_left_ > 0) {
    --homing_left_;
    return;
  }
  if (homing_fails) {
    extra_status = 0x2000;
    return;
  }
  extra_status = 0x1400;
  actual_counts = static_cast<std::int32_t>(object(0x607C, 0));
}

// ---- SDO server ----

CanFrame ScriptedNode::abort(std::uint16_t index, std::uint8_t sub, std::uint32_t code) const {
  return sdo_answer(id_, 0x80, index, sub, code);
}

void ScriptedNode::on_sdo(const CanFrame& request) {
  if (nmt_ == 0 || nmt_ == 4) return;
  if (request.data[0] == 0x80) {
    aborts_received.push_back(u32_at(request, 4));
    segment_.clear();
    return;
  }
  const int n = sdo_requests++;
  CanFrame answer = answer_of(request);
  const bool initiates = (request.data[0] >> 5) == 1 || (request.data[0] >> 5) == 2;
  const std::uint16_t index = initiates ? u16_at(request, 1) : static_cast<std::uint16_t>(segment_object_ >> 8);
  const bool writes = (request.data[0] >> 5) == 1;
  const bool applies = trick && trick->times > 0 && (writes || trick->what != Trick::What::ignore_write);
  const bool tricked = applies && (trick->request < 0 || trick->request == n) && (trick->index == 0 || trick->index == index) &&
                       (trick->sub < 0 || trick->sub == request.data[3]);
  if (tricked) {
    --trick->times;
    if (!apply_trick(request, answer)) return;
  }
  out_.push_back(answer);
}

bool ScriptedNode::apply_trick(const CanFrame& request, CanFrame& answer) {
  switch (trick->what) {
    case Trick::What::drop: return false;
    case Trick::What::abort: answer = abort(u16_at(request, 1), request.data[3], trick->code); return true;
    case Trick::What::refuse_write:
      if ((request.data[0] >> 5) == 1) answer = abort(u16_at(request, 1), request.data[3], trick->code);
      return true;
    case Trick::What::wrong_value: answer.data[4] ^= 0x40; return true;
    case Trick::What::ignore_write: return true;
    case Trick::What::wrong_object: answer.data[1] ^= 0x01; return true;
    case Trick::What::wrong_toggle: answer.data[0] ^= 0x10; return true;
    case Trick::What::wrong_length: answer.data[0] ^= 0x04; return true;
  }
  return true;
}

CanFrame ScriptedNode::answer_of(const CanFrame& request) {
  const std::uint16_t index = u16_at(request, 1);
  const std::uint8_t sub = request.data[3];
  switch (request.data[0] >> 5) {
    case 0: return download_segment(request);
    case 1: return initiate_download(request, index, sub);
    case 2: return initiate_upload(index, sub);
    case 3: return upload_segment(request);
    default: return abort(index, sub, 0x05040001);
  }
}

CanFrame ScriptedNode::initiate_upload(std::uint16_t index, std::uint8_t sub) {
  char text[16];
  std::snprintf(text, sizeof text, "r %04X:%02X", index, sub);
  sdo_log.emplace_back(text);
  segment_object_ = key(index, sub);
  if (!has(index, sub)) return abort(index, sub, 0x06020000);
  const Bytes& value = objects_.at(key(index, sub));
  if (value.size() <= 4) {
    return sdo_answer(id_, static_cast<std::uint8_t>(0x43 | ((4 - value.size()) << 2)), index, sub, number(value));
  }
  segment_ = value;
  segment_position_ = 0;
  toggle_ = false;
  return sdo_answer(id_, 0x41, index, sub, static_cast<std::uint32_t>(value.size()));
}

CanFrame ScriptedNode::upload_segment(const CanFrame& request) {
  const std::uint32_t object = segment_object_;
  if (((request.data[0] & 0x10) != 0) != toggle_)
    return abort(static_cast<std::uint16_t>(object >> 8), static_cast<std::uint8_t>(object), 0x05030000);
  const std::size_t n = std::min<std::size_t>(7, segment_.size() - segment_position_);
  const bool last = segment_position_ + n == segment_.size();
  CanFrame f = sdo_answer(id_, static_cast<std::uint8_t>((toggle_ ? 0x10 : 0) | ((7 - n) << 1) | (last ? 1 : 0)), 0, 0);
  for (std::size_t i = 0; i < n; ++i) f.data[1 + i] = segment_[segment_position_ + i];
  segment_position_ += n;
  toggle_ = !toggle_;
  return f;
}

CanFrame ScriptedNode::initiate_download(const CanFrame& request, std::uint16_t index, std::uint8_t sub) {
  char text[16];
  std::snprintf(text, sizeof text, "w %04X:%02X", index, sub);
  sdo_log.emplace_back(text);
  segment_object_ = key(index, sub);
  if (!has(index, sub)) return abort(index, sub, 0x06020000);
  if ((request.data[0] & 0x02) == 0) {
    segment_.clear();
    segment_size_ = u32_at(request, 4);
    toggle_ = false;
    return sdo_answer(id_, 0x60, index, sub);
  }
  const std::size_t n = 4u - ((request.data[0] >> 2) & 3u);
  if (n != objects_.at(key(index, sub)).size()) return abort(index, sub, 0x06070010);
  // CiA 301: identifier and mapping do not change while the PDO is valid.
  const bool parameters = (index & 0xFF00) == 0x1400 || (index & 0xFF00) == 0x1800;
  const bool mapping = index == 0x1600 || index == 0x1A00;
  const std::uint32_t old = object(index, sub), value = u32_at(request, 4);
  if (parameters && sub == 1 && ((old | value) & 0x80000000u) == 0 && ((old ^ value) & 0x7FF) != 0) return abort(index, sub, 0x06090030);
  if (mapping && (object(static_cast<std::uint16_t>(index - 0x200), 1) & 0x80000000u) == 0) return abort(index, sub, 0x06010000);
  if (mapping && sub > 0 && object(index, 0) != 0) return abort(index, sub, 0x06010000);
  const bool ignored = trick && trick->times > 0 && trick->what == Trick::What::ignore_write && trick->index == index &&
                       (trick->sub < 0 || trick->sub == sub);
  if (!ignored) write(key(index, sub), Bytes(request.data.begin() + 4, request.data.begin() + 4 + static_cast<long>(n)));
  return sdo_answer(id_, 0x60, index, sub);
}

CanFrame ScriptedNode::download_segment(const CanFrame& request) {
  const std::uint32_t object = segment_object_;
  if (((request.data[0] & 0x10) != 0) != toggle_)
    return abort(static_cast<std::uint16_t>(object >> 8), static_cast<std::uint8_t>(object), 0x05030000);
  const std::size_t n = 7u - ((request.data[0] >> 1) & 7u);
  segment_.insert(segment_.end(), request.data.begin() + 1, request.data.begin() + 1 + static_cast<long>(n));
  const CanFrame answer = sdo_answer(id_, static_cast<std::uint8_t>(0x20 | (toggle_ ? 0x10 : 0)), 0, 0);
  toggle_ = !toggle_;
  if ((request.data[0] & 1) != 0 && segment_.size() == segment_size_) write(object, segment_);
  return answer;
}

void ScriptedNode::write(std::uint32_t object, const Bytes& value) {
  objects_[object] = value;
  if (object == key(0x6060, 0) && !ignores_mode) {
    objects_[key(0x6061, 0)] = value;
    mode_ = static_cast<std::int8_t>(value[0]);
    if (mode_ == 8) extra_status = 0x1000;
  }
}

// ---- bus ----

Bus::Bus(const NetworkConfig& config) : network(config), period_(config.sync_period) {
  for (const DriveSetup& drive : config.drives) nodes.emplace_back(drive.node, ScriptedNode::Kind::drive);
  nodes.emplace_back(config.io.node, ScriptedNode::Kind::io);
}

void Bus::step() {
  Outbox outbox;
  network.tick(now, outbox);
  sent.assign(outbox.begin(), outbox.end());
  log.insert(log.end(), sent.begin(), sent.end());
  const Time answered = now + Duration::from_ms(1);
  for (const CanFrame& frame : sent) {
    for (ScriptedNode& node : nodes) node.receive(frame, now);
  }
  for (ScriptedNode& node : nodes) {
    node.pass_time(now);
    for (const CanFrame& frame : node.take()) network.on_frame(frame, answered);
  }
  now = now + period_;
}

bool Bus::run_until(const std::function<bool()>& done, Duration limit) {
  for (const Time end = now + limit; now < end; step()) {
    if (done()) return true;
  }
  return done();
}

bool Bus::boot(Duration limit) {
  network.start_boot(now);
  return run_until([this] { return network.boot().state != BootState::running; }, limit) && network.boot().state == BootState::done;
}

NetworkConfig plain_config() {
  NetworkConfig config;
  arm5e_joint::fill(config.drives, DriveSetup{});
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    DriveSetup& drive = config.drives[i];
    drive.node = can_map::drive_nodes[i];
    drive.min_counts = -50'000;
    drive.max_counts = 50'000;
    drive.max_torque_permille = 1200;
    drive.max_speed_counts_s = 10'000;
    drive.following_window_counts = 500;
    drive.following_timeout_ms = 60;
    drive.quick_stop_option = 6;  // the harder case: the drive keeps its power
  }
  return config;
}

}  // namespace lf::canopen::test
