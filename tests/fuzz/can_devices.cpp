// Frames into a simulated node: the output node, and servo drives of every make. The drive turns a joint that weighs nothing.
//
// Held against: what a node sends is a frame of its own, and what it does to its joint is a number.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "hal/config/share.hpp"
#include "host_sim/devices/bus/can_bus.hpp"
#include "host_sim/devices/drive/drive402.hpp"
#include "host_sim/devices/drive/drive_dictionary.hpp"
#include "host_sim/devices/io_node.hpp"
#include "shared/arm/arm_description.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/fuzz/can_frames.hpp"

namespace lf::fuzz {
namespace {

using namespace devices;

constexpr Duration boot_time = Duration::from_ms(5);
constexpr int most_ticks = 600;

// The simulator's own drive on each joint, then the elbow with every other make.
std::vector<DriveConfig> all_drives() {
  const ArmDescription arm = load_arm_urdf((config::share_folder() / "arm" / "arm5e.urdf").string());
  std::vector<DriveConfig> all;
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) all.push_back(drive_config(arm.joints[i], static_cast<std::uint8_t>(i + 1)));
  const DriveConfig elbow = all[arm5e_joint::elbow];
  for (const DriveHabit& habit : drive_habits()) {
    DriveConfig drive = elbow;
    drive.habit = &habit;
    drive.dictionary = read_dictionary(config::share_folder() / "drives" / "objects.csv", habit.dictionary);
    drive.reversed = all.size() % 2 == 0;
    all.push_back(drive);
  }
  return all;
}

// A node of either kind, with what goes over its wire.
class Bench {
 public:
  explicit Bench(const DriveConfig* drive) {
    if (drive == nullptr) {
      io_.emplace(IoConfig{}, boot_time);
      io_->power_on(now_);
      return;
    }
    drive_.emplace(*drive, boot_time, 7);
    lower_rad_ = drive->lower_rad;
    upper_rad_ = drive->upper_rad;
    joint_.position_rad = joint_.motor_position_rad = 0.5 * (lower_rad_ + upper_rad_);
    drive_->power_on(now_, joint_);
  }

  Node& node() { return drive_ ? drive_->node() : io_->node(); }
  int ticks() const { return ticks_; }

  void receive(const CanFrame& frame) {
    node().receive(frame, now_);
    check_outbox();
  }
  void write(std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::uint8_t bytes) {
    CanFrame request;
    request.id = 0x600U + node().id();
    request.length = 8;
    request.data = {static_cast<std::uint8_t>(0x23 | ((4 - bytes) << 2)), static_cast<std::uint8_t>(index),
                    static_cast<std::uint8_t>(index >> 8), sub};
    for (std::size_t i = 0; i < 4; ++i) request.data[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
    receive(request);
  }
  void send(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
    CanFrame frame;
    frame.id = id;
    frame.length = static_cast<std::uint8_t>(data.size());
    std::copy(data.begin(), data.end(), frame.data.begin());
    receive(frame);
  }

  void tick(std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i, ++ticks_) {
      now_ = now_ + Duration::from_ms(1);
      if (drive_) turn(drive_->tick(now_, joint_));
      if (io_) io_->tick(now_);
      if (io_) (void)io_->take_exposure();
      check_outbox();
    }
  }

