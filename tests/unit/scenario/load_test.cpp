#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/scenario/scenario_file.hpp"

namespace lf::scenario {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Load, AnEmptyFileIsTheDefaults) {
  const ScenarioFile file("# nothing\n");
  const Scenario loaded = load_scenario(file.path());
  const Scenario defaults;
  EXPECT_EQ(loaded.valve.friction_nm, defaults.valve.friction_nm);
  EXPECT_EQ(loaded.docking.x_m, (Spread{-0.020, 0.020}));
  ASSERT_EQ(loaded.tasks.size(), 2u);
  EXPECT_EQ(loaded.tasks[1].order, (std::vector<std::string>{"left", "centre", "right"}));
}

TEST(Load, ADocumentMayHaveItsMarkers) {
  EXPECT_EQ(complaint("%YAML 1.2\n---\nvalve: {start_deg: 3}\n...\n# that was it\n"), "");
  EXPECT_EQ(complaint("--- {valve: {start_deg: 3}}\n"), "");
}

// The library's LoadAll never ended on this one: found by the fuzz target.
TEST(Load, ADirectiveInTheMiddleIsRefusedAtOnce) { EXPECT_NE(complaint("a: b\n%YAML:1.0\n---\nc: d\n"), ""); }

TEST(Load, ReadsNumbersSpreadsListsAndTasks) {
  const ScenarioFile file(R"(
description: a test
valve: {start_deg: -12.5, friction_nm: {min: 1, max: 2}, detents_deg: [0, 45]}
lamps: {lit: true}
camera:
  always_on: yes
  exposure_us: 1500
panel:
  marker_centre_m: [-0.2, 0.1]
tasks:
  - press_buttons: {order: [right, right]}
  - turn_valve: {to_deg: 45}
faults:
  - {at_s: 3, kind: silent, node: jaw}
)");
  const Scenario s = load_scenario(file.path());
  EXPECT_EQ(s.description, "a test");
  EXPECT_EQ(s.valve.start_deg, Spread::fixed(-12.5));
  EXPECT_EQ(s.valve.friction_nm, (Spread{1, 2}));
  EXPECT_EQ(s.valve.detents_deg, (std::vector<double>{0, 45}));
  EXPECT_EQ(s.lamps.lit, Chance::yes);
  EXPECT_TRUE(s.camera.always_on);
  EXPECT_EQ(s.camera.exposure_us, 1500);
  EXPECT_EQ(s.panel.markers[0].centre_m, Vec2(-0.2, 0.1));
  ASSERT_EQ(s.tasks.size(), 2u);
  EXPECT_EQ(s.tasks[0].kind, Task::Kind::press_buttons);
  EXPECT_EQ(s.tasks[0].order, (std::vector<std::string>{"right", "right"}));
  EXPECT_EQ(s.tasks[1].to_deg, 45);
  ASSERT_EQ(s.faults.size(), 1u);
  EXPECT_EQ(s.faults[0].node, "jaw");
}

struct BadText {
  const char* name;
  const char* text;
  const char* complaint;
};

class Refused : public ::testing::TestWithParam<BadText> {};

TEST_P(Refused, WithTheLineAndTheCause) { EXPECT_THAT(complaint(GetParam().text), StartsWith(GetParam().complaint)); }

