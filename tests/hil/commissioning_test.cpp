// Commissioning on the simulated arm: the drives' absolute encoders count from anywhere, and afterwards the core knows where the joints stand.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/arm5e.hpp"
#include "tests/arm5e_joint_names.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/commissioning_bench.hpp"

namespace lf::test {
namespace {

using hal::Commissioning;
using Bench = CommissioningBench;

void expect_found(const Bench& bench, const Commissioning& commissioning) {
  ASSERT_EQ(commissioning.state(), Commissioning::State::done) << commissioning.failure();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    EXPECT_TRUE(commissioning.found()[i]) << arm5e_joint::name(i);
    EXPECT_LE(std::abs(bench.error_rad(i, commissioning.zero_counts()[i])), bench.tolerance_rad(i)) << arm5e_joint::name(i);
  }
}

class CommissioningFrom : public testing::TestWithParam<Angles> {};

TEST_P(CommissioningFrom, FindsEveryZero) {
  Bench bench(somewhere, GetParam());
  Commissioning commissioning(bench.config());
  bench.run(commissioning);
  expect_found(bench, commissioning);
}

INSTANTIATE_TEST_SUITE_P(AnyPlace, CommissioningFrom,
                         testing::Values(parked, Angles{-1.2, 1.3, 0.4, 2.9, 1.2}, Angles{0.5, 0.05, 1.0, -3.0, 0.0},
                                         Angles{-1.57, 0.001, 0.001, -3.14, 1.337}),
                         [](const testing::TestParamInfo<Angles>& test) { return "Number" + std::to_string(test.index); });

// Drives whose friction is not what the core takes it for, and whose efficiencies are as drawn. The viscous part is three times or a fifth of what the core
// believes: who keeps the belief, or finds none, is beyond the tolerance.
TEST(CommissionedArm, HasItsFrictionFound) {
  const auto viscous_share = [](std::size_t joint) { return joint % 2 == 0 || joint == 3 ? 3.0 : 0.2; };
  Bench bench(somewhere, parked, {}, [&](hal::SimConfig& truth) {
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      devices::GearFriction& friction = truth.devices.drives[i].friction;
      friction.coulomb_nm *= i % 2 == 0 ? 1.2 : 0.8;
      friction.viscous_nm_s *= viscous_share(i);
    }
  });
  Commissioning commissioning(bench.config());
  bench.run(commissioning);
  ASSERT_EQ(commissioning.state(), Commissioning::State::done) << commissioning.failure();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    ASSERT_TRUE(commissioning.friction_found()[i]) << arm5e_joint::name(i);
    const config::JointFriction& found = commissioning.friction()[i];
    const devices::DriveConfig& drive = bench.drive(i);
    // A count of the roll is 3 mrad: at a creep it stands between counts, and its gear breaks away again and again. It is found 24 % too large, the others to 1.5 %.
    const bool stops = i == 3;
    EXPECT_NEAR(1e-3 * found.coulomb_mnm, drive.friction.coulomb_nm, (stops ? 0.3 : 0.03) * drive.friction.coulomb_nm)
        << arm5e_joint::name(i);
    // At the top speed the viscous friction that the core believes in is 4 % of the rated torque; the true one, 12 % or 0.8 %, is found to 2 %, the roll's to 4 %.
    const double top_rad_s = 0.04 * drive.rated_torque_nm / bench.nominal().controller.transmissions[i].friction.viscous_nm_s;
    EXPECT_NEAR(1e-3 * found.viscous_mnm_s * top_rad_s, drive.friction.viscous_nm_s * top_rad_s,
                (stops ? 0.04 : 0.02) * drive.rated_torque_nm)
        << arm5e_joint::name(i);
    EXPECT_LT(found.rms_mnm, 20 * drive.rated_torque_nm) << arm5e_joint::name(i) << ": 2 % of the rated torque";
    // The doubt shrinks to what the fit left, and a twentieth for another day.
    arm::Friction told = bench.nominal().controller.transmissions[i].friction;
    const double before = told.doubt;
    config::HomingOffsets offsets;
    offsets.friction_known[i] = true;
    offsets.friction[i] = found;
    config::set_friction(offsets, i, told);
    EXPECT_LT(told.doubt, before) << arm5e_joint::name(i);
    EXPECT_NEAR(told.doubt * told.coulomb_nm, 0.05 * told.coulomb_nm + 1e-3 * found.rms_mnm, 1e-9) << arm5e_joint::name(i);
  }
}

