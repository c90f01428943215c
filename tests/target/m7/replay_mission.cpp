// Flies a mission recorded on x86-64 again: the same control turn, with the record's frames in and its frames expected out.
// Arguments: the file of tests/target/record_mission.cpp. Exit status 1 when an answer differs.
#include <algorithm>
#include <array>
#include <cmath>
#include <new>

#include "hal/core_loop.hpp"
#include "hal/heap_guard/heap_guard.hpp"
#include "tests/target/record.hpp"
#include "tests/target/same_everywhere.hpp"
#include "toolchain/cortex_m7/instruction_counter.hpp"
#include "toolchain/cortex_m7/semihosting.hpp"
#include "toolchain/cortex_m7/stack_use.hpp"

// There is no heap here to be guarded.
lf::hal::CoreSection::CoreSection() = default;
lf::hal::CoreSection::~CoreSection() = default;

namespace lf::test {
namespace {

using m7::print, m7::print_number;

class Reader : public RecordStream {
 public:
  explicit Reader(m7::HostFile& file) : file_(file) {}
  void bytes(void* into, std::size_t size) {
    if (!file_.read(into, size)) m7::fail("the record ends too early");
  }
  void broken() { m7::fail("the record is broken"); }

 private:
  m7::HostFile& file_;
};

// Gives what was recorded, and compares what the controller answers.
class Replay : public hal::Unattended {
 public:
  explicit Replay(Reader& reader) : reader_(reader) {}

  hal::PortStatus wait_for_tick(Time& t) {
    t = tick_.t;
    return hal::port_ok;
  }
  hal::PortStatus receive_can(std::uint8_t, hal::ReceivedFrame& received) {
    if (next_ == tick_.received.size()) return hal::port_empty;
    received = {tick_.received[next_].frame, tick_.received[next_].t};
    ++next_;
    return hal::port_ok;
  }
  hal::PortStatus send_can(std::uint8_t, std::span<const CanFrame> frames) {
    frames_ += static_cast<std::uint32_t>(tick_.sent.size());
    if (!std::equal(frames.begin(), frames.end(), tick_.sent.begin(), tick_.sent.end())) differ("CAN frames");
    return hal::port_ok;
  }
  hal::PortStatus receive_image(std::uint8_t, Image&) { return hal::port_empty; }
  hal::PortStatus submit_panel(const PanelRequest&, ImageView, std::span<const CloudPoint>) { return hal::port_ok; }
  hal::PortStatus receive_panel(PanelResult& result) {
    if (tick_.panel.empty()) return hal::port_empty;
    result = tick_.panel[0];
    return hal::port_ok;
  }
  hal::PortStatus publish(const Telemetry& telemetry) {
    if (telemetry.step != tick_.step || telemetry.events.size() != tick_.events) differ("the mission's step or its events");
    return hal::port_ok;
  }

  // The next tick of the record; what vision said before it goes to the ring.
  void load(hal::CoreRings& rings) {
    pass(reader_, tick_);
    next_ = 0;
    for (const ScanStats& stats : tick_.stats) rings.scan_stats.push(stats);
  }
  // What the tick ordered of the scan; joints are radians of counts.
  void check_orders(hal::CoreRings& rings) {
    std::size_t i = 0;
    for (ScanCommand order; rings.scan_commands.pop(order); ++i) {
      if (i >= tick_.orders.size()) return differ("more orders to the scan");
      const ScanCommand& there = tick_.orders[i];
      bool same = order.kind == there.kind && order.joints.t == there.joints.t && order.exposure_start == there.exposure_start &&
                  order.exposure_kind == there.exposure_kind && order.trigger == there.trigger && order.sweep == there.sweep;
      for (std::size_t j = 0; j < order.joints.q_rad.size(); ++j)
        same = same && std::abs(order.joints.q_rad[j] - there.joints.q_rad[j]) < 1e-12;
      if (!same) differ("an order to the scan");
    }
    if (i != tick_.orders.size()) differ("fewer orders to the scan");
  }
  bool last() const { return tick_.last != 0; }
  std::uint32_t frames() const { return frames_; }
  std::uint32_t differences() const { return differences_; }