const BadText bad_texts[] = {
    {"MisspeltKey", "valve:\n  start_dge: 3\n", ":2: unknown key 'valve.start_dge'; did you mean 'valve.start_deg'?"},
    {"MisspeltSection", "\nvavle:\n  start_deg: 3\n", ":2: unknown key 'vavle'; did you mean 'valve'?"},
    {"KeyInTheWrongSection", "water:\n  friction_nm: 3\n", ":2: unknown key 'water.friction_nm'; did you mean 'valve.friction_nm'?"},
    {"KeyWithoutItsUnit", "water:\n  attenuation: 3\n", ":2: unknown key 'water.attenuation'; did you mean 'water.attenuation_per_m'?"},
    {"LongKeyWithoutItsUnit", "mission.sweep_speed: 1\n",
     ":1: unknown key 'mission.sweep_speed'; did you mean 'mission.sweep_speed_rad_s'?"},
    {"ForeignKey", "hydraulics: 3\n", ":1: unknown key 'hydraulics'"},
    {"KeyTwice", "valve:\n  stop_max_deg: 100\n  stop_max_deg: 101\n", ":3: 'valve.stop_max_deg' is given twice"},
    {"KeyTwiceInTwoForms", "valve.stop_max_deg: 100\nvalve: {stop_max_deg: 101}\n", ":2: 'valve.stop_max_deg' is given twice"},
    {"SecondDocument", "valve: {stop_max_deg: 100}\n---\nvalve: {stop_max_deg: 101}\n", ":2: a second document begins here"},
    {"SecondDocumentAfterAnEnd", "%YAML 1.2\n--- # first\nvalve: {stop_max_deg: 100}\n...\n# more\nvalve: {}\n",
     ":6: a second document begins here"},
    {"TextForNumber", "time_limit_s: soon\n", ":1: 'time_limit_s' takes a number, not 'soon'"},
    {"QuotedNumber", "time_limit_s: \"100\"\n", ":1: 'time_limit_s' takes a number, not '100'"},
    {"NumberWithUnit", "laser:\n  power_w: 0.1 W\n", ":2: 'laser.power_w' takes a number, not '0.1 W'"},
    {"ListForNumber", "time_limit_s: [1]\n", ":1: 'time_limit_s' takes a number, not a list"},
    {"NothingForNumber", "time_limit_s:\n", ":1: 'time_limit_s' takes a number, not nothing"},
    {"NumberForSection", "valve: 3\n", ":1: 'valve' takes a group of keys, not '3'"},
    {"FractionForWholeNumber", "camera: {exposure_us: 100.5}\n", ":1: 'camera.exposure_us' takes a whole number, not '100.5'"},
    {"TextForSwitch", "camera: {always_on: maybe}\n", ":1: 'camera.always_on' takes true or false, not 'maybe'"},
    {"TextForChance", "lamps: {lit: perhaps}\n", ":1: 'lamps.lit' takes true, false or either, not 'perhaps'"},
    {"NotANumber", "valve: {friction_nm: .nan}\n", ":1: 'valve.friction_nm' must be a finite number, not .nan"},
    {"BareNan", "valve: {friction_nm: nan}\n", ":1: 'valve.friction_nm' must be a finite number, not nan"},
    {"Infinite", "valve: {friction_nm: {min: 0, max: .inf}}\n", ":1: 'valve.friction_nm.max' must be a finite number, not .inf"},
    {"TooLargeToHold", "valve: {friction_nm: 1e999}\n", ":1: 'valve.friction_nm' must be a finite number"},
    {"BelowItsRange", "valve: {friction_nm: -1}\n", ":1: 'valve.friction_nm' is -1, out of its range 0 to 20 N m"},
    {"AboveItsRange", "water: {attenuation_per_m: {min: 0, max: 50}}\n",
     ":1: 'water.attenuation_per_m.max' is 50, out of its range 0 to 5 1/m"},
    {"SpreadUpsideDown", "valve:\n  friction_nm: {min: 3, max: 1}\n", ":2: 'valve.friction_nm' has its min above its max"},
    {"SpreadWithoutMax", "valve: {friction_nm: {min: 3}}\n", ":1: 'valve.friction_nm' needs both min and max"},
    {"SpreadMisspelt", "valve: {friction_nm: {min: 3, mx: 4}}\n",
     ":1: unknown key 'valve.friction_nm.mx'; did you mean 'valve.friction_nm.max'?"},
    {"ListTooShort", "panel: {marker_centre_m: [0.1]}\n", ":1: 'panel.marker_centre_m' takes a list of 2 numbers, not a list"},
    {"UnknownTask", "tasks:\n  - turn_vale: {to_deg: 3}\n", ":2: unknown key 'tasks[0].turn_vale'; did you mean 'tasks[0].turn_valve'?"},
    {"TaskWithoutArguments", "tasks:\n  - turn_valve\n", ":2: 'tasks[0]' takes one task, turn_valve or press_buttons, not 'turn_valve'"},
    {"UnknownButton", "tasks:\n  - press_buttons: {order: [center]}\n",
     ":2: 'tasks[0].press_buttons.order' has no 'center'; did you mean 'centre'?"},
    {"NoButton", "tasks:\n  - press_buttons: {order: []}\n", ":2: 'tasks[0].press_buttons.order' names no button"},
    {"TooMuchToDo",
     "tasks: [press_buttons: {order: [left, left, left, left, left, left, left, left, left, left, left, left, left, left, left, left, "
     "left]}]\n",
     ": 'tasks' has 17 turns and presses; the core holds 16"},
    {"TargetBeyondTheStop", "tasks: [turn_valve: {to_deg: 150}]\n",
     ": 'turn_valve.to_deg' is 150, beyond the valve's stops at -105 and 105"},
    {"UnknownFault", "faults:\n  - {at_s: 1, kind: silnet, node: jaw}\n", ":2: 'faults[0].kind' has no 'silnet'; did you mean 'silent'?"},
    {"FaultWithoutNode", "faults: [{at_s: 1, kind: silent}]\n", ":1: 'faults[0].node': silent needs a node"},
    {"FaultWithoutKind", "faults: [{at_s: 1}]\n", ":1: 'faults[0]' has no kind"},
    {"NotYaml", "valve: {start_deg: 3\n", ":2: not YAML"},
    {"TabIndented", "valve:\n\tstart_deg: 3\n", ":2: not YAML"},
    {"AList", "- 1\n", ":1: a scenario is a group of keys"},
    {"KeyThatIsAList", "[1]: 3\n", ":1: a key must be a word"},
    {"StartBeyondTheStop", "valve: {start_deg: 120}\n", ": 'valve.start_deg' is 120, beyond the valve's stops at -105 and 105"},
    {"FramesTooFast", "mission: {camera_syncs: 1}\n", ":1: 'mission.camera_syncs' is 1, out of its range 2 to 20"},
    {"FramesTooSlow", "mission: {camera_syncs: 21}\n", ":1: 'mission.camera_syncs' is 21, out of its range 2 to 20"},
    {"CapsuleOfSixNumbers", "vehicle: {capsules_m: [[0, 0, 0, 1, 0, 1]]}\n", ":1: 'vehicle.capsules_m' takes a list of lists of 7 numbers"},
    {"DistortionTooShort", "camera: {distortion: [0.1]}\n", ": 'camera.distortion' takes 5 numbers"},
};
INSTANTIATE_TEST_SUITE_P(Load, Refused, ::testing::ValuesIn(bad_texts), [](const auto& test) { return std::string(test.param.name); });