// The whole way: found, written, read, and the core's angles are the arm's.
TEST(CommissionedArm, IsWhereTheCoreTakesItToBe) {
  Bench bench(somewhere);
  Commissioning commissioning(bench.config());
  bench.run(commissioning);
  ASSERT_EQ(commissioning.state(), Commissioning::State::done) << commissioning.failure();
  const std::string file = std::filesystem::temp_directory_path() / ("lanternfish_homing_" + std::to_string(getpid()) + ".yaml");
  config::HomingOffsets found;
  found.zero_counts = commissioning.zero_counts();
  found.known = commissioning.found();
  config::write_homing_file(file, found);
  const config::HomingOffsets read = config::read_homing_file(file, {});
  std::filesystem::remove(file);

  ControllerConfig config = bench.nominal().controller;
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) config.network.drives[i].encoder_zero_counts = read.zero_counts[i];
  hal::Lockstep<hal::SimPlatform> lockstep(bench.platform(), config, bench.nominal().scan);
  lockstep.step();
  ASSERT_TRUE(lockstep.controller().on_command(Command::home, lockstep.now()));
  for (int i = 0; i < 5000 && lockstep.controller().mission().step() != mission::Step::ready; ++i) lockstep.step();
  ASSERT_EQ(lockstep.controller().mission().step(), mission::Step::ready);
  for (int i = 0; i < 250; ++i) lockstep.step();
  EXPECT_EQ(lockstep.controller().mission().step(), mission::Step::ready) << "it stands within its limits after commissioning";
  EXPECT_EQ(lockstep.controller().mission().joints().valid, true);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    const double told = lockstep.controller().mission().joints().position_rad[i];
    const JointReading truth = bench.platform().world().readings()[i];
    EXPECT_NEAR(told, truth.motor_position_rad, bench.tolerance_rad(i)) << arm5e_joint::name(i);
    EXPECT_NEAR(told, truth.position_rad, 0.003) << arm5e_joint::name(i) << ", which its load may bend";
    const double left_rad = i == 4 ? test::arm5e.model().joints[4].lower_rad : parked[i];
    EXPECT_NEAR(truth.position_rad, left_rad, 0.01) << arm5e_joint::name(i) << ", back where it was, and the jaw closed";
  }
}

TEST(CommissioningOfOneJoint, MovesNoOther) {
  Bench bench(somewhere);
  Commissioning::Config config = bench.config();
  config.joints = {false, false, true, false, false};
  Commissioning commissioning(config);
  bench.run(commissioning);
  ASSERT_EQ(commissioning.state(), Commissioning::State::done) << commissioning.failure();
  EXPECT_EQ(commissioning.found(), (PerJoint<bool>{false, false, true, false, false}));
  EXPECT_LE(std::abs(bench.error_rad(2, commissioning.zero_counts()[2])), bench.tolerance_rad(2));
  for (const std::size_t other : {0u, 1u, 3u, 4u}) EXPECT_NEAR(bench.angles()[other], parked[other], 0.005);
  EXPECT_NEAR(bench.angles()[2], parked[2], 0.01) << "back where it was";
}

// 25 mm are open between the pads: a handle may be there.
constexpr Angles holding{0, 0.60, 1.90, 0, 0.06};

TEST(CommissioningWithSomethingInTheJaw, OpensAndClosesTheJawBeforeTheArmMoves) {
  Bench bench(somewhere, holding);
  Commissioning commissioning(bench.config());
  const double open_rad = test::arm5e.model().joints[4].upper_rad - 0.3, closed_rad = test::arm5e.model().joints[4].lower_rad + 0.01;
  bool opened = false, closed = false;
  bench.run(commissioning, [&] {
    opened = opened || bench.angles()[4] > open_rad;
    closed = closed || (opened && bench.angles()[4] < closed_rad);
    for (std::size_t i = 0; i < arm5e_joint::of_arm && !closed; ++i) EXPECT_NEAR(bench.angles()[i], holding[i], 0.005);
    return false;
  });
  expect_found(bench, commissioning);
  EXPECT_LT(bench.angles()[4], closed_rad) << "and it stays closed";
  for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) EXPECT_TRUE(commissioning.friction_found()[i]);
}

