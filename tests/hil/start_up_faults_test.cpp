// Every call of every port fails once over the mission's start-up, each in a run of its own, and for good from there on: the mission goes on or ends safely.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "tests/hil/rig.hpp"

namespace lf::test {
namespace {

using hal::Call;
using mission::Step;

struct PortCall {
  Call call;
  Port port;
  const char* name;
};

// What the control turn and the vision turn call from the first tick on; the panel's question comes later and has a test of its own.
constexpr std::array<PortCall, 6> start_up_calls{{{Call::wait_for_tick, Port::clock, "wait_for_tick"},
                                                  {Call::receive_can, Port::can_receive, "receive_can"},
                                                  {Call::send_can, Port::can_send, "send_can"},
                                                  {Call::receive_image, Port::camera, "receive_image"},
                                                  {Call::receive_panel, Port::panel_receive, "receive_panel"},
                                                  {Call::publish, Port::telemetry, "publish"}}};

constexpr hal::PortStatus io_error = 5;  // EIO
// Boot, enable and home may take 15 s, 5 s and 30 s, each three times.
constexpr double longest_start_up_s = 3 * (15 + 5 + 30) + 1;
// Beyond these the calls of one port look the same: nodes one after the other.
constexpr std::uint64_t every_call_up_to = 40;

// The calls of each port until the arm starts to deploy.
std::array<std::uint64_t, hal::call_count> calls_of_a_start_up() {
  Rig rig;
  rig.start();
  EXPECT_TRUE(rig.run_to(Step::deploy, longest_start_up_s)) << rig.story();
  std::array<std::uint64_t, hal::call_count> calls{};
  for (std::size_t i = 0; i < calls.size(); ++i) calls[i] = rig.ports().calls(static_cast<Call>(i));
  return calls;
}

// The mission cannot do without its clock and its bus; every other port may fail for good.
bool needed(Call call) { return call == Call::wait_for_tick || call == Call::send_can || call == Call::receive_can; }

void expect_safe(Rig& rig, Call call) {
  if (rig.outcome().ended) {
    EXPECT_FALSE(rig.outcome().success);
    const bool clock = call == Call::wait_for_tick;
    EXPECT_EQ(rig.outcome().fault, clock ? safety::Fault::clock_lost : safety::Fault::bus_off) << rig.story();
    const Port port = call == Call::send_can ? Port::can_send : Port::can_receive;
    EXPECT_TRUE(clock || rig.outcome().code == static_cast<std::int32_t>(port)) << rig.story();
    // A master that nobody hears is missed after 0.3 s; then comes the drives' own quick stop.
    rig.run_for(0.6);
    EXPECT_LT(rig.fastest_joint_rad_s(), 0.02);
  } else {
    EXPECT_EQ(rig.step_now(), Step::deploy);
  }
  EXPECT_FALSE(rig.devices().laser_on());
  EXPECT_EQ(rig.controller().port_errors()[static_cast<std::size_t>(Port::scan_ring)], 0u);
}

int boots(const Rig& rig) {
  return static_cast<int>(std::count_if(rig.events().begin(), rig.events().end(),
                                        [](const Event& event) { return event.kind == Event::Kind::step && event.step == Step::boot; }));
}

class StartUp : public testing::TestWithParam<PortCall> {};

TEST_P(StartUp, GoesOnOrEndsSafelyWhenOneCallFails) {
  const PortCall& what = GetParam();
  const std::uint64_t calls = calls_of_a_start_up()[static_cast<std::size_t>(what.call)];
  ASSERT_GT(calls, every_call_up_to);
  const std::uint64_t stride = calls / 40;
  int went_on = 0, runs = 0;
  for (std::uint64_t n = 0; n < calls; n += n < every_call_up_to ? 1 : stride) {
    SCOPED_TRACE(std::string(what.name) + ", call " + std::to_string(n) + " of " + std::to_string(calls));
    Rig rig;
    rig.ports().fail(what.call, n, io_error);
    rig.start();
    const bool there = rig.run_to(Step::deploy, longest_start_up_s);
    EXPECT_TRUE(there || rig.outcome().ended) << rig.story();
    EXPECT_EQ(rig.controller().port_errors()[static_cast<std::size_t>(what.port)], 1u);
    expect_safe(rig, what.call);
    // What got lost is asked for again; the nodes that were configured stay so.
    EXPECT_LE(boots(rig), 1) << rig.story();  // none where it was its record that failed
    went_on += there;
    ++runs;
    if (HasFailure()) return;
  }
  EXPECT_EQ(went_on, runs) << "one failed call is no reason to give up";
}

TEST_P(StartUp, GoesOnOrEndsSafelyWhenAPortFailsForGood) {
  const PortCall& what = GetParam();
  const std::uint64_t calls = calls_of_a_start_up()[static_cast<std::size_t>(what.call)];
  constexpr std::uint64_t never = ~std::uint64_t{0};
  for (const double part : {0.0, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97}) {
    const auto n = static_cast<std::uint64_t>(part * static_cast<double>(calls));
    SCOPED_TRACE(std::string(what.name) + ", from call " + std::to_string(n) + " of " + std::to_string(calls));
    Rig rig;
    rig.ports().fail(what.call, n, io_error, never);
    rig.start();
    EXPECT_NE(rig.run_to(Step::deploy, longest_start_up_s), needed(what.call)) << rig.story();
    EXPECT_EQ(rig.outcome().ended, needed(what.call)) << rig.story();
    EXPECT_EQ(rig.controller().port_errors()[static_cast<std::size_t>(what.port)], rig.ports().failed());
    expect_safe(rig, what.call);
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(EveryPort, StartUp, testing::ValuesIn(start_up_calls),
                         [](const testing::TestParamInfo<PortCall>& test) { return std::string(test.param.name); });

// Without the bus nothing moves, and the mission says so.
TEST(StartUpWithoutABus, EndsOff) {
  Rig rig;
  rig.ports().fail(Call::send_can, 0, io_error, ~std::uint64_t{0});
  rig.start();
  ASSERT_TRUE(rig.run_to_end(longest_start_up_s));
  EXPECT_EQ(rig.step_now(), Step::off) << rig.story();
  EXPECT_EQ(rig.outcome().fault, safety::Fault::bus_off) << rig.story();
}

TEST(FirstSight, ComesBackAfterALostQuestion) {
  Rig rig;
  rig.ports().fail(Call::submit_panel, 0, io_error);
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::reach_valve)) << rig.story();
  EXPECT_EQ(rig.controller().port_errors()[static_cast<std::size_t>(Port::panel_submit)], 1u);
  EXPECT_EQ(rig.count(safety::Fault::vision_late), 1u);
}

TEST(FirstSight, EndsStowedWhenNoQuestionCanBeAsked) {
  Rig rig;
  rig.ports().fail(Call::submit_panel, 0, io_error, ~std::uint64_t{0});
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, safety::Fault::vision_late);
}

// The port is asked every tick. What could not be read stays in the camera and comes late.
TEST(FirstSight, BearsACameraThatCannotBeReadForAWhile) {
  Rig rig;
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::scan)) << rig.story();
  constexpr std::uint32_t ticks = 200;  // 20 pictures
  rig.ports().fail(Call::receive_image, rig.ports().calls(Call::receive_image), io_error, ticks);
  ASSERT_TRUE(rig.run_to(Step::reach_valve)) << rig.story();
  EXPECT_EQ(rig.controller().port_errors()[static_cast<std::size_t>(Port::camera)], ticks);
}

}  // namespace
}  // namespace lf::test
