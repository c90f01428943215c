// Frames from the bus, in any order and at any time, into the core's master: before, in and after the boot, and with powered axes.
//
// Held against: what leaves the master is its own, complete, and no more than it says; and a book of the orders that this file gave: whatever the frames
// say, no drive is told "operation enabled" after a stop or a latched fault before a fresh order to enable it.
#include <vector>

#include "firmware/canopen/cob_id.hpp"
#include "firmware/canopen/network.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/fuzz/can_frames.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::fuzz {
namespace {

using canopen::AxisRequest;
using canopen::Network;
using canopen::test::Bus;

struct Beginning {
  Network network;
  Time now;
};

canopen::NetworkConfig config_of(bool homes) {
  canopen::NetworkConfig config = canopen::test::plain_config();
  if (!homes) return config;
  for (canopen::DriveSetup& drive : config.drives) {
    drive.homing_method = -3;
    drive.homing_speed_counts_s = 1000;
    drive.homing_accel_counts_s2 = 5000;
  }
  config.drives[1].profile.guarded = true;
  return config;
}

// The master at points of its life, made once with nodes that answer as they should: every input begins at one of them.
std::vector<Beginning> make_beginnings() {
  std::vector<Beginning> all;
  const auto keep = [&](const Bus& bus) { all.push_back({bus.network, bus.now}); };
  for (const bool homes : {false, true}) {
    Bus bus(config_of(homes));
    keep(bus);
    bus.network.start_boot(bus.now);
    for (const int steps : {2, 10, 60, 60}) {
      bus.step(steps);
      keep(bus);
    }
    (void)bus.run_until([&] { return bus.network.boot().state != canopen::BootState::running; }, Duration::from_s(20));
    keep(bus);
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) bus.network.axis(i).request(homes ? AxisRequest::home : AxisRequest::hold_enabled);
    for (const int steps : {4, 10, 100}) {
      bus.step(steps);
      keep(bus);
    }
  }
  return all;
}

// What a drive may be told, by the orders that were given for it.
class OrderBook {
 public:
  void begin(const canopen::Axis& axis) {
    newest_ = axis.requested();
    running_ = runs(axis.controlword());
    enabled_ = enables(newest_) && axis.fault() == canopen::AxisFault::none;
  }

  // An order to enable counts when the axis took it; one to stop always does.
  void order(AxisRequest request, const canopen::Axis& axis) {
    if (enables(request) && axis.requested() != request) return;
    newest_ = request;
    enabled_ = enables(request);
    if (enabled_) after_stop_ = 0;
  }

  // After each tick. A latched fault is a stop, and so is the end of a homing.
  void see(const canopen::Axis& axis) {
    const bool homed = newest_ == AxisRequest::home && axis.requested() == AxisRequest::disable;
    if (axis.fault() == canopen::AxisFault::none && !homed) return;
    enabled_ = false;
  }

  // One RPDO to the drive, and what the drive said last.
  void check(const CanFrame& rpdo, const canopen::Axis& axis) {
    const bool runs_now = runs(rpdo.data[0]);
    expect(!runs_now || running_ || (enabled_ && axis.fault() == canopen::AxisFault::none),
           "a stopped drive is enabled by a fresh order only");
    running_ = runs_now;
    if (!runs_now || enabled_) return;
    ++after_stop_;
    expect(after_stop_ <= 3, "a stop is sent within three SYNCs");
    expect(newest_ != AxisRequest::remove_power, "power is removed at once");
    expect(newest_ != AxisRequest::quick_stop || !axis.runs(), "a drive in operation is told to quick stop at once");
  }

 private:
  static bool runs(std::uint32_t controlword) { return (controlword & 0x0FU) == 0x0FU; }
  static bool enables(AxisRequest request) { return request == AxisRequest::hold_enabled || request == AxisRequest::home; }

  AxisRequest newest_ = AxisRequest::disable;
  bool enabled_ = false;  // by an order since the last stop
  bool running_ = false;  // the newest RPDO says operation enabled
  int after_stop_ = 0;    // RPDOs that said so since the stop
};