// The arm stands so that the valve's bar is between the fingers: opened, they close on it again.
TEST(CommissioningWithSomethingInTheJaw, MovesNoArmJointWhereTheJawDoesNotClose) {
  Bench bench(somewhere, holding);
  bench.platform().block_jaw(arm::jaw_from_gap(test::jaw5e, 0.0126), test::arm5e.model().joints[4].upper_rad);
  Commissioning commissioning(bench.config());
  bench.run(commissioning);
  EXPECT_EQ(commissioning.state(), Commissioning::State::failed);
  EXPECT_NE(commissioning.failure().find("jaw: something is between its fingers"), std::string_view::npos) << commissioning.failure();
  for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) EXPECT_NEAR(bench.angles()[i], holding[i], 0.005);
  EXPECT_GT(bench.angles()[4], 0.9) << "it has opened again";
  EXPECT_FALSE(bench.any_powered());
}

TEST(CommissioningWithSomethingInTheJaw, MovesNoArmJointWithoutTheJaw) {
  struct Jaw {
    bool known;
    double rad;
    const char* why;  // nothing: it is done
  };
  const double shut_rad = test::arm5e.model().joints[4].lower_rad + 0.004;
  for (const Jaw& jaw : {Jaw{true, 0.06, "the jaw is not closed"}, Jaw{true, 0.30, "the jaw is not closed"}, Jaw{true, shut_rad, nullptr},
                         Jaw{false, shut_rad, "nobody knows whether the jaw is empty"}}) {
    SCOPED_TRACE(jaw.rad);
    Angles start = holding;
    start[4] = jaw.rad;
    Bench bench(somewhere, start);
    Commissioning::Config config = bench.config();
    config.joints = {false, false, false, true, false};
    config.jaw_known = jaw.known;
    Commissioning commissioning(config);
    bool powered = false;
    bench.run(commissioning, [&] {
      powered = powered || bench.any_powered();
      return powered;  // that it begins is enough
    });
    EXPECT_EQ(powered, jaw.why == nullptr);
    EXPECT_NE(commissioning.failure().find(jaw.why != nullptr ? jaw.why : "called off"), std::string_view::npos) << commissioning.failure();
    EXPECT_FALSE(bench.any_powered());
  }
}

// What was taken for a joint's stop may have been something else: with the zero that this gives nothing moves, whether other joints follow or not. The zero that
// it is compared with is the core's, or one that the homing file has, a doubtful one for instance.
struct FoundElsewhere {
  const char* name;
  bool alone, in_core, ordered;
};
class CommissioningOfAJointThatIsFoundElsewhere : public testing::TestWithParam<FoundElsewhere> {};
INSTANTIATE_TEST_SUITE_P(Jaw, CommissioningOfAJointThatIsFoundElsewhere,
                         testing::Values(FoundElsewhere{"BeforeOthers", false, true, false}, FoundElsewhere{"Alone", true, true, false},
                                         FoundElsewhere{"AloneThanTheFileHasIt", true, false, false},
                                         FoundElsewhere{"AsTheOrderSays", true, true, true},
                                         FoundElsewhere{"ThanTheFileHasItAsTheOrderSays", true, false, true}),
                         [](const testing::TestParamInfo<FoundElsewhere>& test) { return test.param.name; });

TEST_P(CommissioningOfAJointThatIsFoundElsewhere, FailsAndMovesNoOther) {
  const FoundElsewhere& elsewhere = GetParam();
  Bench bench(somewhere);
  Commissioning::Config config = bench.config();
  canopen::DriveSetup& jaw = config.network.drives[4];
  jaw.encoder_zero_counts -= 700;
  jaw.zero_known = elsewhere.in_core;
  if (!elsewhere.in_core) config.zero_in_file[4] = jaw.encoder_zero_counts;
  if (elsewhere.alone) config.joints = {false, false, false, false, true};
  config.moved = elsewhere.ordered;
  Commissioning commissioning(config);
  bench.run(commissioning);
  EXPECT_EQ(commissioning.state(), elsewhere.ordered ? Commissioning::State::done : Commissioning::State::failed)
      << commissioning.failure();
  EXPECT_NEAR(commissioning.moved_rad()[4], 700 * arm::rad_per_count(test::arm5e.joint(arm5e_joint::jaw), 0), 0.005);
  if (!elsewhere.ordered) {
    const std::string failure(commissioning.failure());
    EXPECT_NE(failure.find("jaw: its zero was found 0.38 rad from where it was"), std::string::npos) << failure;
    EXPECT_NE(failure.find("alone with --moved"), std::string::npos) << failure;
  }
  for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) EXPECT_NEAR(bench.angles()[i], parked[i], 0.005);
  EXPECT_FALSE(bench.any_powered());
}