TEST(Load, ListsAllProblemsOfAFileAndItsOverridesAtOnceEachWithItsLine) {
  const std::string told = complaint(R"(valve:
  fricton_nm: 2
  start_deg: left
water: {attenuation_per_m: 9}
)",
                                     {"camera.noise_grey=-1"});
  EXPECT_THAT(told, HasSubstr(":2: unknown key 'valve.fricton_nm'"));
  EXPECT_THAT(told, HasSubstr(":3: 'valve.start_deg' takes a number"));
  EXPECT_THAT(told, HasSubstr(":4: 'water.attenuation_per_m' is 9, out of its range"));
  EXPECT_THAT(told, HasSubstr("--set camera.noise_grey=-1: "));
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 3) << told;
}

TEST(Load, AProblemOfAKeyDoesNotHideThatTheJobCannotBeDone) {
  const std::string told = complaint("valve: {fricton_nm: 2}\n", {"camera.right_deg=180"});
  EXPECT_THAT(told, HasSubstr("fricton_nm"));
  EXPECT_THAT(told, HasSubstr("is behind the camera"));
}

TEST(Load, AButtonIsStuckOrMissingNotBoth) {
  EXPECT_THAT(complaint("buttons: {stuck: [left, right], missing: [right]}\n"),
              ::testing::HasSubstr("'buttons.stuck' and 'buttons.missing' both name right"));
  EXPECT_EQ(complaint("buttons: {stuck: [left], missing: [right]}\n"), "");
}

