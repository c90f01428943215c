// A tiny CANopen node for tests of the master, written from CiA 301 and 402 alone: an object dictionary with an SDO server, the NMT states, PDOs that
// act at the SYNC after they arrive and are answered one SYNC later, and the drive's state machine without any mechanics.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/canopen/network.hpp"

namespace lf::canopen::test {

using Bytes = std::vector<std::uint8_t>;
Bytes little_endian(std::uint32_t value, std::size_t width);

class ScriptedNode {
 public:
  enum class Kind { drive, io };
  // What the SDO server does instead of its duty with its n-th request.
  struct Trick {
    enum class What { drop, abort, refuse_write, wrong_value, ignore_write, wrong_object, wrong_toggle, wrong_length } what = What::drop;
    int request = -1;         // counted from 0 since the last reset; -1: every one, as far as `index` fits
    std::uint16_t index = 0;  // 0: any object
    std::uint32_t code = 0;   // of an abort
    int times = 1;
    int sub = -1;  // -1: any
  };

  ScriptedNode(std::uint8_t id, Kind kind);

  void receive(const CanFrame& frame, Time now);
  void pass_time(Time now);  // heartbeats
  std::vector<CanFrame> take();
  void send(const CanFrame& frame) { out_.push_back(frame); }

  void reboot();
  void send_emcy(std::uint16_t code, std::uint8_t error_register);
  void enter_fault(std::uint16_t code);
  void set_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::size_t width);
  void remove_object(std::uint16_t index, std::uint8_t sub);
  std::uint32_t object(std::uint16_t index, std::uint8_t sub) const;
  bool has(std::uint16_t index, std::uint8_t sub) const { return objects_.count(key(index, sub)) != 0; }
  std::uint8_t nmt() const { return nmt_; }

  // Switches of a node's behaviour.
  bool dead = false;
  bool mute_heartbeat = false;
  bool mute_tpdo = false;
  bool ignores_start = false;
  bool silent_boot = false;  // no boot-up message
  int boot_ups_to_lose = 0;  // that many are lost first
  bool ignores_controlword = false;
  bool ignores_outputs = false;
  bool ignores_mode = false;  // 6061 does not follow
  bool refuses_reset = false;
  bool jammed = false;    // does not follow its targets
  int homing_cycles = 5;  // SYNCs that a homing takes
  bool homing_fails = false;
  std::optional<Trick> trick;

  // Drive.
  std::int32_t actual_counts = 1000;
  std::int16_t torque_permille = 0;
  std::uint16_t extra_status = 0;  // bits beside the state machine's
  std::uint8_t drive_state_bits() const { return state_; }
  std::vector<std::uint16_t> controlwords;  // each change, as latched at a SYNC
  std::vector<std::int32_t> targets_while_enabled;
  // Output node.
  std::uint8_t inputs = 3;
  std::uint8_t outputs = 0;
  std::uint8_t trigger_counter = 0;
  int exposures = 0;
  std::uint16_t last_exposure_us = 0;

  int sdo_requests = 0;
  std::vector<std::string> sdo_log;  // "w 1400:01" or "r 1400:01" of initiated transfers, since the last reset
  std::vector<std::uint32_t> aborts_received;

 private:
  static std::uint32_t key(std::uint16_t index, std::uint8_t sub) { return (static_cast<std::uint32_t>(index) << 8) | sub; }
  void make_dictionary();
  void on_nmt(std::uint8_t command);
  void on_sync();
  void on_sdo(const CanFrame& request);
  CanFrame answer_of(const CanFrame& request);
  CanFrame initiate_upload(std::uint16_t index, std::uint8_t sub);
  CanFrame upload_segment(const CanFrame& request);
  CanFrame initiate_download(const CanFrame& request, std::uint16_t index, std::uint8_t sub);
  CanFrame download_segment(const CanFrame& request);
  bool apply_trick(const CanFrame& request, CanFrame& answer);
  CanFrame abort(std::uint16_t index, std::uint8_t sub, std::uint32_t code) const;
  void write(std::uint32_t object, const Bytes& value);
  void latch_controlword(std::uint16_t word);
  void run_homing();
  void send_tpdo();

  std::uint8_t id_;
  Kind kind_;
  std::map<std::uint32_t, Bytes> objects_;
  std::vector<CanFrame> out_;
  std::uint8_t nmt_ = 0;
  Time next_heartbeat_;
  std::optional<CanFrame> rpdo_;
  // SDO segment in progress.
  Bytes segment_;
  std::size_t segment_position_ = 0;
  std::size_t segment_size_ = 0;
  std::uint32_t segment_object_ = 0;
  bool toggle_ = false;
  // CiA 402: statusword bits of the state.
  std::uint8_t state_ = 0x40;
  std::uint16_t controlword_ = 0;
  std::int8_t mode_ = 0;
  int homing_left_ = -1;
};

// The master and its six nodes on one wire, one SYNC period a step.
class Bus {
 public:
  explicit Bus(const NetworkConfig& config);
  // Ticks the master, delivers its frames, then its nodes' answers 1 ms later.
  void step();
  void step(int cycles) {
    for (int i = 0; i < cycles; ++i) step();
  }
  // Steps until `done` or the time is up; false then.
  bool run_until(const std::function<bool()>& done, Duration limit);
  bool boot(Duration limit = Duration::from_ms(20'000));

  Network network;
  std::vector<ScriptedNode> nodes;
  Time now = Time::from_ns(1'000'000'000);
  std::vector<CanFrame> sent;  // by the master in the last step
  std::vector<CanFrame> log;   // by the master, all

 private:
  Duration period_;
};

// Five drives at nodes 1 to 5 without homing, and the output node.
NetworkConfig plain_config();

}  // namespace lf::canopen::test