// Wherever the arm stands is its zero then.
TEST(CommissioningInAJig, MovesNothing) {
  Bench bench(somewhere);
  Commissioning::Config setup = bench.config();
  setup.here = true;
  setup.network.drives[4].zero_known = false;  // the jaw stands elsewhere than at 0
  Commissioning commissioning(setup);
  bench.run(commissioning);
  ASSERT_EQ(commissioning.state(), Commissioning::State::done) << commissioning.failure();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    const auto joint = i;
    EXPECT_TRUE(commissioning.found()[i]);
    EXPECT_NEAR(bench.angles()[i], parked[i], 0.003) << arm5e_joint::name(i);
    const double counts =
        commissioning.zero_counts()[i] - somewhere[i] - arm::exact_counts_from_rad(test::arm5e.joint(joint), bench.angles()[i]);
    EXPECT_LT(std::abs(counts) * arm::rad_per_count(test::arm5e.joint(joint), bench.angles()[i]),
              bench.tolerance_rad(i) + bench.backlash_rad()[i])
        << arm5e_joint::name(i);
  }
}

// The arm does not stand in the jig as it should, or not in it at all.
TEST(CommissioningInAJig, FailsWhereAZeroIsFoundElsewhere) {
  Bench bench(somewhere);
  Commissioning::Config setup = bench.config();
  setup.here = true;
  setup.network.drives[4].zero_known = false;
  setup.network.drives[3].zero_known = true;
  setup.network.drives[3].encoder_zero_counts = somewhere[3] + arm::counts_from_rad(test::arm5e.joint(arm5e_joint::roll), 0.1);
  Commissioning commissioning(setup);
  bench.run(commissioning);
  EXPECT_EQ(commissioning.state(), Commissioning::State::failed);
  EXPECT_NE(commissioning.failure().find("roll: its zero was found 0.10 rad from where it was"), std::string_view::npos)
      << commissioning.failure();
}

// A frozen reading looks like a stop; but what stands at a stop presses.
TEST(CommissioningWithAStuckEncoder, FindsNoZero) {
  devices::DeviceFault stuck;
  stuck.kind = devices::DeviceFaultKind::stuck_encoder;
  stuck.node = can_map::drive_nodes[2];
  stuck.at_s = 0.01;
  Bench bench(somewhere, parked, {stuck});
  Commissioning::Config config = bench.config();
  config.joints = {false, false, true, false, false};
  Commissioning commissioning(config);
  bench.run(commissioning);
  EXPECT_EQ(commissioning.state(), Commissioning::State::failed);
  EXPECT_NE(commissioning.failure().find("elbow"), std::string_view::npos) << commissioning.failure();
  EXPECT_FALSE(commissioning.found()[2]);
}

TEST(CommissioningCalledOff, StopsAndEndsWithoutPower) {
  Bench bench(somewhere);
  Commissioning::Config config = bench.config();
  config.joints = {false, false, true, false, false};
  Commissioning commissioning(config);
  int ticks = 0;
  bench.run(commissioning, [&] { return commissioning.state() == Commissioning::State::seeking && ++ticks > 250; });
  EXPECT_EQ(commissioning.state(), Commissioning::State::failed);
  EXPECT_EQ(commissioning.failure(), "it was called off");
  EXPECT_TRUE(commissioning.without_power());
  EXPECT_FALSE(bench.any_powered());
  EXPECT_FALSE(commissioning.found()[2]);
  const double stood = bench.angles()[2];
  EXPECT_LT(stood, parked[2] - 0.02) << "it had not begun";
  for (int i = 0; i < 100; ++i) {
    Time now;
    (void)bench.platform().wait_for_tick(now);
  }
  EXPECT_NEAR(bench.angles()[2], stood, 0.002);
}

// What befalls the elbow while it seeks its stop.
struct Incident {
  Time at, unpowered;
  double until_unpowered_s() const { return (unpowered - at).s(); }
};
Incident interrupt(Bench& bench, Commissioning& commissioning, bool call_off, const std::function<void(Time)>& happen) {
  Incident incident;
  int ticks = 0;
  bench.run(commissioning, [&] {
    const Time now = bench.platform().now();
    const bool happened = incident.at != Time{};
    if (happened && incident.unpowered == Time{} && !bench.any_powered()) incident.unpowered = now;
    if (!happened && commissioning.state() == Commissioning::State::seeking && ++ticks > 250) {
      incident.at = now;
      happen(now);
    }
    return call_off && incident.at != Time{};
  });
  return incident;
}