TEST(Load, AButtonThatThePressDoesNotMoveIsRefusedWithTheTorqueThatItTakes) {
  EXPECT_THAT(complaint("buttons: {preload_n: 25}\n"), ::testing::HasSubstr("take 30 N at half the stroke"));
  EXPECT_THAT(complaint("buttons: {spring_n_m: 9000}\n"), ::testing::HasSubstr("would take the button for stuck. It takes 9.62 N m"));
  EXPECT_EQ(complaint("buttons: {preload_n: 15}\n"), "");
  EXPECT_EQ(complaint("buttons: {preload_n: 25}\nmission: {press_torque_nm: 14}\n"), "");
}

// It went on that the list was empty, and that the angle was missing.
TEST(Load, AMistakeInATaskIsToldOnce) {
  const std::string said = complaint("tasks:\n  - turn_valve: 90\n");
  EXPECT_THAT(said, StartsWith(":2: 'tasks[0].turn_valve' takes a group of keys, not '90'"));
  EXPECT_EQ(said.find('\n'), std::string::npos) << said;
}

TEST(Load, AFaultHappensAtATimeOrAtAStep) {
  const ScenarioFile file(
      "faults:\n  - {at_step: turn, after_s: 0.5, kind: silent, node: io}\n  - {at_step: 'abandon, back', kind: obstacle}\n");
  const Scenario s = load_scenario(file.path());
  ASSERT_EQ(s.faults.size(), 2u);
  EXPECT_EQ(s.faults[0].at_step, "turn");
  EXPECT_EQ(s.faults[0].after_s, 0.5);
  EXPECT_THAT(complaint("faults: [{at_step: trun, kind: estop}]\n"), HasSubstr("has no 'trun'; did you mean 'turn'?"));
  EXPECT_THAT(complaint("faults: [{at_step: turn, at_s: 3, kind: estop}]\n"), HasSubstr("estop has both at_s and at_step"));
  EXPECT_THAT(complaint("faults: [{after_s: 3, kind: estop}]\n"), HasSubstr("estop has after_s without at_step"));
}

// It meant 90 degrees in silence.
TEST(Load, ATurnSaysToWhichAngle) {
  EXPECT_THAT(complaint("tasks: [turn_valve: {}]\n"), HasSubstr(":1: 'tasks[0].turn_valve.to_deg' is missing"));
  for (const char* other : {"90", "", "[90]"}) {
    SCOPED_TRACE(other);
    EXPECT_THAT(complaint("tasks: [turn_valve: " + std::string(other) + "]\n"), HasSubstr("tasks[0].turn_valve"));
  }
}

TEST(Load, AFaultHappensToWhatItCanHappenTo) {
  EXPECT_THAT(complaint("faults:\n  - {at_s: 1, kind: estop}\n  - {at_s: 2, kind: silent}\n"),
              HasSubstr(":3: 'faults[1].node': silent needs a node"));
  EXPECT_THAT(complaint("faults: [{kind: silent}]\n"), HasSubstr("silent needs a node"));
  EXPECT_THAT(complaint("faults: [{at_s: 1, kind: bus_off, node: master, can_id: 5}]\n"),
              HasSubstr("'faults[0].can_id': bus_off takes no can_id"));
  EXPECT_THAT(complaint("faults: [{kind: estop}]\n"), HasSubstr("'faults[0].at_s': estop needs a time: at_s, or at_step"));
  EXPECT_EQ(complaint("faults: [{at_s: 0, kind: estop}, {kind: limits_refused}]\n"), "");
  EXPECT_THAT(complaint("faults: [{kind: overcurrent, node: io}]\n"), HasSubstr("overcurrent does not happen to io"));
  EXPECT_THAT(complaint("faults: [{kind: estop, node: jaw}]\n"), HasSubstr("estop takes no node"));
  EXPECT_THAT(complaint("faults: [{kind: drop_frames}]\n"), HasSubstr("drop_frames needs a can_id"));
  EXPECT_THAT(complaint("faults: [{kind: limits_refused, at_s: 3}]\n"), HasSubstr("is there from power-on or not at all"));
}

