// What a commissioning tells of what it has found.
#include "hal/vehicle/commissioner.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/arm/actuator.hpp"
#include "firmware/canopen/sdo_abort.hpp"
#include "hal/vehicle/operator_client.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::hal {
namespace {

TEST(Commissioned, TheFrictionOfEachJointIsToldWithItsResidual) {
  config::HomingOffsets offsets;
  offsets.friction_known[2] = true;
  offsets.friction[2] = {2.5, 0.0125, 0.25};
  const Json friction = friction_json(offsets);
  EXPECT_EQ(friction, Json::parse(R"({"elbow": {"coulomb_mnm": 2.5, "viscous_mnm_s": 0.0125, "rms_mnm": 0.25}})"));

  const Json done{{"state", "done"}, {"zeros", {{"elbow", -37}, {"jaw", 0}}}, {"friction", friction}};
  EXPECT_EQ(commissioning_text(done),
            "elbow     zero at -37 counts; friction 2.5 mN m and 0.0125 mN m per rad/s at the motor, residual 0.25 mN m\n"
            "jaw       zero at 0 counts; friction not measured: as the arm's description has it\n");
}

// A chain that was wired to the other input was found by no command.
TEST(StatusText, SaysHowTheEmergencyStopChainStands) {
  const Json none{{"p50", 0}, {"p999", 0}, {"max", 0}};
  const auto said = [&](const ControlReport& control, Json more) {
    Json status = status_json(control, {}, {}, {});
    status["latency"] = {{"wake_up_us", none}, {"tick_us", none}};
    status["lost"] = Json::array();
    status["counters"] = Json::object();
    status.update(more);
    const std::string text = status_text(status);
    const std::size_t at = text.find("  emergency-stop chain");
    return at == std::string::npos ? text : text.substr(at, text.find('\n', at) - at);
  };
  ControlReport control;
  EXPECT_EQ(said(control, Json::object()), "  emergency-stop chain not heard: the output node is not in operation");
  control.inputs_fresh = true;
  control.inputs = can_map::input_interlock_closed;
  EXPECT_EQ(said(control, Json::object()), "  emergency-stop chain open, laser's interlock closed");
  control.inputs = can_map::input_estop_closed;
  EXPECT_EQ(said(control, {{"estop_input_closed", false}}), "  emergency-stop chain closed, laser's interlock open; estop.input open");
  EXPECT_EQ(status_json(control, {}, {}, {})["estop_closed"], true);
  control.inputs_fresh = false;
  EXPECT_EQ(status_json(control, {}, {}, {})["estop_closed"], false) << "what it said before it fell silent";
}

// `why` was in the document alone.
TEST(StatusText, SaysWhatToDoWhenABootFailed) {
  ControlReport control;
  arm5e_joint::fill(control.boot.nodes, canopen::NodeBoot{});
  canopen::NodeBoot& elbow = control.boot.nodes[2];
  elbow.node = 3;
  elbow.failure = canopen::BootFailure::sdo_aborted;
  elbow.index = 0x1016;
  elbow.sub = 1;
  elbow.abort_code = canopen::sdo_abort::no_object;
  Json status = status_json(control, {}, {}, {});
  const Json none{{"p50", 0}, {"p999", 0}, {"max", 0}};
  status["latency"] = {{"wake_up_us", none}, {"tick_us", none}};
  status["lost"] = Json::array();
  status["counters"] = Json::object();
  EXPECT_NE(
      status_text(status).find("elbow (node 3): 1016:01 consumer heartbeat time does not exist (06020000). Without it the drive runs on"),
      std::string::npos)
      << status_text(status);
}

TEST(StatusText, NamesTheValvesAndButtonsOfAFilesPanel) {
  const PanelNames names{{"V1", "V2"}, {"B1", "B2"}, {"7"}};
  ControlReport control;
  (void)control.tasks.push_back(
      mission::TaskResult{.task = {.kind = mission::Task::Kind::turn_valve, .to_rad = rad_from_deg(45), .valve = 1}, .done = true});
  (void)control.tasks.push_back(mission::TaskResult{.task = {.kind = mission::Task::Kind::press_button, .button = 1}});
  Json status = status_json(control, {}, {}, names);
  EXPECT_EQ(status["tasks"][0]["valve"], "V2");
  EXPECT_EQ(status["tasks"][1]["button"], "B2");
  const Json none{{"p50", 0}, {"p999", 0}, {"max", 0}};
  status["latency"] = {{"wake_up_us", none}, {"tick_us", none}};
  status["lost"] = Json::array();
  status["counters"] = Json::object();
  EXPECT_NE(status_text(status).find("  task turn_valve V2 to 45.0 deg: done\n  task press_button B2: not done\n"), std::string::npos)
      << status_text(status);
  control.tasks[0].task.valve = 0;
  EXPECT_FALSE(status_json(control, {}, {}, {})["tasks"][0].contains("valve")) << "the docked mission's panel has one";
}

// A user learns that the marker was printed too small before the arm misses the valve.
TEST(StatusText, SaysThatTheCalibrationIsDoubtful) {
  const Json none{{"p50", 0}, {"p999", 0}, {"max", 0}};
  const auto said = [&](float side_error) {
    Telemetry telemetry;
    telemetry.sight.look = 1;
    telemetry.sight.fit = {true, 0.08f, 32, side_error, 0, 0, 0};
    Json status = status_json({}, telemetry, {}, {});
    status["latency"] = {{"wake_up_us", none}, {"tick_us", none}};
    status["lost"] = Json::array();
    status["counters"] = Json::object();
    return status_text(status);
  };
  EXPECT_EQ(said(0.001f).find("doubtful calibration"), std::string::npos);
  EXPECT_NE(said(-0.03f).find("  doubtful calibration: the marker's side on the scanned plane is off the surveyed one by -3.00 %"),
            std::string::npos)
      << said(-0.03f);
  ControlReport felt;
  (void)felt.tasks.push_back(
      mission::TaskResult{.task = {.kind = mission::Task::Kind::press_button}, .face_felt = true, .face_off_m = 0.006});
  EXPECT_NEAR(status_json(felt, {}, {}, {})["fit"]["faces_off_mm"], 6, 1e-9);
  EXPECT_TRUE(status_json(felt, {}, {}, {})["fit"].contains("doubt"));
  EXPECT_FALSE(status_json({}, {}, {}, {}).contains("fit")) << "before the first look";
}

TEST(Commissioned, AJointThatSomethingRubsAgainstIsLeftOutAndTheOthersAreTakenOver) {
  PerJoint<Motor> motors;
  for (Motor& motor : motors) motor.coulomb_nm = 1e-3, motor.viscous_nm_s = 1e-6;
  config::HomingOffsets offsets;
  offsets.known[1] = true;
  offsets.zero_counts[1] = 11;
  Commissioned commissioned;
  commissioned.found = {true, true, false, true, false};
  commissioned.zero_counts = {5, 6, 7, 8, 9};
  commissioned.friction_found = {true, true, true, false, false};
  commissioned.friction = {{{1, 1e-3, 0.1}, {100, 1e-3, 0.1}, {1, 1e-3, 0.1}, {}, {}}};
  commissioned.how = "in the jig";
  const std::vector<std::string> left_out = take_over(test::arm5e, commissioned, motors, offsets).left_out;
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_NE(left_out[0].find("'shoulder.coulomb_mnm' is 100"), std::string::npos) << left_out[0];
  EXPECT_EQ(offsets.known, (PerJoint<bool>{true, false, false, true, false})) << "the old zero may be as wrong";
  EXPECT_EQ(offsets.zero_counts[0], 5);
  EXPECT_EQ(offsets.zero_counts[3], 8);
  EXPECT_EQ(offsets.friction_known, (PerJoint<bool>{true, false, false, false, false}));
  EXPECT_EQ(offsets.friction[0].coulomb_mnm, 1);
}

// A zero alone, of a jig or of a joint that had too little way, does not show that what rubbed is gone. Such a joint moved with the description's friction.
TEST(Commissioned, AJointLeftOutForItsFrictionStaysOutUntilAFrictionWasMeasured) {
  PerJoint<Motor> motors;
  for (Motor& motor : motors) motor.coulomb_nm = 1e-3, motor.viscous_nm_s = 1e-6;
  const test::TemporaryFolder folder;
  const std::string file = folder.write("homing.yaml", "slew: {zero_counts: 3, coulomb_mnm: 1, viscous_mnm_s: 0.001}\n");
  const auto commission = [&](bool friction_found, double coulomb_mnm) {
    config::HomingOffsets offsets = config::read_homing_file(file, {});
    Commissioned commissioned;
    commissioned.found[0] = true;
    commissioned.zero_counts[0] = 5;
    commissioned.friction_found[0] = friction_found;
    commissioned.friction[0] = {coulomb_mnm, 1e-3, 0.1};
    commissioned.how = "at its stop";
    const std::vector<std::string> left_out = take_over(test::arm5e, commissioned, motors, offsets).left_out;
    config::write_homing_file(file, offsets);
    return left_out;
  };
  const auto known = [&] { return config::read_homing_file(file, {}).known[0]; };
  EXPECT_TRUE(commission(false, 0).empty());
  EXPECT_TRUE(known()) << "nothing was doubtful";
  EXPECT_EQ(commission(true, 100).size(), 1u);
  EXPECT_FALSE(known());
  const std::vector<std::string> again = commission(false, 0);
  ASSERT_EQ(again.size(), 1u);
  EXPECT_NE(again[0].find("the slew's friction was doubtful before, and no friction was measured now"), std::string::npos) << again[0];
  EXPECT_FALSE(known());
  EXPECT_EQ(commission(false, 0).size(), 1u) << "and so it stays";
  EXPECT_EQ(commission(true, -1).size(), 1u) << "a friction that is no number the file could hold";
  EXPECT_FALSE(known());
  EXPECT_TRUE(commission(true, 1).empty());
  EXPECT_TRUE(known());
  EXPECT_EQ(config::read_homing_file(file, {}).zero_counts[0], 5);
  // A figure in the file that cannot be counts as doubtful, too.
  folder.write("homing.yaml", "slew: {zero_counts: 3, coulomb_mnm: 100, viscous_mnm_s: 0.001}\n");
  EXPECT_EQ(commission(false, 0).size(), 1u);
  EXPECT_FALSE(known());
}

// A screw whose stop was taken to be where an obstacle stood, and back; and the roll's gear, whose counts are the angle everywhere.
// It was said that nothing was written, when the zero of a drive that had lost its position was no longer in the file.
TEST(Commissioned, TheEndSaysWhatTheFileHasOfEachJoint) {
  const JointSet none{}, jaw{false, false, false, false, true}, elbow{false, false, true};
  EXPECT_EQ(ending("", "", none, none, {}), "");
  EXPECT_EQ(ending("it was called off", "", none, none, {}), "nothing was written: it was called off");
  EXPECT_EQ(ending("it was called off", "", none, elbow, {}),
            "it was called off. These are no longer in the homing file, since their drives have lost their positions: elbow. Nothing else "
            "was written");
  EXPECT_EQ(ending("it was called off", "", jaw, elbow, {}),
            "it was called off. In the homing file the zeros of these joints are doubtful now: jaw. These are no longer in the homing "
            "file, since "
            "their drives have lost their positions: elbow. Nothing else was written");
}

// A changed file took a joint's power without a word.
TEST(Commissioned, AJointThatTheFileDoubtsIsNamed) {
  config::HomingOffsets offsets;
  offsets.known.fill(true);
  offsets.doubt_friction(1);
  ControllerConfig core;
  arm5e_joint::fill(core.network.drives, canopen::DriveSetup{});
  EXPECT_EQ(cut_off(offsets, {}, core), (std::vector<std::string>{"the homing file has the shoulder's friction as doubtful"}));
  EXPECT_TRUE(cut_off(offsets, {false, true}, core).empty()) << "it was commissioned";
}

TEST(Commissioned, AZeroThatHasMovedIsTold) {
  PerJoint<Motor> motors;
  for (const double off_rad : {0.02, 0.04, -0.04, 0.5}) {
    SCOPED_TRACE(off_rad);
    config::HomingOffsets offsets;
    offsets.known = {true, true, true, true, false};
    offsets.zero_counts = {0, 7, 7, -70'000, 7};
    Commissioned commissioned;
    commissioned.found = {true, true, false, true, true};
    commissioned.zero_counts = {0, 7, 0, -70'000, 900};
    commissioned.place_rad = {};
    const double roll_counts_rad = test::arm5e.model().joints[3].actuator.counts_per_rad;
    const double stop_rad = test::arm5e.model().joints[0].lower_rad;
    commissioned.place_rad[0] = stop_rad;
    const std::int32_t short_of_it = arm::counts_from_rad(test::arm5e.joint(arm5e_joint::slew), stop_rad + std::abs(off_rad)) -
                                     arm::counts_from_rad(test::arm5e.joint(arm5e_joint::slew), stop_rad);
    commissioned.zero_counts[0] = off_rad > 0 ? short_of_it : -short_of_it;
    commissioned.zero_counts[3] += static_cast<std::int32_t>(std::lround(off_rad * roll_counts_rad));
    const TakenOver taken = take_over(test::arm5e, commissioned, motors, offsets);
    EXPECT_TRUE(taken.left_out.empty());
    if (std::abs(off_rad) < 0.03) {
      EXPECT_EQ(taken.moved_rad, (PerJoint<double>{}));
      continue;
    }
    EXPECT_NEAR(taken.moved_rad[0], std::abs(off_rad), 0.1 * std::abs(off_rad));
    EXPECT_NEAR(taken.moved_rad[3], std::abs(off_rad), 1e-3);
    EXPECT_EQ(taken.moved_rad[1], 0);
    EXPECT_EQ(taken.moved_rad[2], 0) << "not commissioned";
    EXPECT_EQ(taken.moved_rad[4], 0) << "no earlier zero";
    EXPECT_EQ(offsets.zero_counts[3], commissioned.zero_counts[3]) << "it is told, not refused";
  }
  const Json done{{"state", "done"}, {"zeros", {{"elbow", -37}, {"jaw", 0}}}, {"moved_rad", {{"jaw", 0.123}}}};
  const std::string text = commissioning_text(done);
  EXPECT_NE(text.find("description has it; its zero has moved by 0.12 rad: if the drive and its encoder are the same as before, an "
                      "obstacle was taken for the stop\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("moved"), text.rfind("moved")) << text;
}

// The file was taken back to an older one, or the joint's line was deleted, while the core knows its zero. And a doubtful zero is compared with like any other.
TEST(Commissioned, AZeroHasMovedWhereTheCommissioningOrTheFileSaysSo) {
  const PerJoint<Motor> motors;
  config::HomingOffsets offsets;
  offsets.known = {false, true, true, false, false};
  offsets.zero_doubtful[3] = true;
  Commissioned commissioned;
  commissioned.found.fill(true);
  commissioned.place_rad = {};
  commissioned.zero_counts[3] = commissioned.zero_counts[4] = 900;
  commissioned.moved_rad = {0.2, 0.3, 0, 0, 0};
  const TakenOver taken = take_over(test::arm5e, commissioned, motors, offsets);
  EXPECT_EQ(taken.moved_rad[0], 0.2) << "which the file does not know";
  EXPECT_EQ(taken.moved_rad[1], 0.3) << "which the file has where it was found";
  EXPECT_EQ(taken.moved_rad[2], 0);
  EXPECT_GT(taken.moved_rad[3], 0.5);
  EXPECT_EQ(taken.moved_rad[4], 0) << "no earlier zero";
  EXPECT_EQ(offsets.known, (PerJoint<bool>{true, true, true, true, true})) << "found as ordered: no longer doubtful";
  EXPECT_EQ(offsets.zero_doubtful, (PerJoint<bool>{}));
}

TEST(Commissioned, AJointLeftOutForItsFrictionKeepsItsEarlierZeroAsADoubtfulOne) {
  PerJoint<Motor> motors;
  for (Motor& motor : motors) motor.coulomb_nm = 1e-3, motor.viscous_nm_s = 1e-6;
  config::HomingOffsets offsets;
  offsets.known[0] = true;
  offsets.zero_counts = {11, 0, 0, 0, 0};
  Commissioned commissioned;
  commissioned.found = {true, true, false, false, false};
  commissioned.zero_counts = {12, 13, 0, 0, 0};
  commissioned.place_rad = {};
  commissioned.friction_found = {true, true, false, false, false};
  commissioned.friction = {{{100, 1e-3, 0.1}, {100, 1e-3, 0.1}, {}, {}, {}}};
  EXPECT_EQ(take_over(test::arm5e, commissioned, motors, offsets).left_out.size(), 2u);
  EXPECT_TRUE(offsets.zero_doubtful[0]);
  EXPECT_EQ(offsets.zero_counts[0], 11);
  EXPECT_FALSE(offsets.has_earlier_zero(1)) << "it had none";
}

TEST(HomingFile, JointsWhoseFrictionCannotBeTakeNoPower) {
  PerJoint<Motor> motors;
  for (Motor& motor : motors) motor.coulomb_nm = 1e-3, motor.viscous_nm_s = 1e-6;
  config::HomingOffsets offsets;
  offsets.known.fill(true);
  offsets.friction_known = {true, true, false, false, false};
  offsets.friction = {{{1, 1e-3, 0.1}, {1, 1, 0.1}, {100, 1, 0.1}, {}, {}}};
  const std::vector<std::string> left_out = config::leave_out_doubtful(offsets, motors);
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_NE(left_out[0].find("'shoulder.viscous_mnm_s' is 1"), std::string::npos) << left_out[0];
  PerJoint<bool> known;
  known.fill(true);
  known[1] = false;
  EXPECT_EQ(offsets.known, known) << "what was not measured is not judged";
}

}  // namespace
}  // namespace lf::hal
