// Arms of other joints than the default's: an operator homes and jogs them, and whatever stops the default arm stops them. One of five joints is given no job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hal/config/text_file.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/arm/make_model.hpp"
#include "shared/input_error.hpp"
#include "tests/hil/operator.hpp"
#include "tests/unit/changed_text.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::test {
namespace {

using mission::Standing;
using mission::Step;
using safety::Fault;

std::vector<std::string> six_joints(std::vector<std::string> more = {}) {
  std::vector<std::string> overrides{"machine=" LANTERNFISH_TEST_DATA "/arms/six_joints/six_joints.yaml", "tasks=[]"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

bool any_power(Rig& rig) {
  for (std::size_t i = 0; i < rig.arm().joints.size(); ++i) {
    if (rig.devices().power(i) != devices::DrivePower::off) return true;
  }
  return false;
}

class AnyArm : public testing::Test {
 protected:
  Rig rig{six_joints()};
  std::size_t joints() const { return rig.arm().joints.size(); }
};

TEST_F(AnyArm, IsHomedAndStandsWhereItIsFolded) {
  ASSERT_EQ(joints(), 7u);
  ASSERT_TRUE(home(rig)) << rig.story();
  const std::vector<double> park{0, 0.6, -1.3, 0, 0.4, 0};
  for (std::size_t i = 0; i < park.size(); ++i) EXPECT_NEAR(angle_rad(rig, i), park[i], 0.01) << i;
  arm::JointVector q = arm::JointVector::Zero();
  for (std::size_t i = 0; i < park.size(); ++i) q[static_cast<Eigen::Index>(i)] = angle_rad(rig, i);
  const Pose told = arm::Arm(make_model(rig.arm())).base_from_tool(q);
  EXPECT_LT((told.translation() - rig.world().base_from_tool().translation()).norm(), 1e-6) << "where the core takes its tool to be";
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
}

TEST_F(AnyArm, EachJointIsJoggedAndNoOtherMoves) {
  ASSERT_TRUE(home(rig)) << rig.story();
  for (std::size_t joint = 0; joint < joints(); ++joint) {
    SCOPED_TRACE(rig.arm().joints[joint].name);
    for (const double by_rad : {0.15, -0.15}) {
      const auto from = angles_rad(rig);
      ASSERT_TRUE(jog(rig, joint, by_rad)) << rig.story();
      ASSERT_TRUE(finish_jog(rig)) << rig.story();
      EXPECT_NEAR(angle_rad(rig, joint), from[joint] + by_rad, 0.012);
      auto others = angles_rad(rig);
      others[joint] = from[joint];
      EXPECT_LT(farthest_apart(others, from), 0.006);
    }
  }
  EXPECT_EQ(rig.step_now(), Step::ready) << rig.story();
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
}

// Jogs until nothing more comes of it.
void jog_to_the_end(Rig& rig, std::size_t joint, double by_rad) {
  for (double before_rad = HUGE_VAL; std::abs(angle_rad(rig, joint) - before_rad) > 0.5 * std::abs(by_rad);) {
    before_rad = angle_rad(rig, joint);
    if (!jog(rig, joint, by_rad)) return;
    ASSERT_TRUE(finish_jog(rig)) << rig.story();
  }
}

TEST_F(AnyArm, IsNotJoggedBeyondItsLimits) {
  ASSERT_TRUE(home(rig)) << rig.story();
  EXPECT_FALSE(jog(rig, 7, 0.1)) << "there is no such joint";
  for (const double by_rad : {-0.2, 0.2}) {
    jog_to_the_end(rig, 5, by_rad);
    EXPECT_GT(std::abs(angle_rad(rig, 5)), 3.08 - 0.21);
    EXPECT_LT(std::abs(angle_rad(rig, 5)), 3.08);
  }
  EXPECT_EQ(rig.step_now(), Step::ready) << rig.story();
}

// Lifted back, its boom would come down on the vehicle's frame.
TEST_F(AnyArm, IsNotJoggedIntoItsVehicle) {
  ASSERT_TRUE(home(rig)) << rig.story();
  jog_to_the_end(rig, 1, -0.2);
  EXPECT_GT(angle_rad(rig, 1), 0.1) << "its limit is -0.28";
  EXPECT_LT(angle_rad(rig, 1), 0.3);
  EXPECT_TRUE(rig.world().contacts().unintended.empty()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::ready) << rig.story();
}

// The elbow's range is 1.8 to 4.7 rad, without angle 0; the swivel stands beyond half a turn.
TEST(SevenJoints, AreHomedAndJoggedWhereARangeLeavesOutAngleZero) {
  Rig rig({"machine=" LANTERNFISH_TEST_DATA "/arms/seven_joints/seven_joints.yaml", "panel.ahead_m=0.75", "panel.down_m=0.35", "tasks=[]"});
  ASSERT_TRUE(home(rig)) << rig.story();
  EXPECT_NEAR(angle_rad(rig, 2), 3.904, 0.01);
  EXPECT_NEAR(angle_rad(rig, 3), 3.6, 0.01);
  for (const std::size_t joint : {2u, 3u}) {
    for (const double by_rad : {-0.2, -0.2, 0.2}) {
      const double from_rad = angle_rad(rig, joint);
      ASSERT_TRUE(jog(rig, joint, by_rad)) << rig.story();
      ASSERT_TRUE(finish_jog(rig)) << rig.story();
      EXPECT_NEAR(angle_rad(rig, joint), from_rad + by_rad, 0.012);
    }
  }
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
  EXPECT_EQ(rig.step_now(), Step::ready) << rig.story();
}

// The panel stands where the default arm reaches it, and this one does not.
TEST_F(AnyArm, ThatDoesNotReachThePanelGoesHomeFromAJob) {
  ASSERT_TRUE(home(rig)) << rig.story();
  EXPECT_FALSE(give(rig, Command::start)) << "there is nothing to do";
  ASSERT_TRUE(set_tasks(rig, {mission::Task{mission::Task::Kind::press_button, 0, 0, 0}}));
  ASSERT_TRUE(give(rig, Command::start));
  rig.run_for(30);
  EXPECT_FALSE(any_power(rig)) << rig.story();
  EXPECT_GE(rig.count(Fault::step_failed), 1u) << rig.story();
  const std::vector<double> park{0, 0.6, -1.3, 0, 0.4, 0};
  for (std::size_t i = 0; i < park.size(); ++i) EXPECT_NEAR(angle_rad(rig, i), park[i], 0.02) << "folded: " << rig.story();
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
}

TEST(AnyArmsJob, OutOfItsReachIsRefusedBeforeItBegins) {
  const std::vector<std::string> overrides{"machine=" LANTERNFISH_TEST_DATA "/arms/six_joints/six_joints.yaml"};
  try {
    scenario::check_runnable(scenario::load_scenario("default", overrides));
    FAIL() << "it was accepted";
  } catch (const InputError& refused) {
    EXPECT_THAT(refused.what(), testing::HasSubstr("the valve is out of the arm's reach at its nominal place"));
  }
}

// From any joint's drive, those that the default arm has not among them.
class AnyArmsFault : public testing::TestWithParam<std::size_t> {};

TEST_P(AnyArmsFault, StopsItAndTakesThePower) {
  Rig rig(six_joints());
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_TRUE(jog(rig, 0, 0.3));
  rig.run_for(0.4);
  ASSERT_EQ(rig.mission().standing(), Standing::jogging);
  devices::DeviceFault fault;
  fault.kind = devices::DeviceFaultKind::overcurrent;
  fault.node = rig.controller().network().config().drives[GetParam()].node;
  rig.devices().add_fault(fault, rig.now());
  rig.run_for(1.5);
  EXPECT_GE(rig.count(Fault::drive_fault), 1u) << rig.story();
  EXPECT_FALSE(any_power(rig)) << rig.story();
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  bool named = false;
  for (const Event& event : rig.events())
    named = named || (event.kind == Event::Kind::fault && event.code == static_cast<std::int32_t>(GetParam()));
  EXPECT_TRUE(named) << rig.story();
}

INSTANTIATE_TEST_SUITE_P(OfEachDrive, AnyArmsFault, testing::Range(std::size_t{0}, std::size_t{7}));

TEST_F(AnyArm, AnEmergencyStopTakesItsPowerOnItsWay) {
  for (const std::size_t joint : {0u, 3u, 5u}) {
    Rig stopped(six_joints());
    ASSERT_TRUE(home(stopped)) << stopped.story();
    ASSERT_TRUE(jog(stopped, joint, 0.3));
    stopped.run_for(0.3);
    stopped.devices().set_estop_closed(false);
    stopped.run_for(1.3);
    EXPECT_FALSE(any_power(stopped)) << stopped.story();
    EXPECT_LT(stopped.fastest_joint_rad_s(), standing_rad_s);
  }
}

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  return text.substr(begin, text.find(to, begin) + to.size() - begin);
}

// The same arm without its twist: four joints place the tool and cannot choose how it points.
class ArmOfFiveJoints : public testing::Test {
 protected:
  void SetUp() override {
    const std::string arms = LANTERNFISH_TEST_DATA "/arms/six_joints/";
    std::string urdf = config::read_text_file(arms + "six_joints.urdf"), limits = config::read_text_file(arms + "limits.yaml");
    change(urdf, between(urdf, "  <link name=\"stick\">", "</link>\n"), "");
    change(urdf, between(urdf, "  <joint name=\"twist\"", "</joint>\n"), "");
    change(urdf, "<parent link=\"stick\"/>", "<parent link=\"elbow_block\"/>");
    change(limits, between(limits, "  twist:", "\n"), "");
    folder.write("arm.urdf", urdf);
    folder.write("limits.yaml", limits);
    machine = folder.write("machine.yaml",
                           "version: 1\narm: {urdf: arm.urdf, park_rad: [0, 0.6, -1.3, 0.4, 0]}\nsafety: {limits: limits.yaml}\n");
    correct_checksum();
  }

  // The refusal names the right one.
  void correct_checksum() {
    std::string limits = config::read_text_file(folder / "limits.yaml");
    try {
      (void)scenario::make_nominal(scenario::load_scenario("default", {"machine=" + machine, "tasks=[]"}), true);
    } catch (const InputError& refused) {
      const std::string told = refused.what();
      change(limits, between(limits, "checksum: ", "\n"), "checksum: " + told.substr(told.rfind("0x"), 10) + "\n");
      folder.write("limits.yaml", limits);
    }
  }

  TemporaryFolder folder;
  std::string machine;
};

TEST_F(ArmOfFiveJoints, IsHomedAndGivenNoJob) {
  Rig rig({"machine=" + machine, "tasks=[]"});
  ASSERT_TRUE(home(rig)) << rig.story();
  EXPECT_FALSE(set_tasks(rig, {mission::Task{mission::Task::Kind::press_button, 0, 0, 0}}));
  rig.run_for(1);
  EXPECT_EQ(rig.step_now(), Step::ready) << rig.story();
}

TEST_F(ArmOfFiveJoints, IsRefusedAJobWithTheReasonBeforeItBegins) {
  try {
    scenario::check_runnable(scenario::load_scenario("default", {"machine=" + machine}));
    FAIL() << "it was accepted";
  } catch (const InputError& refused) {
    EXPECT_THAT(refused.what(), testing::HasSubstr("five joints or more beside a roll"));
  }
}

// The same arm with two more joints in its wrist: as many as the core holds.
class ArmOfEightJoints : public testing::Test {
 protected:
  void SetUp() override {
    const std::string arms = LANTERNFISH_TEST_DATA "/arms/six_joints/";
    std::string urdf = config::read_text_file(arms + "six_joints.urdf"), limits = config::read_text_file(arms + "limits.yaml");
    const std::string link = between(urdf, "  <link name=\"pitch_block\">", "</link>\n"),
                      pitch = between(urdf, "  <joint name=\"pitch\"", "</joint>\n");
    std::string parent = "pitch_block";
    for (const std::string name : {"first", "second"}) {
      std::string block = link, joint = pitch;
      change(block, "\"pitch_block\"", "\"" + name + "_block\"");
      change(joint, "\"pitch\"", "\"" + name + "\"");
      change(joint, "<parent link=\"stick\"/>", "<parent link=\"" + parent + "\"/>");
      change(joint, "<child link=\"pitch_block\"/>", "<child link=\"" + name + "_block\"/>");
      change(joint, between(joint, "<origin", "/>"), "<origin xyz=\"0.07 0 0\" rpy=\"0.4 0 0\"/>");
      change(urdf, "  <link name=\"hand\">", block + "  <link name=\"hand\">");
      change(urdf, "  <joint name=\"spin\"", joint + "  <joint name=\"spin\"");
      change(limits, "  spin:", "  " + name + ": {min_rad: -1.48, max_rad: 1.48, max_speed_rad_s: 0.6, max_torque_nm: 13}\n  spin:");
      parent = name + "_block";
    }
    const std::size_t spin = urdf.find("  <joint name=\"spin\"");
    urdf.replace(urdf.find("<parent link=\"pitch_block\"/>", spin), 30, "<parent link=\"" + parent + "\"/>");
    change(limits, between(limits, "  min_m:", "]"), "  min_m: [-0.8, -1.2, -1.2]");
    change(limits, between(limits, "  max_m:", "]"), "  max_m: [1.2, 1.2, 1.2]");
    folder.write("arm.urdf", urdf);
    folder.write("limits.yaml", limits);
    machine = folder.write("machine.yaml",
                           "version: 1\narm: {urdf: arm.urdf, park_rad: [0, 0.6, -1.3, 0, 0.4, 0, 0, 0]}\nsafety: {limits: limits.yaml}\n");
    // The refusal names the right checksum.
    try {
      (void)scenario::make_nominal(scenario::load_scenario("default", set()), true);
    } catch (const InputError& refused) {
      const std::string told = refused.what();
      change(limits, between(limits, "checksum: ", "\n"), "checksum: " + told.substr(told.rfind("0x"), 10) + "\n");
      folder.write("limits.yaml", limits);
    }
  }

  std::vector<std::string> set() const { return {"machine=" + machine, "tasks=[]"}; }

  TemporaryFolder folder;
  std::string machine;
};

TEST_F(ArmOfEightJoints, IsHomedAndEachOfThemIsJogged) {
  Rig rig(set());
  ASSERT_EQ(rig.arm().joints.size(), 9u);
  ASSERT_TRUE(home(rig)) << rig.story();
  for (std::size_t joint = 0; joint < rig.arm().joints.size(); ++joint) {
    SCOPED_TRACE(rig.arm().joints[joint].name);
    const double from = angle_rad(rig, joint);
    ASSERT_TRUE(jog(rig, joint, 0.1)) << rig.story();
    ASSERT_TRUE(finish_jog(rig)) << rig.story();
    EXPECT_NEAR(angle_rad(rig, joint), from + 0.1, 0.012);
    ASSERT_TRUE(jog(rig, joint, -0.1)) << rig.story();
    ASSERT_TRUE(finish_jog(rig)) << rig.story();
  }
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
  rig.devices().set_estop_closed(false);
  rig.run_for(1.3);
  EXPECT_FALSE(any_power(rig)) << rig.story();
}

// What is told of fewer joints than the arm has would leave one unwatched.
TEST(AnyArmsLimits, OfFewerJointsThanItsOwnMoveNothing) {
  Rig rig(six_joints(), 1, [](ControllerConfig& told) {
    for (safety::Limits* limits : {&told.limits, &told.mission_limits}) {
      limits->joints.pop_back();
      limits->checksum = safety::limits_checksum(*limits);
    }
  });
  ASSERT_TRUE(rig.controller().on_command(Command::home, rig.now()));
  rig.run_for(2);
  EXPECT_EQ(rig.step_now(), Step::off) << rig.story();
  EXPECT_GE(rig.count(Fault::limits_refused), 1u) << rig.story();
  EXPECT_FALSE(any_power(rig));
}

}  // namespace
}  // namespace lf::test