TEST(Load, AnExpectedFailureIsAFaultsName) {
  EXPECT_EQ(load_scenario("drive_fault").expect.failure, "drive fault");
  EXPECT_THAT(complaint("expect: {failure: drive falt}\n"), HasSubstr("did you mean 'drive fault'?"));
}

TEST(Load, AnyTruncationOfAScenarioIsReadOrRefusedButNeverCrashes) {
  const std::string whole =
      "valve: {start_deg: {min: -3, max: 4}}\ntasks:\n  - press_buttons: {order: [left, right]}\nfaults: [{at_s: 1, kind: estop}]\n";
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    SCOPED_TRACE(whole.substr(0, length));
    const std::string said = complaint(whole.substr(0, length));
    // A line a problem: half a key is one, and the job that is missing behind it may be another.
    EXPECT_LE(std::count(said.begin(), said.end(), '\n'), 2) << said;
    EXPECT_EQ(said.find("\n\n"), std::string::npos) << said;
  }
  EXPECT_EQ(complaint(whole), "");
}

TEST(Load, AMissingFileAFolderAndAForeignNameAreRefused) {
  EXPECT_THROW(load_scenario("no/such/file.yaml"), InputError);
  EXPECT_THROW(load_scenario("/"), InputError);
  try {
    load_scenario("defualt");
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "no scenario 'defualt'; did you mean 'default'?");
  }
}

TEST(Load, BinaryRubbishIsRefused) {
  EXPECT_NE(complaint(std::string("\x7f"
                                  "ELF\0\0\1\2\xff\xfe",
                                  10)),
            "");
}

TEST(Override, ChangesOneKeyAndLeavesTheRest) {
  const Scenario s =
      load_scenario("default", {"valve.start_deg=10", "water.attenuation_per_m={min: 0.2, max: 0.3}", "camera.always_on=true"});
  EXPECT_EQ(s.valve.start_deg, Spread::fixed(10));
  EXPECT_EQ(s.water.attenuation_per_m, (Spread{0.2, 0.3}));
  EXPECT_TRUE(s.camera.always_on);
  EXPECT_EQ(s.valve.friction_nm, Scenario().valve.friction_nm);
}

TEST(Override, TheLastOneWinsAndListsAreReplacedWhole) {
  const Scenario s = load_scenario("default", {"valve.start_deg=10", "valve.start_deg=20", "tasks=[turn_valve: {to_deg: 30}]"});
  EXPECT_EQ(s.valve.start_deg, Spread::fixed(20));
  ASSERT_EQ(s.tasks.size(), 1u);
  EXPECT_EQ(s.tasks[0].to_deg, 30);
}

TEST(Override, IsCheckedAsTheFileIs) {
  EXPECT_EQ(complaint("", {"valve.strat_deg=10"}),
            "--set valve.strat_deg=10: unknown key 'valve.strat_deg'; did you mean 'valve.start_deg'?");
  EXPECT_EQ(complaint("", {"valve.start_deg"}), "--set valve.start_deg: needs the form path.to.key=value");
  EXPECT_EQ(complaint("", {"=3"}), "--set =3: needs the form path.to.key=value");
  EXPECT_THAT(complaint("", {"valve.friction_nm=nan"}), HasSubstr("must be a finite number"));
  EXPECT_THAT(complaint("", {"valve.friction_nm="}), HasSubstr("takes a number or {min: , max: }, not nothing"));
  EXPECT_THAT(complaint("", {"valve.friction_nm={min: 1"}), HasSubstr("not YAML"));
  EXPECT_THAT(complaint("", {"valve=3"}), HasSubstr("'valve' is a group of keys"));
}