 private:
  void differ(const char* what) {
    constexpr std::uint32_t most_printed = 20;
    if (++differences_ > most_printed) return;
    print_number(tick_.t.s(), 3);
    print(" s: differs in ");
    print(what);
    print("\n");
  }

  Reader& reader_;
  RecordedTick tick_;
  std::size_t next_ = 0;
  std::uint32_t frames_ = 0, differences_ = 0;
};
static_assert(hal::Platform<Replay>);

// Instructions of each control turn, in classes of 500.
class TurnCounter {
 public:
  void begin() { counter_.start(); }
  void end() {
    const std::uint64_t n = counter_.stop();
    ++turns_;
    sum_ += n;
    most_ = std::max(most_, n);
    ++classes_[std::min<std::uint64_t>(n / width, classes_.size() - 1)];
  }
  std::uint32_t turns() const { return turns_; }
  std::uint64_t mean() const { return turns_ > 0 ? sum_ / turns_ : 0; }
  std::uint64_t most() const { return most_; }
  std::uint64_t quantile(double share) const {
    std::uint32_t below = 0;
    for (std::size_t i = 0; i < classes_.size(); ++i) {
      below += classes_[i];
      if (below >= share * turns_) return (i + 1) * width;
    }
    return most_;
  }

 private:
  static constexpr std::uint64_t width = 500;
  m7::InstructionCounter counter_;
  std::array<std::uint32_t, 4096> classes_{};
  std::uint32_t turns_ = 0;
  std::uint64_t sum_ = 0, most_ = 0;
};

// The control side has to fit the memory beside the processor; what it shares with the vision side does not.
alignas(Controller) unsigned char controller_place[sizeof(Controller)];
// Of 64 KiB of tightly coupled memory; 24 are left for stack and outputs.
constexpr std::size_t budget = 40 * 1024;
static_assert(sizeof(Controller) + sizeof(ControllerConfig) <= budget);
TickOutput out;
LANTERNFISH_EXTERNAL_MEMORY hal::CoreRings rings;
LANTERNFISH_EXTERNAL_MEMORY TurnCounter turns;

int run() {
  char path[512];
  if (!m7::argument(1, path, sizeof path)) m7::fail("no record named");
  LANTERNFISH_EXTERNAL_MEMORY static m7::HostFile file(path);
  if (!file.open()) m7::fail("the record cannot be opened");
  Reader reader(file);
  LANTERNFISH_EXTERNAL_MEMORY static Replay platform(reader);
  new (&turns) TurnCounter;
  new (&rings) hal::CoreRings;

  std::uint32_t magic = 0;
  static ControllerConfig config;
  pass_all(reader, magic, config);
  if (magic != record_magic) m7::fail("this is no recorded mission");
  auto& controller = *new (controller_place) Controller(config);
  Time now;
  controller.on_command(Command::start, now);
  do {
    platform.load(rings);
    (void)hal::control_turn(platform, controller, rings, out, now, turns);
    platform.check_orders(rings);
  } while (!platform.last());

  print_number(now.s(), 1);
  print(" s of mission, ");
  print_number(turns.turns());
  print(" control turns, ");
  print_number(platform.frames());
  print(" frames sent, ");
  print_number(platform.differences());
  print(" turns that differ from x86-64\ninstructions a turn: mean ");
  print_number(static_cast<double>(turns.mean()));
  print(", p99 ");
  print_number(static_cast<double>(turns.quantile(0.99)));
  print(", p99.9 ");
  print_number(static_cast<double>(turns.quantile(0.999)));
  print(", most ");
  print_number(static_cast<double>(turns.most()));
  print("\nstack used: ");
  print_number(static_cast<double>(m7::stack_used_bytes()));
  print(" of ");
  print_number(static_cast<double>(m7::stack_bytes()));
  print(" bytes\nsizeof(Controller) = ");
  print_number(sizeof(Controller));
  print(", sizeof(ControllerConfig) = ");
  print_number(sizeof(ControllerConfig));
  print(" of ");
  print_number(budget);
  print(" bytes\n");
  if (!controller.mission().outcome().success) m7::fail("the mission did not end in success");
  return platform.differences() > 0 ? 1 : 0;
}

}  // namespace
}  // namespace lf::test

int main() { return lf::test::run(); }
