// What becomes of a commissioning's findings, in the homing file and in the core: the daemon's commissioner, with the simulated arm.
#include "hal/vehicle/commissioner.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/commissioner_at_work.hpp"

namespace lf::test {
namespace {

using hal::Commissioning;
using Bench = CommissioningBench;

// What was found cannot be kept. That the jaw must not move holds all the same: it rubs four times as much as its description has it, which cannot be; or its zero
// is not where the file has it.
struct Unwritten {
  const char* name;
  double friction_times;
  std::int32_t zero_in_file_from_true;
  const char* why;  // no power; nothing: the old zero is as good
};
class CommissioningWhoseFileCannotBeWritten : public testing::TestWithParam<Unwritten> {};

TEST_P(CommissioningWhoseFileCannotBeWritten, LeavesAJointInDoubtWithoutPower) {
  const Unwritten& unwritten = GetParam();
  Bench bench(somewhere, parked, {},
              [&](hal::SimConfig& truth) { truth.devices.drives[4].friction.coulomb_nm *= unwritten.friction_times; });
  AtWork work(somewhere[4] + unwritten.zero_in_file_from_true);
  hal::Commissioner& commissioner = *work.commissioner;
  EXPECT_EQ(commissioner.unknown_joints(), "");
  Commissioning* lent = work.begin(only_jaw, true);
  ASSERT_NE(lent, nullptr);
  bench.run(*lent);
  ASSERT_EQ(lent->state(), Commissioning::State::done) << lent->failure();
  ASSERT_TRUE(lent->friction_found()[4]);
  // Where the new file is written before it takes the old one's name.
  ASSERT_TRUE(std::filesystem::create_directory(work.folder / "homing.yaml.partial"));
  const std::string before = work.folder.read("homing.yaml");
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  EXPECT_EQ(work.folder.read("homing.yaml"), before);
  EXPECT_EQ(commissioner.unknown_joints(), unwritten.why != nullptr ? "jaw" : "");
  // An operator who was told how it ended gave the next order, and was refused: the core at work was still the old one.
  EXPECT_EQ(commissioner.last()["state"], "under way");
  ASSERT_TRUE(commissioner.why_no_power().has_value());
  EXPECT_NE(commissioner.why_no_power()->find("not in the core yet"), std::string::npos) << *commissioner.why_no_power();
  ASSERT_TRUE(work.take_over());
  EXPECT_EQ(commissioner.why_no_power(), std::nullopt);
  const hal::Json last = commissioner.last();
  EXPECT_EQ(last["state"], "failed");
  EXPECT_NE(last["why"].get<std::string>().find("cannot be written"), std::string::npos) << last;
  EXPECT_NE(last["why"].get<std::string>().find(unwritten.why != nullptr ? unwritten.why : ""), std::string::npos) << last;
  for (const Command command : {Command::start, Command::home})
    EXPECT_EQ(core->on_command(command, Time::from_s(1)), unwritten.why == nullptr);
  EXPECT_EQ(core->network().axis(arm5e_joint::jaw).setup().may_have_power(), unwritten.why == nullptr);
  EXPECT_TRUE(core->network().axis(arm5e_joint::elbow).setup().may_have_power());
  EXPECT_NE(last["why"].get<std::string>().find("gives them no power: jaw"), std::string::npos) << last;
  work.start();
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw")
      << "a daemon started anew does not trust a zero of which nobody wrote whether it holds";
}

// The jaw is found elsewhere than its zero had it. Which of the two is right nobody knows: it takes no power, and the file has its zero as a doubtful one. The
// order was refused once: given again, or to a daemon that was started anew, it was taken without a word.
TEST(CommissioningThatFails, LeavesAJointThatItFoundElsewhereWithoutPowerUntilTheOrderSaysThatItHasMoved) {
  AtWork work(somewhere[4] - 700);
  const auto commission = [&](const PerJoint<bool>& joints, bool moved) {
    Bench bench(somewhere);
    Commissioning* lent = work.begin(joints, moved);
    ASSERT_NE(lent, nullptr);
    bench.run(*lent);
    EXPECT_EQ(lent->state(), moved ? Commissioning::State::done : Commissioning::State::failed) << lent->failure();
    const std::unique_ptr<Controller> core = work.end(lent);
    ASSERT_NE(core, nullptr);
    ASSERT_TRUE(work.take_over());
    EXPECT_EQ(work.commissioner->unknown_joints(), moved ? "" : "jaw");
    EXPECT_EQ(core->network().axis(arm5e_joint::jaw).setup().may_have_power(), moved);
    EXPECT_TRUE(core->network().axis(arm5e_joint::elbow).setup().may_have_power());
    const config::HomingOffsets left = work.file();
    EXPECT_EQ(left.known, (PerJoint<bool>{true, true, true, true, moved}));
    EXPECT_EQ(left.zero_doubtful[4], !moved);
    if (moved) return;
    EXPECT_EQ(left.zero_counts[4], somewhere[4] - 700) << "the old one";
    EXPECT_NE(work.why().find("the jaw's zero has moved"), std::string::npos) << work.why();
    EXPECT_NE(work.why().find("the zeros of these joints are doubtful now: jaw. Nothing else was written"), std::string::npos)
        << work.why();
    EXPECT_EQ(work.why().find("nothing was written"), std::string::npos) << work.why();
  };
  commission({true, true, true, true, true}, false);
  commission({true, true, true, true, true}, false);
  commission(only_jaw, false);
  work.start();
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
  commission(only_jaw, false);
  commission(only_jaw, true);
  EXPECT_LT(std::abs(work.file().zero_counts[4] - somewhere[4]), 20);
}

// Its elbow turns from 1.8 to 4.7 rad: the zero that was taken there would have been 1.7 rad off.
TEST(CommissioningInAJig, IsRefusedWhereAJointCannotStandAtItsZero) {
  const TemporaryFolder folder;
  folder.write("homing.yaml", "elbow: {zero_counts: 0}\n");
  const hal::VehicleConfig vehicle = hal::load_vehicle_config(folder.write(
      "vehicle.yaml", "machine: " LANTERNFISH_TEST_DATA "/arms/seven_joints/seven_joints.yaml\ncan: {interface: can0}\n"
                      "camera: {source: none}\npanel: {ahead_m: 0.75, down_m: 0.35}\ntasks: []\nlock_folder: " +
                          folder.path().string() + "\nlog: {folder: " + (folder / "log") + "}\nhoming: {file: homing.yaml}\n"));
  const auto rings = std::make_unique<hal::LoopRings>();
  hal::Commissioner commissioner(vehicle, *rings, [](const hal::Json&) {});
  hal::CommissionOrder order;
  order.here = true;
  EXPECT_EQ(commissioner.begin(order, hal::monotonic_now()),
            "the elbow cannot stand at its zero, which its range leaves out: commission it against its stop");
  EXPECT_FALSE(commissioner.busy());
  order.joints[2] = false;
  EXPECT_EQ(commissioner.begin(order, hal::monotonic_now()), std::nullopt) << "the others can";
}

// There and back at 0.15 rad/s, with a reserve, where that is longer than what the default arm's joints have.
TEST(CommissioningTime, GrowsWithTheStroke) {
  Commissioning::Config config;
  ArmModel::Joint joint;
  joint.lower_rad = -1, joint.upper_rad = 1, joint.velocity_rad_s = 0.5;
  EXPECT_EQ(Commissioning::longest(joint, config), config.longest);
  joint.lower_rad = -6, joint.upper_rad = 6;
  EXPECT_NEAR(Commissioning::longest(joint, config).s(), 2 * 1.2 * 12 / 0.15 + 60, 1e-6);
}

// Commissioned again where the old zero has it, such a joint is as before: the obstacle is gone.
TEST(CommissioningThatFails, LeavesAZeroThatHoldsOnceTheJointIsFoundThereAgain) {
  AtWork work(0);
  work.write_homing("jaw: {zero_counts: " + std::to_string(somewhere[4]) + ", zero_doubtful: true}\n");
  work.start();
  ASSERT_NO_FATAL_FAILURE(work.commission_jaw());
  EXPECT_TRUE(work.file().known[4] && !work.file().zero_doubtful[4]);
  EXPECT_EQ(work.commissioner->unknown_joints(), "");
}

// The joint's line is gone from the file: the core's zero is what is compared with, and kept as the doubtful one.
TEST(CommissioningThatFails, LeavesAJointWithoutPowerThatTheFileDoesNotKnow) {
  AtWork work(somewhere[4] - 700);
  work.write_homing("");
  Bench bench(somewhere);
  Commissioning* lent = work.begin({true, true, true, true, true});
  ASSERT_NE(lent, nullptr);
  bench.run(*lent);
  EXPECT_EQ(lent->state(), Commissioning::State::failed);
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_FALSE(core->network().axis(arm5e_joint::jaw).setup().may_have_power());
  EXPECT_TRUE(core->network().axis(arm5e_joint::elbow).setup().may_have_power());
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
  EXPECT_TRUE(work.file().zero_doubtful[4]);
  EXPECT_EQ(work.file().zero_counts[4], somewhere[4] - 700);
}

// Somebody has put an older file in the place of the one that the commissioning was compared with.
TEST(CommissioningThatEndsWell, FailsWhereTheFileHasAnotherZeroByThen) {
  AtWork work(somewhere[4]);
  Bench bench(somewhere);
  Commissioning* lent = work.begin(only_jaw);
  ASSERT_NE(lent, nullptr);
  bench.run(*lent);
  EXPECT_EQ(lent->state(), Commissioning::State::done) << lent->failure();
  work.write_homing("jaw: {zero_counts: " + std::to_string(somewhere[4] - 700) + "}\n");
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_FALSE(core->network().axis(arm5e_joint::jaw).setup().may_have_power());
  EXPECT_EQ(work.commissioner->last()["state"], "failed");
  EXPECT_NE(work.why().find("jaw: its zero was found elsewhere than the homing file has it"), std::string::npos) << work.why();
  EXPECT_TRUE(work.file().zero_doubtful[4]);
  EXPECT_EQ(work.file().zero_counts[4], somewhere[4] - 700);
}

// Something rubs in the jaw, and the slew, which comes after it, is called off. After a restart the jaw had power with the friction that it had before.
TEST(CommissioningThatFails, LeavesAnEarlierJointThatRubsWithoutPower) {
  Bench bench(somewhere, parked, {}, [](hal::SimConfig& truth) { truth.devices.drives[4].friction.coulomb_nm *= 4; });
  AtWork work(somewhere[4]);
  Commissioning* lent = work.begin({true, false, false, false, true});
  ASSERT_NE(lent, nullptr);
  bench.run(*lent, [&] { return lent->joint() == 0 && lent->state() == Commissioning::State::seeking; });
  ASSERT_EQ(lent->failure(), "it was called off");
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_FALSE(core->network().axis(arm5e_joint::jaw).setup().may_have_power());
  EXPECT_TRUE(core->network().axis(arm5e_joint::slew).setup().may_have_power());
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
  EXPECT_NE(work.why().find("it was called off. In the homing file the zeros of these joints are doubtful now: jaw. Nothing else"),
            std::string::npos)
      << work.why();
  EXPECT_NE(work.why().find("'jaw.coulomb_mnm' is"), std::string::npos) << work.why();
  const config::HomingOffsets left = work.file();
  EXPECT_TRUE(left.friction_doubtful[4] && left.zero_doubtful[4]);
  EXPECT_EQ(left.zero_counts, somewhere);
  work.start();
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
}

// Its drive has lost its position since: what the file and the core have of it is not taken for a zero to compare with.
TEST(CommissioningThatFails, KeepsNoZeroThatTheDriveHasLost) {
  Bench bench(somewhere, parked, {}, [](hal::SimConfig& truth) { truth.devices.drives[4].friction.coulomb_nm *= 4; });
  AtWork work(somewhere[4] - 700);
  hal::ControlReport report;
  report.zeros_lost = only_jaw;
  work.commissioner->hear(report);
  Commissioning* lent = work.begin({true, false, false, false, true});
  ASSERT_NE(lent, nullptr);
  bench.run(*lent, [&] { return lent->joint() == 0 && lent->state() == Commissioning::State::seeking; });
  ASSERT_EQ(lent->failure(), "it was called off") << "it is not compared";
  EXPECT_NE(work.end(lent), nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
  EXPECT_FALSE(work.file().has_earlier_zero(4));
  EXPECT_TRUE(work.file().friction_doubtful[4]);
}

TEST(CommissioningThatFails, SaysThatNothingWasWrittenWhereTheFileCannotBe) {
  Bench bench(somewhere);
  AtWork work(somewhere[4] - 700);
  Commissioning* lent = work.begin(only_jaw);
  ASSERT_NE(lent, nullptr);
  bench.run(*lent);
  ASSERT_TRUE(std::filesystem::create_directory(work.folder / "homing.yaml.partial"));
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_FALSE(core->network().axis(arm5e_joint::jaw).setup().may_have_power());
  EXPECT_NE(work.why().find("jaw: its zero was found 0.38 rad from where it was"), std::string::npos) << work.why();
  EXPECT_NE(work.why().find("Nothing was written: "), std::string::npos) << work.why();
}

// A joint that was found elsewhere, and a file that somebody changes meanwhile: what was found cannot be compared with it. A commissioning of another joint
// that ended well gave the joint its power back, with the zero that had just been found wrong.
TEST(CommissioningThatFails, LeavesNoPowerToAJointWhoseFileWasUnreadableByThen) {
  const auto off = static_cast<std::int32_t>(0.2 / std::abs(arm::rad_per_count(test::arm5e.joint(arm5e_joint::slew), 0)));
  Bench bench(somewhere);
  AtWork work(somewhere[4]);
  std::string text = work.folder.read("homing.yaml");
  const std::string slew = "slew: {zero_counts: ";
  work.folder.write("homing.yaml",
                    text.replace(text.find(slew), text.find('}') - text.find(slew), slew + std::to_string(somewhere[0] - off)));
  work.start();
  Commissioning* lent = work.begin({true, false, false, false, true});
  ASSERT_NE(lent, nullptr);
  bench.run(*lent);
  EXPECT_NE(lent->failure().find("its zero was found"), std::string::npos) << lent->failure();
  work.folder.write("homing.yaml", "slew: {zero_counts: 1\n");
  ASSERT_NE(work.end(lent), nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_EQ(work.commissioner->last()["state"], "failed");
  EXPECT_EQ(work.commissioner->unknown_joints(), "slew, jaw");
  work.write_homing("jaw: {zero_counts: " + std::to_string(somewhere[4]) + "}\n");
  ASSERT_NO_FATAL_FAILURE(work.commission_jaw());
  EXPECT_EQ(work.commissioner->unknown_joints(), "slew");
}

// The jaw was found where it was, the slew was called off. It was told that the jaw takes no power, and it kept it.
TEST(CommissioningThatFails, TakesThePowerThatItSaysItTakesWhereTheFileIsUnreadable) {
  Bench bench(somewhere);
  AtWork work(somewhere[4]);
  Commissioning* lent = work.begin({true, false, false, false, true});
  ASSERT_NE(lent, nullptr);
  bench.run(*lent, [&] { return lent->joint() == 0 && lent->state() == Commissioning::State::seeking; });
  work.folder.write("homing.yaml", "slew: {zero_counts: 1\n");
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_NE(work.why().find("take no power until they are commissioned again: jaw"), std::string::npos) << work.why();
  EXPECT_FALSE(core->network().axis(arm5e_joint::jaw).setup().may_have_power());
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
}

// An operator who has given another order no longer waits for it, nor does one who was told that nothing answers: then the disk came back, and the arm moved.
TEST(CommissioningUnderWay, DoesNotMoveWhenAnotherOrderCameBeforeTheFileWasWritten) {
  AtWork work(somewhere[4]);
  EXPECT_FALSE(work.commissioner->call_off_before_it_moves("another order came"));
  hal::CommissionOrder order;
  order.joints = only_jaw;
  ASSERT_EQ(work.commissioner->begin(order, hal::monotonic_now()), std::nullopt);
  EXPECT_TRUE(work.commissioner->call_off_before_it_moves("another order came"));
  EXPECT_FALSE(work.commissioner->call_off_before_it_moves("another order came")) << "once is enough";
  const std::optional<hal::Json> answer = work.commissioner->answer();
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ((*answer)["ok"], false);
  EXPECT_NE((*answer)["why"].get<std::string>().find("another order came"), std::string::npos) << *answer;
  EXPECT_TRUE(work.wait_for([&] { return !work.commissioner->busy() && work.file().known[4]; }));
  hal::CommissioningLoan loan;
  EXPECT_FALSE(work.rings->commissionings.pop(loan));
  EXPECT_FALSE(work.file().zero_doubtful[4]);
  EXPECT_NE(work.begin(only_jaw), nullptr) << "the next one is";
}

// Called wrong by the order's own words, the old zero was trusted when its order was called off before it moved anything.
TEST(CommissioningUnderWay, LeavesAJointThatHasMovedWithoutPowerWhereItIsCalledOffBeforeItMoves) {
  for (const bool lent : {false, true}) {
    AtWork work(somewhere[4]);
    hal::Commissioning* one = nullptr;
    if (lent) {
      one = work.begin(only_jaw, true);
      ASSERT_NE(one, nullptr);
    } else {
      hal::CommissionOrder order;
      order.joints = only_jaw;
      order.moved = true;
      ASSERT_EQ(work.commissioner->begin(order, hal::monotonic_now()), std::nullopt);
    }
    EXPECT_TRUE(work.commissioner->call_off_before_it_moves("another order came"));
    EXPECT_EQ(work.rings->loan_is_void, lent);
    if (lent) {
      EXPECT_TRUE(work.rings->commissioned.push({one, false}));
    }
    std::optional<hal::Json> answer;
    ASSERT_TRUE(work.wait_for([&] { return answer.has_value() || (answer = work.commissioner->answer()).has_value(); }));
    EXPECT_NE((*answer)["why"].get<std::string>().find("another order came: nothing moves. These joints' zeros have moved"),
              std::string::npos)
        << *answer;
    EXPECT_TRUE(work.wait_for([&] { return !work.commissioner->busy() && work.file().zero_doubtful[4]; }));
    EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
    work.commissioner->step();
    EXPECT_TRUE(work.file().zero_doubtful[4]) << "a daemon started anew does not trust it";
    Bench bench(somewhere);
    hal::Commissioning* next = work.begin(only_jaw, true);
    ASSERT_NE(next, nullptr);
    EXPECT_FALSE(work.rings->loan_is_void);
    bench.run(*next);
    EXPECT_NE(work.end(next), nullptr);
    ASSERT_TRUE(work.take_over());
    EXPECT_EQ(work.commissioner->unknown_joints(), "");
  }
}

// The client of the one before would have got the next one's answer, and the next one's none, while its joint moved.
TEST(CommissioningUnderWay, IsNotBegunWhileTheOneBeforeIsUnanswered) {
  AtWork work(somewhere[4]);
  hal::CommissionOrder order;
  order.joints = only_jaw;
  ASSERT_EQ(work.commissioner->begin(order, hal::monotonic_now() - Duration::from_s(5)), std::nullopt);
  ASSERT_TRUE(work.wait_for([&] { return !work.commissioner->busy(); }));
  EXPECT_NE(work.commissioner->begin(order, hal::monotonic_now()), std::nullopt);
  EXPECT_TRUE(work.commissioner->answer().has_value());
  EXPECT_EQ(work.commissioner->begin(order, hal::monotonic_now()), std::nullopt);
}

// A name that took 3 s to look up and a disk that took 2: the client had given up, and the arm would have moved.
TEST(CommissioningUnderWay, DoesNotMoveWhenWhoOrderedItHasGivenUp) {
  AtWork work(somewhere[4]);
  hal::CommissionOrder order;
  order.joints = only_jaw;
  ASSERT_EQ(work.commissioner->begin(order, hal::monotonic_now() - Duration::from_s(5)), std::nullopt);
  std::optional<hal::Json> answer;
  ASSERT_TRUE(work.wait_for([&] { return answer.has_value() || (answer = work.commissioner->answer()).has_value(); }));
  EXPECT_NE((*answer)["why"].get<std::string>().find("not be written in time, look at its disk: nothing moves"), std::string::npos)
      << *answer;
  EXPECT_TRUE(work.wait_for([&] { return !work.commissioner->busy() && work.file().known[4]; }));
  hal::CommissioningLoan loan;
  EXPECT_FALSE(work.rings->commissionings.pop(loan));
}

// From before anything moves until its end is written: the daemon, the machine or its disk may fail at any time between.
TEST(CommissioningUnderWay, LeavesNoZeroThatADaemonStartedAnewWouldTrust) {
  AtWork work(somewhere[4]);
  ASSERT_NE(work.begin(only_jaw), nullptr);
  EXPECT_TRUE(work.file().zero_doubtful[4]);
  EXPECT_EQ(work.file().zero_counts[4], somewhere[4]);
  EXPECT_TRUE(work.file().known[0]);
  EXPECT_EQ(work.commissioner->unknown_joints(), "") << "the core at work has all it had";
  work.start();
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
  work.commission_jaw();
  EXPECT_EQ(work.commissioner->unknown_joints(), "");
}

TEST(CommissioningUnderWay, LeavesTheZerosAsTheyWereWhereItIsCalledOffOrNeverBegan) {
  for (const bool begun : {true, false}) {
    Bench bench(somewhere);
    AtWork work(somewhere[4]);
    Commissioning* lent = work.begin(only_jaw);
    ASSERT_NE(lent, nullptr);
    if (begun) bench.run(*lent, [&] { return lent->state() == Commissioning::State::seeking; });
    EXPECT_TRUE(work.rings->commissioned.push({lent, begun}));
    EXPECT_TRUE(work.wait_for([&] { return !work.commissioner->busy() && work.file().known[4]; })) << begun;
    EXPECT_FALSE(work.file().zero_doubtful[4]);
    EXPECT_EQ(work.file().zero_counts, somewhere);
    work.start();
    EXPECT_EQ(work.commissioner->unknown_joints(), "");
  }
}

// The encoder was changed, by the order's own words: the earlier zero is wrong, whether or not another was found.
TEST(CommissioningUnderWay, LeavesAJointThatHasMovedWithoutPowerWhereItIsCalledOff) {
  Bench bench(somewhere);
  AtWork work(somewhere[4]);
  Commissioning* lent = work.begin(only_jaw, true);
  ASSERT_NE(lent, nullptr);
  bench.run(*lent, [&] { return lent->state() == Commissioning::State::seeking; });
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_FALSE(core->network().axis(arm5e_joint::jaw).setup().may_have_power());
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
  EXPECT_TRUE(work.file().zero_doubtful[4]);
  EXPECT_NE(work.why().find("doubtful now: jaw"), std::string::npos) << work.why();
}

// Another arm's file was copied over it: the other joints keep the zeros that the core has, until the daemon is started anew.
TEST(CommissioningUnderWay, TakesNoZeroOfAnotherJointFromAChangedFile) {
  Bench bench(somewhere);
  AtWork work(somewhere[4]);
  const std::string text = work.folder.read("homing.yaml"), slew = "slew: {zero_counts: ";
  work.folder.write("homing.yaml", slew + std::to_string(somewhere[0] + 5000) + text.substr(text.find('}')));
  Commissioning* lent = work.begin(only_jaw);
  ASSERT_NE(lent, nullptr);
  bench.run(*lent);
  EXPECT_EQ(lent->state(), Commissioning::State::done) << lent->failure();
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  ASSERT_TRUE(work.take_over());
  EXPECT_EQ(core->network().axis(arm5e_joint::slew).setup().encoder_zero_counts, somewhere[0]);
  EXPECT_EQ(work.file().zero_counts[0], somewhere[0] + 5000) << "the file is whose it is";
}

// As on a full disk: nothing has moved yet.
TEST(CommissioningUnderWay, IsNotBegunWhereTheFileCannotBeWritten) {
  AtWork work(somewhere[4]);
  ASSERT_TRUE(std::filesystem::create_directory(work.folder / "homing.yaml.partial"));
  hal::CommissionOrder order;
  order.joints = only_jaw;
  ASSERT_EQ(work.commissioner->begin(order, hal::monotonic_now()), std::nullopt);
  std::optional<hal::Json> answer;
  ASSERT_TRUE(work.wait_for([&] { return answer.has_value() || (answer = work.commissioner->answer()).has_value(); }));
  EXPECT_EQ((*answer)["ok"], false);
  EXPECT_NE((*answer)["why"].get<std::string>().find("cannot be written"), std::string::npos) << *answer;
  EXPECT_FALSE(work.commissioner->busy());
  hal::CommissioningLoan loan;
  EXPECT_FALSE(work.rings->commissionings.pop(loan));
}

// What the jaw holds is in doubt in the core: its angle alone says nothing.
TEST(CommissioningOfAnArm, WhoseJawIsInDoubtIsNotBegun) {
  for (const bool doubted : {false, true}) {
    Bench bench(somewhere);
    AtWork work(somewhere[4]);
    hal::ControlReport report;
    report.jaw_doubted = doubted;
    work.commissioner->hear(report);
    Commissioning* lent = work.begin({false, false, false, true, false});
    ASSERT_NE(lent, nullptr);
    bool powered = false;
    bench.run(*lent, [&] { return powered = powered || bench.any_powered(); });
    EXPECT_EQ(powered, !doubted) << lent->failure();
    EXPECT_TRUE(work.rings->commissioned.push({lent, true}));
    EXPECT_TRUE(work.wait_for([&] { return !work.commissioner->busy(); }));
  }
}

INSTANTIATE_TEST_SUITE_P(Because, CommissioningWhoseFileCannotBeWritten,
                         testing::Values(Unwritten{"OfItsFriction", 4, 0, "'jaw.coulomb_mnm' is"},
                                         Unwritten{"ItsZeroHasMoved", 1, 700, "the jaw's zero has moved"},
                                         Unwritten{"OfNothing", 1, 0, nullptr}),
                         [](const testing::TestParamInfo<Unwritten>& test) { return test.param.name; });

}  // namespace
}  // namespace lf::test