// Somebody takes the elbow out of operation by NMT while it moves: it hears no process data, and goes on pressing. NMT stops it, as in a mission.
TEST(CommissioningCalledOff, StopsADriveThatHearsNoProcessData) {
  Bench bench(somewhere);
  Commissioning::Config config = bench.config();
  config.joints = {false, false, true, false, false};
  Commissioning commissioning(config);
  const Incident incident = interrupt(bench, commissioning, true, [&](Time now) {
    CanFrame pre_operational;
    pre_operational.length = 2;
    pre_operational.data = {0x80, can_map::drive_nodes[2]};
    bench.platform().devices().master_sends(pre_operational, now);
  });
  EXPECT_EQ(commissioning.failure(), "it was called off");
  EXPECT_FALSE(bench.any_powered());
  EXPECT_TRUE(commissioning.without_power());
  EXPECT_GT(incident.until_unpowered_s(), 0.01) << "it was not under power";
  EXPECT_LT(incident.until_unpowered_s(), 0.8) << "a heartbeat of 0.1 s, its ramp, and its restart";
}

// Another master's set points compete with a quick stop: the power goes at once.
TEST(CommissioningBesideAnotherMaster, LosesItsPowerAtOnce) {
  Bench bench(somewhere);
  Commissioning::Config config = bench.config();
  config.joints = {false, false, true, false, false};
  Commissioning commissioning(config);
  const Incident incident = interrupt(bench, commissioning, false, [&](Time now) {
    CanFrame rpdo;
    rpdo.id = 0x200u + can_map::drive_nodes[0];
    rpdo.length = 8;
    commissioning.on_frame(rpdo, now);
  });
  EXPECT_EQ(commissioning.failure(), "another master is on the bus");
  EXPECT_TRUE(commissioning.without_power());
  EXPECT_LT(incident.until_unpowered_s(), 0.03) << "disable voltage acts two SYNC periods later; a ramp takes longer";
}

TEST(CommissioningWithTheEmergencyStopOpen, EndsAndSaysSo) {
  devices::DeviceFault estop;
  estop.kind = devices::DeviceFaultKind::estop;
  estop.at_s = 5;
  Bench bench(somewhere, parked, {estop});
  Commissioning commissioning(bench.config());
  bench.run(commissioning);
  EXPECT_EQ(commissioning.state(), Commissioning::State::failed);
  EXPECT_EQ(commissioning.failure(), "the emergency-stop chain is open");
  EXPECT_TRUE(commissioning.without_power());
  EXPECT_FALSE(bench.any_powered());
}

// Without the output node nobody reads the emergency-stop chain.
TEST(CommissioningWithASilentOutputNode, EndsWithoutPower) {
  devices::DeviceFault silent;
  silent.kind = devices::DeviceFaultKind::silent;
  silent.node = can_map::io_node;
  silent.at_s = 5;
  Bench bench(somewhere, parked, {silent});
  Commissioning commissioning(bench.config());
  bool powered = false;
  bench.run(commissioning, [&] {
    powered = powered || bench.any_powered();
    return false;
  });
  EXPECT_TRUE(powered) << "it had not begun";
  EXPECT_EQ(commissioning.state(), Commissioning::State::failed);
  EXPECT_EQ(commissioning.failure(), "the emergency-stop chain cannot be read");
  EXPECT_LT(bench.platform().now().s(), 7.5) << "stopped, without power, and the nodes told";
  EXPECT_TRUE(commissioning.without_power());
  EXPECT_FALSE(bench.any_powered());
}

// A joint that was never commissioned takes no power, whatever is asked of the core.
TEST(AnArmThatWasNeverCommissioned, TakesNoPower) {
  Bench bench(somewhere);
  ControllerConfig config = bench.nominal().controller;
  config.network.drives[1].zero_known = false;
  hal::Lockstep<hal::SimPlatform> lockstep(bench.platform(), config, bench.nominal().scan);
  lockstep.step();
  for (const Command command : {Command::start, Command::home, Command::jog})
    EXPECT_FALSE(lockstep.controller().on_command(command, lockstep.now()));
  for (int i = 0; i < 2000; ++i) {
    lockstep.step();
    ASSERT_FALSE(bench.any_powered());
  }
}

}  // namespace
}  // namespace lf::test