TEST(Shipped, EveryScenarioLoadsAndSaysWhatItIs) {
  std::vector<std::string> names;
  for (const ShippedScenario& shipped : shipped_scenarios()) {
    EXPECT_GT(shipped.description.size(), 20u) << shipped.name;
    names.push_back(shipped.name);
  }
  EXPECT_THAT(names,
              ::testing::IsSupersetOf({"default", "clear_water", "turbid", "turn_only", "buttons_only", "hard_valve", "drive_fault"}));
}

TEST(Load, ALatencyBeyondItsTimeOutIsRefusedByBothNames) {
  EXPECT_THAT(complaint_before_a_run("latency: {image_ms: 220}"), HasSubstr("'latency.image_ms' is 220: by 'stale_image_s'"));
  EXPECT_THAT(complaint_before_a_run("latency: {panel_vision_ms: 3000}"),
              HasSubstr("'latency.panel_vision_ms' is 3000: by 'vision_timeout_s'"));
  // A scenario that is to end so may make it so.
  EXPECT_EQ(complaint_before_a_run("latency: {panel_vision_ms: 3000}\nexpect: {failure: panel vision late}"), "");
  for (const char* other : {"emergency stop", "image lost"})
    EXPECT_THAT(complaint_before_a_run(std::string("latency: {panel_vision_ms: 3000}\nexpect: {failure: ") + other + "}"),
                HasSubstr("'latency.panel_vision_ms' is 3000"));
}

TEST(Load, AJawBelowItsMotorsRatingIsRefusedByItsKey) {
  EXPECT_THAT(complaint_before_a_run("jaw: {torque_nm: 15}"), HasSubstr("'jaw.torque_nm' is 15, below the rated torque of 20 N m"));
  EXPECT_EQ(complaint_before_a_run("jaw: {torque_nm: 20}"), "");
  EXPECT_EQ(complaint_before_a_run("jaw: {torque_nm: 0}"), "");
}

TEST(Load, ButtonsAreCheckedWhereOneIsPressed) {
  const std::string turn = "\ntasks: [{turn_valve: {to_deg: 90}}]";
  EXPECT_THAT(complaint("mission: {press_torque_nm: 2}"), HasSubstr("'mission.press_torque_nm' at 2"));
  EXPECT_EQ(complaint("mission: {press_torque_nm: 2}" + turn), "");
  EXPECT_THAT(complaint("panel: {button_height_m: 0.005}"), HasSubstr("'panel.button_height_m' is 0.005: with 'panel.button_stroke_m'"));
  EXPECT_EQ(complaint("panel: {button_height_m: 0.005}" + turn), "");
}

TEST(Load, EveryButtonOutOfReachIsTold) {
  const std::string told = complaint_before_a_run("panel: {ahead_m: 0.7}");
  for (const char* what : {"the valve is out", "the left button is out", "the centre button is out", "the right button is out"})
    EXPECT_THAT(told, HasSubstr(what));
}

TEST(Load, AValveThatIsTooStiffOrOutOfReachIsRefusedByNameAndNumber) {
  const auto told = [](const std::string& valve) {
    return complaint_before_a_run("panel: {file: after_17h}\ntasks: [turn_valve: {valve: " + valve + ", to_deg: 30}]");
  };
  for (const char* turned : {"T16", "P10", "D16"}) EXPECT_EQ(told(turned), "") << turned;
  EXPECT_THAT(told("T19"),
              AllOf(HasSubstr("valve T19 needs 67 N m, the arm gives 4.06"), HasSubstr("valve T19 is out of the arm's reach")));
  EXPECT_THAT(told("F16"), HasSubstr("valve F16 is out of the arm's reach"));
}

TEST(Load, AnArmWithoutARollIsGivenButtonsAndNoValve) {
  const std::string there = "machine: predator\npanel: {ahead_m: 1.6, down_m: 0, pointer: none}\nmission: {press_torque_nm: 20}\n";
  EXPECT_EQ(complaint_before_a_run(there + "tasks: [press_buttons: {order: [left, right]}]"), "");
  EXPECT_THAT(complaint_before_a_run(there + "tasks: [turn_valve: {to_deg: 45}]"),
              AllOf(HasSubstr("the valve cannot be turned: this arm has no roll, its last joint, 'wrist_yaw', swings the hand"),
                    Not(HasSubstr("the arm gives"))));
}