class Session {
 public:
  Session(Network& network, Time now) : network_(network), now_(now) {
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) books_[i].begin(network.axis(i));
  }

  void run(Input& in) {
    while (!in.empty() && ticks_ < most_ticks) step(in);
    tick(4);
    std::size_t emcys = 0;
    while (network_.take_emcy()) ++emcys;
    expect(emcys <= 16, "no more EMCYs than are kept");
    (void)network_.operational();
    for (const auto& node : network_.boot().nodes) expect(node.state <= canopen::BootState::failed, "a boot has a state");
  }

 private:
  static constexpr int most_ticks = 400;

  void step(Input& in) {
    const std::uint8_t what = in.byte();
    const std::uint32_t more = what >> 3U;
    switch (what & 7U) {
      case 0: return receive(frame_of(in, in.byte(), more & 7U, static_cast<std::uint8_t>(in.byte() % 10U)));
      case 1: return receive(frame_of(in, 0x3, more % 7U, more % 7U == 6 ? (arm5e_joint::count + 1) : 8));  // TPDO 1
      case 2: return receive(frame_of(in, 0xE, more & 7U, 1));                                              // heartbeat
      case 3: return answer_sdo(in, more % 6U);
      case 4: return receive(more < 16 ? frame_of(in, 0x1, more & 7U, 8) : any_frame(in));  // EMCY
      case 5: return command(in, more);
      case 6: {
        static constexpr std::array<std::int32_t, 8> steps_ms{4, 4, 0, 1, 100, 350, 3000, -4};
        return tick(steps_ms[more & 7U]);
      }
      default:
        for (std::uint32_t i = 0; i <= more % 16; ++i) {
          if (more >= 16) answer_as_drives(in.byte());
          tick(4);
        }
    }
  }

  // Bit a joint: its drive obeys its newest RPDO; the others are all in one state, which the three high bits choose.
  void answer_as_drives(std::uint8_t what) {
    static constexpr std::array<std::uint8_t, 8> states{0x40, 0x21, 0x23, 0x27, 0x07, 0x0F, 0x08, 0x00};
    constexpr std::uint8_t remote_and_follows = 0x12;  // bits 9 and 12
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      const bool obeys = (what & (1U << i)) != 0;
      status_[i] = obeys ? obeyed(status_[i], told_[i].data[0]) : states[what >> 5U];
      CanFrame tpdo;
      tpdo.id = canopen::cob_id::tpdo1 + static_cast<std::uint32_t>(i + 1);
      tpdo.length = 8;
      tpdo.data = {status_[i], remote_and_follows, told_[i].data[2], told_[i].data[3], told_[i].data[4], told_[i].data[5], 0, 0};
      receive(tpdo);
    }
  }

  // CiA 402's transitions, as far as a drive takes them at once.
  static std::uint8_t obeyed(std::uint8_t status, std::uint8_t controlword) {
    const bool fault = (status & 0x08) != 0;
    if (fault) return (controlword & 0x80) != 0 ? 0x40 : 0x08;
    if ((controlword & 0x02) == 0) return 0x40;                          // disable voltage
    if ((controlword & 0x04) == 0) return status == 0x27 ? 0x07 : 0x40;  // quick stop
    switch (controlword & 0x0F) {
      case 0x06: return 0x21;
      case 0x07: return status == 0x40 ? 0x40 : 0x23;
      case 0x0F: return status == 0x40 || status == 0x21 ? status : 0x27;
      default: return status;
    }
  }

  void receive(const CanFrame& frame) {
    const std::uint64_t before = network_.stats().frames_in;
    network_.on_frame(frame, now_);
    expect(network_.stats().frames_in == before + 1, "every frame is counted");
  }

  // To the object that the master last asked this node for.
  void answer_sdo(Input& in, std::uint32_t node) {
    CanFrame answer = frame_of(in, 0xB, node + 1, 8);
    for (std::size_t i = 1; i < 4; ++i) answer.data[i] = asked_[node].data[i];
    receive(answer);
  }

  void command(Input& in, std::uint32_t which) {
    canopen::Axis& axis = network_.axis(which % arm5e_joint::count);
    switch (in.byte() % 12U) {
      case 0: network_.start_boot(now_); return write_down(AxisRequest::disable);
      case 1: network_.shut_down(); return write_down(AxisRequest::disable);
      case 2: network_.quick_stop_all(); return write_down(AxisRequest::quick_stop);
      case 3: network_.disable_all(); return write_down(AxisRequest::disable);
      case 4: network_.remove_power(); return write_down(AxisRequest::remove_power);
      case 5: return network_.acknowledge(which % (arm5e_joint::count + 1));
      case 6: return network_.io().set_outputs(in.byte());
      case 7: return (void)network_.io().trigger_camera(Duration::from_us(in.take<std::uint16_t>()));
      case 8: return (void)axis.set_target_counts(in.take<std::int32_t>());
      case 9: return axis.set_torque_offset_permille(in.take<std::int16_t>());
      default: {
        const auto request = static_cast<AxisRequest>(in.byte() % 6U);
        axis.request(request);
        return books_[which % arm5e_joint::count].order(request, axis);
      }
    }
  }

  void write_down(AxisRequest request) {
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) books_[i].order(request, network_.axis(i));
  }

  void tick(std::int32_t ms) {
    ++ticks_;
    now_ = now_ + Duration::from_ms(ms);
    canopen::Outbox outbox;
    network_.tick(now_, outbox);
    expect(outbox.size() <= 31 && network_.stats().outbox_overflows == 0, "a tick sends what it says it does");
    for (const CanFrame& frame : outbox) check(frame);
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      check(network_.axis(i));
      books_[i].see(network_.axis(i));
    }
  }

  void check(const CanFrame& frame) {
    namespace id = canopen::cob_id;
    const std::uint32_t function = id::function_of(frame.id & 0x7FFU), node = id::node_of(frame.id);
    const bool guard = (frame.id & CanFrame::remote_flag) != 0 && function == id::heartbeat;
    const bool own = frame.id == id::nmt || frame.id == id::sync || frame.id == id::heartbeat + can_map::master_node ||
                     ((function == id::rpdo1 || function == id::sdo_request) && node >= 1 && node <= (arm5e_joint::count + 1));
    expect(guard || own, "the master sends what is its own");
    expect(frame.length <= 8, "a frame has at most 8 bytes");
    if (guard) return;
    for (std::size_t i = frame.length; i < frame.data.size(); ++i) expect(frame.data[i] == 0, "what is not sent is 0");
    if (function == id::sdo_request) asked_[node - 1] = frame;
    if (function == id::rpdo1 && node <= arm5e_joint::count) told_[node - 1] = frame;
    if (function == id::rpdo1 && node <= arm5e_joint::count) books_[node - 1].check(frame, network_.axis(node - 1));
  }

  static void check(const canopen::Axis& axis) {
    expect(axis.state() <= canopen::AxisState::resetting && axis.fault() <= canopen::AxisFault::node_lost, "an axis has a state");
    expect(!axis.enabled() || (axis.fault() == canopen::AxisFault::none && axis.seen()), "an axis that follows is heard and well");
  }

  Network& network_;
  Time now_;
  int ticks_ = 0;
  PerJoint<OrderBook> books_;
  PerJoint<CanFrame> told_{};        // the newest RPDO
  PerJoint<std::uint8_t> status_{};  // the low byte of the statusword that was answered
  std::array<CanFrame, (arm5e_joint::count + 1)> asked_{};
};

}  // namespace
}  // namespace lf::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<lf::fuzz::Beginning> beginnings = lf::fuzz::make_beginnings();
  lf::fuzz::Input in(data, size);
  const lf::fuzz::Beginning& begin = beginnings[in.byte() % beginnings.size()];
  lf::canopen::Network network = begin.network;
  lf::fuzz::Session(network, begin.now).run(in);
  return 0;
}