  void fault(std::uint8_t bits) {
    if (drive_) drive_->faults() = {(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0, (bits & 8U) != 0};
    if (io_) io_->set_estop_closed((bits & 1U) != 0);
    if (io_) io_->set_interlock_closed((bits & 2U) != 0);
  }

 private:
  void turn(const JointDrive& drive) {
    expect(std::isfinite(drive.velocity_rad_s) && std::isfinite(drive.torque_limit_nm) && drive.torque_limit_nm >= 0,
           "a drive does numbers");
    joint_.velocity_rad_s = drive.released ? 0 : drive.velocity_rad_s;
    joint_.position_rad = std::clamp(joint_.position_rad + 1e-3 * joint_.velocity_rad_s, lower_rad_, upper_rad_);
    joint_.motor_position_rad = joint_.position_rad;
  }
  void check_outbox() {
    std::vector<CanFrame>& outbox = node().outbox();
    for (const CanFrame& frame : outbox)
      expect(frame.id > 0x80 && frame.id <= 0x7FF && frame.length <= 8, "a node sends frames of its own");
    outbox.clear();
  }

  std::optional<Drive402> drive_;
  std::optional<IoNode> io_;
  JointReading joint_;
  double lower_rad_ = 0, upper_rad_ = 0;
  Time now_;
  int ticks_ = 0;
};

// As a master would: PDOs mapped, cyclic, started; `powered`: and up to operation enabled.
void set_up(Bench& bench, bool powered) {
  const std::uint32_t id = bench.node().id();
  const auto map = [&](std::uint16_t communication, std::uint32_t cob_id, std::initializer_list<std::uint32_t> entries) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    bench.write(communication, 1, cob_id | 0x80000000U, 4);
    bench.write(communication, 2, 1, 1);
    bench.write(mapping, 0, 0, 1);
    std::uint8_t sub = 0;
    for (const std::uint32_t entry : entries) bench.write(mapping, ++sub, entry, 4);
    bench.write(mapping, 0, sub, 1);
    bench.write(communication, 1, cob_id, 4);
  };
  map(0x1400, 0x200U + id, {0x60400010, 0x607A0020});
  map(0x1800, 0x40000180U + id, {0x60410010, 0x60640020, 0x60770010});
  bench.write(0x60C2, 1, 4, 1);
  bench.write(0x6060, 0, 8, 1);
  bench.send(0, {1, static_cast<std::uint8_t>(id)});
  if (!powered) return;
  const auto at =
      static_cast<std::uint32_t>(bench.node().objects().find(0x6064, 0) != nullptr ? bench.node().objects().at(0x6064).value : 0);
  for (const std::uint8_t word : {0x06, 0x07, 0x0F, 0x0F}) {
    bench.send(0x200U + id, {word, 0, static_cast<std::uint8_t>(at), static_cast<std::uint8_t>(at >> 8),
                             static_cast<std::uint8_t>(at >> 16), static_cast<std::uint8_t>(at >> 24)});
    bench.send(0x80, {});
    bench.tick(4);
  }
}

void step(Bench& bench, Input& in) {
  const std::uint8_t what = in.byte();
  const std::uint32_t more = what >> 3U, id = bench.node().id();
  switch (what & 7U) {
    case 0: {
      CanFrame frame = any_frame(in);
      frame.length = std::min<std::uint8_t>(frame.length, 8);  // as a bus has them
      return bench.receive(frame);
    }
    case 1: return bench.receive(frame_of(in, 0xC, id, 8));                                                        // SDO
    case 2: return bench.receive(frame_of(in, 4U + 2U * (more >> 4U), id, static_cast<std::uint8_t>(more % 9U)));  // RPDO 1, 2
    case 3: return bench.receive(frame_of(in, 0, 0, 2));                                                           // NMT
    case 4: {
      bench.receive(frame_of(in, 4, id, 6));
      bench.send(0x80, {});
      return bench.tick(4);
    }
    case 5: return more < 8 ? bench.fault(in.byte()) : bench.send(0x77F, {5});
    case 6: {
      CanFrame guard;
      guard.id = CanFrame::remote_flag | (0x700U + id);
      guard.length = 1;
      if (more < 4) bench.receive(guard);
      return bench.send(0x80, {});
    }
    default: return bench.tick(more < 24 ? more + 1 : 100);
  }
}

// The bus alone: frames of several senders, on their way one by one.
void bus_alone(Input& in) {
  CanBus bus;
  Time now;
  std::uint64_t sent = 0, passed = 0;
  while (!in.empty()) {
    const std::uint8_t what = in.byte();
    CanFrame frame = any_frame(in);
    frame.length = std::min<std::uint8_t>(frame.length, 8);
    if ((what & 8U) != 0) bus.set_error_frames((what & 16U) != 0);
    if ((what & 32U) != 0) bus.set_bus_off(what & 7U, (what & 16U) != 0);
    sent += bus.send(what & 7U, frame, now) ? 1 : 0;
    now = now + Duration::from_us(what);
    BusRecord record;
    while (bus.next(now, record)) {
      ++passed;
      expect(record.delivered <= now, "a frame comes in its time");
    }
  }
  expect(passed <= sent, "no frame is made up");
}

}  // namespace
}  // namespace lf::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<lf::devices::DriveConfig> drives = lf::fuzz::all_drives();
  lf::fuzz::Input in(data, size);
  const std::uint8_t which = in.byte(), begin = in.byte();
  if (which == 0xFF) {
    lf::fuzz::bus_alone(in);
    return 0;
  }
  const std::size_t choice = which % (drives.size() + 1);
  lf::fuzz::Bench bench(choice < drives.size() ? &drives[choice] : nullptr);
  bench.tick(10);
  if (begin % 3 != 0) lf::fuzz::set_up(bench, begin % 3 == 2);
  while (!in.empty() && bench.ticks() < lf::fuzz::most_ticks) lf::fuzz::step(bench, in);
  bench.tick(10);
  return 0;
}