TEST(Load, ALaserIsTurnedOnArmsThatPoint) {
  EXPECT_THAT(complaint_before_a_run("laser: {turn_deg: 90}"), HasSubstr("'laser.turn_deg' is not 0"));
  EXPECT_THAT(complaint("laser: {turn_deg: 181}"), HasSubstr("laser.turn_deg"));
}

TEST(Load, APanelsFileIsWhatItsTasksName) {
  const auto told = [](const std::string& tasks, const std::string& more = "") {
    return complaint("panel: {file: pandora}\ntasks: [" + tasks + "]\n" + more);
  };
  const std::string turn = "turn_valve: {valve: V1, to_deg: 45}";
  EXPECT_EQ(told(turn + ", press_buttons: {order: [B2, B1]}"), "");
  EXPECT_THAT(told("turn_valve: {to_deg: 45}"), StartsWith(": 'turn_valve.valve' is missing: the panel has V1, V2, V3, V4"));
  EXPECT_THAT(told("turn_valve: {valve: V9, to_deg: 45}"),
              StartsWith(": 'turn_valve.valve': the panel has no valve 'V9'; it has V1, V2, V3, V4"));
  EXPECT_THAT(told("turn_valve: {valve: V2, to_deg: 106}"),
              StartsWith(": 'turn_valve.to_deg' is 106, beyond valve V2's stops at -105 and 105"));
  EXPECT_THAT(told("press_buttons: {order: [B1, left]}"),
              StartsWith(": 'press_buttons.order': the panel has no button 'left'; it has B1, B2"));
  EXPECT_EQ(told(turn, "buttons: {stuck: [B1], missing: [B2]}\n"), "");
  EXPECT_THAT(told(turn, "buttons: {stuck: [left]}\n"), StartsWith(": 'buttons.stuck': the panel has no button 'left'"));
  EXPECT_THAT(complaint("panel: {file: pandora, marker_id: 3}\ntasks: [" + turn + "]\n"),
              StartsWith(": 'panel.marker_id' is of the docked mission's panel"));
  EXPECT_EQ(told(turn).find('\n'), std::string::npos);
  // On the docked mission's panel the one valve needs no name.
  EXPECT_EQ(complaint("tasks: [turn_valve: {valve: valve, to_deg: 45}]\n"), "");
  EXPECT_THAT(complaint("tasks: [" + turn + "]\n"), StartsWith(": 'turn_valve.valve': the panel has no valve 'V1'; it has valve"));
}

TEST(Load, APanelsFileMayBeGivenByAnOverride) {
  for (const char* name : {"pandora", "\"pandora\"", "'pandora'"})
    EXPECT_EQ(complaint("", {std::string("panel.file=") + name, "tasks=[press_buttons: {order: [B1]}]"}), "") << name;
  EXPECT_THAT(complaint("", {"panel.file=pandra"}), StartsWith(": 'panel.file': no shipped panel 'pandra'; did you mean 'pandora'?"));
}

TEST(Load, AFaultWithAMistakeDoesNotHideTheNextOnes) {
  const std::string told = complaint(
      "faults:\n"
      "  - {kind: overcurrent, at_s: 1}\n"
      "  - {kind: drop_frames, at_s: 1}\n"
      "  - 3\n"
      "  - {kind: estop}\n");
  EXPECT_THAT(told, StartsWith(":2: 'faults[0].node': overcurrent needs a node"));
  EXPECT_THAT(told, HasSubstr(":3: 'faults[1].can_id': drop_frames needs a can_id"));
  EXPECT_THAT(told, HasSubstr(":4: 'faults[2]' takes a group of keys"));
  EXPECT_THAT(told, HasSubstr(":5: 'faults[3].at_s': estop needs a time"));
}

}  // namespace lf::scenario
