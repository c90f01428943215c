// The sub-commands that stand alone, run as a user runs them.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sstream>

#include "firmware/safety/faults.hpp"
#include "hal/vision/codecs/picture_codecs.hpp"
#include "host_sim/record/png.hpp"
#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::json;

class Commands : public Program {
 protected:
  // A Gaussian stripe of sigma 2 px at v = centre + slope u, over a grey of 20.
  std::string stripe(const std::string& name, double centre, double slope) const {
    std::vector<std::uint8_t> pixels(120 * 100);
    for (int v = 0; v < 100; ++v) {
      for (int u = 0; u < 120; ++u) {
        const double off = (v - centre - slope * u) / 2.0;
        pixels[static_cast<std::size_t>(v * 120 + u)] = static_cast<std::uint8_t>(std::lround(20 + 150 * std::exp(-0.5 * off * off)));
      }
    }
    const std::vector<std::uint8_t> png = record::encode_png(ImageView{pixels.data(), 120, 100, 120});
    return file(name, std::string(png.begin(), png.end()));
  }
};

TEST_F(Commands, EveryCommandHasHelpAndHelpIsNoFailure) {
  for (const char* command : {"", "run", "campaign", "compare", "serve", "render-frames", "scenarios", "reach", "peaks", "plane", "markers",
                              "ik", "check", "new", "bench", "doctor", "version"}) {
    const Said said = run(std::string(command) + " --help");
    EXPECT_EQ(said.status, 0) << command;
    EXPECT_NE(said.out.find("--help"), std::string::npos) << command;
    EXPECT_EQ(said.err, "") << command;
  }
}

TEST_F(Commands, VersionAndScenariosTell) {
  EXPECT_TRUE(json_of("version").contains("version"));
  EXPECT_EQ(run("--version").out, run("version").out);
  const Json scenarios = json_of("scenarios");
  ASSERT_TRUE(scenarios.is_array());
  EXPECT_GE(scenarios.size(), 7u);
  EXPECT_EQ(run("scenarios hard_valve").status, 0);
}

// 2310 is "continuous over-current" in the standard, and "overcurrent" with EPOS4.
TEST_F(Commands, RunTellsADrivesErrorInItsMakersWords) {
  const std::string arguments = "run default --set 'faults=[{at_step: deploy, after_s: 0.1, kind: overcurrent, node: elbow}]' --out ";
  for (const auto& [make, text] :
       {std::pair{"lanternfish", "EMCY 0x2310 (continuous over-current)"}, std::pair{"epos4", "EMCY 0x2310 (overcurrent)"}}) {
    const Said said = run(arguments + make + " --set drives.elbow.profile=" + make);
    const Json result = Json::parse(text_of(folder() / make / "result.json"));
    EXPECT_NE(result["failure"]["reason"].get<std::string>().find(text), std::string::npos) << result["failure"];
    EXPECT_NE((said.out + said.err).find(text), std::string::npos) << said.out << said.err;
  }
}

TEST_F(Commands, DoctorFindsThisMachineFit) {
  const Json doctor = json_of("doctor");
  EXPECT_EQ(doctor["good"], true) << doctor.dump(2);
}

// Forward again by the published closed form: R = a0 + a1 cos b - a2 cos g + d sin g ... with the angles that ik gave.
TEST_F(Commands, IkGivesJointsThatReachTheTarget) {
  const Json ik = json_of("ik --x 0.34 --y 0 --z 0.592");
  ASSERT_EQ(ik["reachable"], true);
  const double shoulder = ik["joints_rad"]["shoulder"], elbow = ik["joints_rad"]["elbow"];
  const double b = shoulder + 0.139277, g = b + elbow + 1.972222;
  const double r = 0.08052 + 0.44278 * std::cos(b) - 0.083 * std::cos(g) + 0.49257 * std::sin(g);
  const double z = 0.44278 * std::sin(b) - 0.083 * std::sin(g) - 0.49257 * std::cos(g);
  EXPECT_NEAR(std::abs(r), 0.34, 1e-5) << "the arm is folded under: it looks the other way";
  EXPECT_NEAR(z, 0.592, 1e-5);
  const Json far = json_of("ik --x 2 --y 0 --z 0", 1);
  EXPECT_EQ(far["reachable"], false);
  EXPECT_TRUE(far.contains("reason"));
}

TEST_F(Commands, PeaksFindsAKnownStripe) {
  const std::string image = stripe("stripe.png", 40.3, 0.1);
  const Json found = json_of("peaks " + image + " --overlay overlay.png");
  EXPECT_EQ(found["width"], 120);
  EXPECT_EQ(found["height"], 100);
  ASSERT_EQ(found["peaks"].size(), 120u);
  for (const Json& peak : found["peaks"]) EXPECT_NEAR(double(peak["v"]), 40.3 + 0.1 * double(peak["u"]), 0.07);
  EXPECT_TRUE(std::filesystem::exists(folder() / "overlay.png"));
  const Said csv = run("peaks " + image + " --csv");
  EXPECT_EQ(csv.out.substr(0, 22), "u,v,amplitude,ratio\n0.");
}

TEST_F(Commands, PeaksSubtractsTheImageWithoutTheLaser) {
  const std::string image = stripe("stripe.png", 40, 0);
  const Json found = json_of("peaks " + image + " --off " + image, 1);
  EXPECT_EQ(found["peaks"].size(), 0u) << "the same picture twice leaves nothing";
  EXPECT_NE(found["doubts"].dump().find("peaks in 0 of 120 lines"), std::string::npos) << found["doubts"];
}

// A green stripe at row 40 and a white one, brighter, at row 70, of 12 bits in 16: grey sees the white one, green-excess the green one.
TEST_F(Commands, PeaksFindsTheLasersColourInOnePicture) {
  cv::Mat picture(100, 120, CV_16UC3);
  for (int v = 0; v < 100; ++v) {
    const double green = 1500 * std::exp(-0.5 * std::pow((v - 40.3) / 2, 2)), white = 3000 * std::exp(-0.5 * std::pow((v - 70.0) / 2, 2));
    for (int u = 0; u < 120; ++u) {
      const auto light = [](double grey) { return static_cast<std::uint16_t>(std::lround(300 + grey)); };
      picture.at<cv::Vec3w>(v, u) = cv::Vec3w(light(white), light(white + green), light(white));
    }
  }
  for (const char* name : {"colour.png", "colour.tiff"}) {
    ASSERT_TRUE(vision::picture_codecs().write((folder() / name).string(), picture));
    const Json excess = json_of(std::string("peaks ") + name + " --channel green-excess"), grey = json_of(std::string("peaks ") + name);
    ASSERT_EQ(excess["peaks"].size(), 120u) << name;
    ASSERT_EQ(grey["peaks"].size(), 120u) << name;
    for (const Json& peak : excess["peaks"]) EXPECT_NEAR(double(peak["v"]), 40.3, 0.05) << name;
    for (const Json& peak : grey["peaks"]) EXPECT_NEAR(double(peak["v"]), 70.0, 0.05) << name;
  }
  EXPECT_EQ(json_of("peaks colour.png --channel g")["peaks"].size(), 120u);
  const Said refused = run("peaks colour.png --channel green-exces");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("did you mean 'green-excess'?"), std::string::npos) << refused.err;
}

TEST_F(Commands, PlaneFitsAKnownPlane) {
  std::string csv = "x,y,z\n";
  for (int i = 0; i < 400; ++i) {
    const double x = 0.05 * (i % 20), y = 0.05 * (i / 20);
    csv += std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(0.5 + 0.25 * x) + "\n";
  }
  const std::string cloud = file("plane.csv", csv);
  const Json plane = json_of("plane " + cloud);
  const double norm = std::sqrt(1 + 0.25 * 0.25);
  EXPECT_NEAR(std::abs(double(plane["normal"][0])), 0.25 / norm, 1e-5);
  EXPECT_NEAR(std::abs(double(plane["normal"][2])), 1 / norm, 1e-5);
  EXPECT_NEAR(std::abs(double(plane["offset_m"])), 0.5 / norm, 1e-5);
  EXPECT_EQ(plane["inliers"], 400);
}

TEST_F(Commands, APlaneThatIsNotThereIsAFailureNotAnError) {
  const std::string cloud = file("two.csv", "x,y,z\n0,0,0\n1,1,1\n");
  EXPECT_EQ(run("plane " + cloud).status, 1);
}

TEST_F(Commands, ReachDrawsAndHoldsTheLayoutToItsFigures) {
  const Json reach = json_of("reach --out reach.png --draws 500");
  EXPECT_GT(std::filesystem::file_size(folder() / "reach.png"), 10000u);
  ASSERT_EQ(reach["targets"].size(), 4u);
  for (const Json& target : reach["targets"]) {
    EXPECT_EQ(target["reached"], 500) << target.dump();
    EXPECT_LE(double(target["worst_tilt_deg"]), 20.0) << target.dump();
    if (target.contains("handle_clearance_mm")) {
      EXPECT_GE(double(target["handle_clearance_mm"]), 20.0) << target.dump();
    }
  }
}

// In real time the run goes on for 44 s, on any machine.
TEST_F(Commands, CtrlCStopsARunAndKeepsWhatWasRecorded) {
  const Said said = interrupt("run turn_only --set time_limit_s=600 --realtime --out kept --json", "kept.writing/can0.log", 1000);
  EXPECT_EQ(said.status, 130) << said.err;
  const Json result = Json::parse(text_of(folder() / "kept" / "result.json"));
  EXPECT_EQ(result["success"], false);
  EXPECT_EQ(result["failure"]["reason"], "interrupted");
  EXPECT_EQ(Json::parse(said.out)["failure"]["reason"], "interrupted");
  EXPECT_TRUE(std::filesystem::exists(folder() / "kept" / "report.html"));
  EXPECT_GT(std::filesystem::file_size(folder() / "kept" / "can0.log"), 1000u);
}

TEST_F(Commands, AnInterruptedRunLeavesTheFinishedOneInItsPlace) {
  const std::string arguments = "run turn_only --set time_limit_s=3 --no-outside --out kept --json";
  EXPECT_EQ(run(arguments).status, 1);
  const std::string before = text_of(folder() / "kept" / "result.json");
  const Said said = interrupt(arguments + " --realtime", "kept.writing/can0.log", 1000);
  EXPECT_EQ(said.status, 130) << said.err;
  EXPECT_EQ(text_of(folder() / "kept" / "result.json"), before);
  EXPECT_FALSE(std::filesystem::exists(folder() / "kept.writing"));
}

// What differs decides, not the folder's name.
TEST_F(Commands, AFolderOfAnotherExperimentIsRefusedWithWhatDiffers) {
  file("my.yaml", "time_limit_s: 2\ntasks: [{turn_valve: {to_deg: 90}}]\n");
  EXPECT_EQ(run("campaign ./my.yaml --seeds 1 --jobs 1 --out c").status, 1);
  const Said again = run("campaign ./my.yaml --seeds 1 --jobs 1 --out c");
  EXPECT_NE(again.out.find("(kept)"), std::string::npos) << again.out << again.err;
  file("my.yaml", "time_limit_s: 2\nvalve: {friction_nm: 2}\ntasks: [{turn_valve: {to_deg: 90}}]\n");
  const Said edited = run("campaign ./my.yaml --seeds 1 --jobs 1 --out c");
  EXPECT_EQ(edited.status, 2);
  EXPECT_NE(edited.err.find("holds another experiment: valve.friction_nm was {min: 0.5, max: 3}, is 2"), std::string::npos) << edited.err;
  EXPECT_EQ(run("run ./my.yaml --no-outside --out c/1").status, 2);
  EXPECT_EQ(run("run ./my.yaml --no-outside --seed 2 --out r").status, 1);
  EXPECT_NE(run("run ./my.yaml --no-outside --seed 5 --out r").err.find("seed was 2, is 5"), std::string::npos);
}

// What no key of the scenario names is read, too.
TEST_F(Commands, AFolderFlownWithOtherZerosOfTheJointsIsAnotherExperiment) {
  file("my.yaml", "time_limit_s: 1\ntasks: [{turn_valve: {to_deg: 90}}]\n");
  EXPECT_EQ(run("run ./my.yaml --no-outside --out r").status, 1);
  EXPECT_NE(text_of(folder() / "r" / "experiment.json").find("file drives/objects.csv"), std::string::npos);
  std::filesystem::create_directory(folder() / "homing");
  file("homing/simulator.yaml", text_of("shared/homing/simulator.yaml") + "# measured again\n");
  const Said again = run("run ./my.yaml --no-outside --out r");
  EXPECT_EQ(again.status, 2);
  EXPECT_NE(again.err.find("homing/simulator.yaml"), std::string::npos) << again.err;
}

TEST_F(Commands, DefaultFoldersOfDifferentExperimentsDoNotMeet) {
  EXPECT_EQ(run("run turn_only --no-outside --set time_limit_s=1").status, 1);
  EXPECT_EQ(run("run turn_only --no-outside --set time_limit_s=1.5").status, 1);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder() / "runs"), {}), 2);
}

TEST_F(Commands, DefaultFoldersOfDifferentCampaignsDoNotMeet) {
  EXPECT_EQ(run("campaign turn_only --seeds 1 --jobs 1 --set time_limit_s=1").status, 1);
  EXPECT_EQ(run("campaign turn_only --seeds 1 --jobs 1 --set time_limit_s=1.5").status, 1);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder() / "runs"), {}), 2);
  EXPECT_FALSE(std::filesystem::exists(folder() / "runs/turn_only-campaign")) << "that is the scenario's as it stands";
}

TEST_F(Commands, AnExpectedSafeFailureIsSuccessAndEndsWithoutPower) {
  const Json result = json_of("run drive_fault --no-outside --out r --set 'faults=[{at_s: 3, kind: overcurrent, node: elbow}]'");
  EXPECT_EQ(result["success"], true) << result.dump(2);
  EXPECT_NE(std::string(result["expected_failure"]["reason"]).find("drive fault: elbow"), std::string::npos);
  EXPECT_FALSE(result.contains("faults_not_made"));
  const Json other = json_of(
      "run drive_fault --no-outside --out s --set 'faults=[{at_s: 3, kind: estop}, {at_s: 300, kind: image_lost}, "
      "{at_step: press, kind: hot, node: jaw}]'",
      1);
  EXPECT_EQ(other["faults_not_made"], Json::parse(R"(["image_lost, at 300 s", "hot jaw, at step press"])"));
  EXPECT_NE(std::string(other["failure"]["reason"]).find("expected was 'drive fault'"), std::string::npos);
}

// A step of the mission is not a stage of the report: the step `turn` is a part of the stage `turn_valve`.
TEST_F(Commands, AFaultThatEndedTheMissionHappened) {
  const Json result = json_of(
      "run turn_only --no-outside --out r --set expect.failure='emergency stop' "
      "--set 'faults=[{at_step: turn, after_s: 0.5, kind: estop}, {at_step: home, kind: image_lost}, {at_step: press, kind: estop}]'");
  EXPECT_EQ(result["success"], true) << result.dump(2);
  EXPECT_EQ(result["faults_not_made"], Json::parse(R"(["estop, at step press"])"));
}

// The mission did its tasks and says so: the scenario was wrong, and the mission claimed nothing that is not so.
TEST_F(Commands, AnExpectedFailureThatDoesNotComeIsNoFalseSuccess) {
  const Json result = json_of("run turn_only --no-outside --out r --set expect.failure=aborted", 1);
  EXPECT_EQ(result["success"], false);
  EXPECT_EQ(result["false_success"], false) << result.dump(2);
  EXPECT_NE(result["failure"].dump().find("expected was the failure 'aborted'"), std::string::npos);
}

// A share of the whole matrix, which `lanternfish campaign default --faults` flies.
TEST_F(Commands, AShareOfTheFaultMatrixIsSafe) {
  const Said said = run("campaign default --faults --one-in 150 --out m --json");
  const Json table = Json::parse(said.out);
  EXPECT_GT(int(table["rows"]), 20);
  EXPECT_EQ(table["unsafe"], 0) << table["bad"].dump(2);
  EXPECT_EQ(table["false_successes"], 0);
  EXPECT_EQ(table["unclear"], 0) << table["bad"].dump(2);
  EXPECT_EQ(table["went_on"], table["must_go_on"]);
  EXPECT_TRUE(std::filesystem::exists(folder() / "m" / "faults.csv"));
}

// Some of every phase: the boot, too.
TEST_F(Commands, AShareOfThePairsOfFaultsIsSafe) {
  const Json table = Json::parse(run("campaign default --faults --pairs --one-in 450 --out m --json").out);
  EXPECT_GT(int(table["rows"]), 13);
  EXPECT_EQ(table["unsafe"], 0) << table["bad"].dump(2);
  EXPECT_EQ(table["false_successes"], 0);
  EXPECT_EQ(table["unclear"], 0) << table["bad"].dump(2);
}

// Where the core has a fault for what happened, a row shows it, or there is a reason why none can.
TEST_F(Commands, EachFaultOfTheCoreIsReportedInARow) {
  const std::map<std::string, std::string> shown{
      {"limits refused", "power-on: limits_refused"},
      {"boot failed", "boot: drop_frames heartbeat slew"},
      {"emergency stop", "deploy: estop"},
      {"node lost", "deploy: drop_frames heartbeat shoulder"},
      {"node rebooted", "deploy: reboot shoulder"},
      {"drive fault", "deploy: overcurrent elbow"},
      {"following error", "power-on: following shoulder"},
      {"stale position", "deploy: silent shoulder"},
      {"joint limit", "boot: encoder_jump elbow"},
      {"overspeed", "power-on: runaway slew"},
      {"overload", "jog: torque_high jaw"},
      {"unexpected contact", "deploy: torque_high slew"},
      {"output node lost", "deploy: silent io"},
      {"laser interlock open", "second scan: interlock_open"},
      {"image lost", "second scan: image_lost"},
      {"camera silent", "second scan: camera_silent"},
      {"panel vision late", "verify: vision_silent"},
      {"panel vision unsure", "verify: vision_poor"},
      {"grip lost", "turn: handle_breaks"},
      {"step failed", "leave button: torque_frozen shoulder"},
      {"aborted", "deploy: abort_ordered"},
      {"platform call failed", "deploy: can_receive_fails"},
      {"CAN bus off", "deploy: bus_off master"},
      {"another master on the bus", "deploy: foreign_sync"},
      {"clock lost", "deploy: clock_lost"},
  };
  const std::map<std::string, std::string> not_shown{
      {"tool outside its workspace", "what moves the tool there breaks a joint's speed or limit first: tests/unit/safety/watch_test.cpp"},
      {"step timed out", "each step waits for what has a shorter time-out of its own: tests/unit/mission/fault_sources_test.cpp"},
  };
  std::string rows;
  for (const auto& [fault, row] : shown) rows += (rows.empty() ? "" : ";") + row;
  ASSERT_EQ(run("campaign default --faults --rows '" + rows + "' --out m --json").status, 0);
  std::map<std::string, Json> flown;
  std::istringstream lines(text_of(folder() / "m" / "rows.jsonl"));
  for (std::string line; std::getline(lines, line);) flown[Json::parse(line)["row"]] = Json::parse(line)["reported"];
  for (std::size_t i = 0; i < safety::fault_count; ++i) {
    const std::string fault = safety::name(static_cast<safety::Fault>(i));
    if (not_shown.contains(fault)) continue;
    ASSERT_TRUE(shown.contains(fault)) << fault;
    const Json& reported = flown[shown.at(fault)];
    EXPECT_NE(std::find(reported.begin(), reported.end(), fault), reported.end()) << shown.at(fault) << ": " << reported.dump();
  }
}

// EPOS4 keeps its power through NMT reset communication, and hears no reset while it boots for another master's.
TEST_F(Commands, ADriveThatKeepsItsPowerThroughAnotherMastersResetsLosesIt) {
  const Said said =
      run("campaign default --faults --kinds foreign_reset --set drives.profile=epos4 --steps 'deploy;grip;press' --out m --json");
  EXPECT_EQ(said.status, 0) << said.out;
  EXPECT_EQ(Json::parse(said.out)["unsafe"], 0);
}

// It flew none of no rows, and that was a success.
TEST_F(Commands, AKeyThatThereIsNotIsRefusedByARangeCampaign) {
  const Said said = run("campaign default --ranges --draws 1 --many 0 --kinds valve.friction --out m");
  EXPECT_EQ(said.status, 2);
  EXPECT_NE(said.err.find("--kinds: there is no 'valve.friction'; did you mean 'valve.friction_nm'?"), std::string::npos) << said.err;
}

// Missions were flown for the steps' times first, a blank after the semicolon was a part of the name, and a folder was left.
TEST_F(Commands, ARowThatThereIsNotIsRefusedBeforeAnythingIsFlown) {
  const auto refusal = [&](const std::string& arguments) {
    const Said said = run("campaign " + arguments + " --out early");
    EXPECT_EQ(said.status, 2) << said.err;
    EXPECT_FALSE(std::filesystem::exists(folder() / "early"));
    return said.err;
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal("default --faults --rows 'deploy: estpo'"), HasSubstr("there is no 'deploy: estpo'; did you mean 'deploy: estop'?"));
  EXPECT_THAT(refusal("default --faults --rows 'tunr: estop'"), HasSubstr("did you mean 'turn: estop'?"));
  EXPECT_THAT(refusal("default --faults --pairs --rows 'boot: estop'"), HasSubstr("with --pairs a row is a pair"));
  EXPECT_THAT(refusal("default --faults --steps boot --rows 'boot: estop'"), HasSubstr("--steps excludes --rows"));
}

TEST_F(Commands, AStepThatThisMissionDoesNotComeToIsNoMisspelling) {
  const Said said = run("campaign turn_only --faults --rows 'press: estop' --out m");
  EXPECT_EQ(said.status, 2);
  EXPECT_NE(said.err.find("no fault can be made in 'press': this scenario's mission does not come to it"), std::string::npos) << said.err;
}

// Only the steps that are chosen are measured: at the same time as in the whole campaign.
TEST_F(Commands, ARowByItselfIsMadeAtItsTimeOfTheWholeMatrix) {
  ASSERT_EQ(run("campaign default --faults --kinds abort_ordered --one-in 3 --out m --json").status, 0);
  const auto times = [&](const char* file) {
    std::map<std::string, double> at_s;
    std::istringstream lines(text_of(folder() / file / "rows.jsonl"));
    for (std::string line; std::getline(lines, line);) at_s[Json::parse(line)["row"]] = Json::parse(line)["at_s"];
    return at_s;
  };
  const std::map<std::string, double> whole = times("m");
  EXPECT_GT(whole.size(), 4u);
  const auto& [name, at_s] = *std::next(whole.begin(), 2);
  ASSERT_EQ(run("campaign default --faults --rows '" + name + "; power-on: abort_ordered' --out one").status, 0);
  EXPECT_EQ(times("one").at(name), at_s) << name;
}

TEST_F(Commands, AFaultCampaignGoesOnWhereItStopped) {
  const std::string arguments = "campaign default --faults --kinds estop --steps 'boot;deploy' --jobs 1 --out m --json";
  const Said first = run(arguments);
  EXPECT_EQ(Json::parse(first.out)["rows"], 2);
  EXPECT_NE(first.err.find("0 of 2 rows\n"), std::string::npos) << first.err;
  EXPECT_NE(text_of(folder() / "m" / "junit.xml")
                .find("<testsuite name=\"default faults\" tests=\"2\" failures=\"0\" errors=\"0\" skipped=\"0\""),
            std::string::npos);
  const Said again = run(arguments);
  EXPECT_NE(again.err.find("2 rows are kept, 0 are missing"), std::string::npos) << again.err;
  const Said misspelt = run("campaign default --faults --kinds estpo");
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_NE(misspelt.err.find("--kinds: there is no 'estpo'; did you mean 'estop'?"), std::string::npos) << misspelt.err;
  EXPECT_EQ(run("campaign default --faults --shard 3/2").status, 2);
}

// A mission was flown for its steps' times, and a folder made, before the words were looked at.
TEST_F(Commands, AKindOrStepThatThereIsNotIsRefusedBeforeAnythingIsFlown) {
  const Said kind = run("campaign default --faults --kinds overcurent --out early");
  EXPECT_EQ(kind.status, 2);
  EXPECT_NE(kind.err.find("--kinds: there is no 'overcurent'; did you mean 'overcurrent'?"), std::string::npos) << kind.err;
  EXPECT_EQ(run("campaign default --faults --steps depoly --out early").status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder() / "early"));
}

TEST_F(Commands, CtrlCEndsTheSurveyOfTheSteps) {
  const Said said = interrupt("campaign default --faults --kinds estop --jobs 1 --out m --json", "m/experiment.json", 0);
  EXPECT_EQ(said.status, 130) << said.err;
  EXPECT_EQ(Json::parse(said.out)["exit_status"], 130) << said.out;
  EXPECT_NE(said.err.find("no row was flown"), std::string::npos) << said.err;
}

// The run that was broken off was kept as one that failed, and never flown again.
TEST_F(Commands, CtrlCLeavesNoRowOfARangeCampaignUnflown) {
  const std::string arguments = "campaign default --ranges --draws 1 --many 0 --kinds drives.slew.node --jobs 1 --out m --json";
  const Said said = interrupt(arguments, "m/rows.jsonl", 10);
  EXPECT_EQ(said.status, 130) << said.err;
  EXPECT_EQ(Json::parse(said.out)["unnamed"], 0) << said.err;
  EXPECT_EQ(text_of(folder() / "m" / "rows.jsonl").find("interrupted"), std::string::npos);
  EXPECT_NE(text_of(folder() / "m" / "junit.xml").find("not flown: its run was interrupted"), std::string::npos);
  const Said again = run(arguments);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(Json::parse(again.out)["rows"], 3);
}

// A campaign whose copy was ended from outside said that it had passed.
TEST_F(Commands, ARangeCampaignWithARowThatWasNotFlownFails) {
  const std::string arguments = "campaign default --ranges --draws 1 --many 0 --kinds drives.slew.node --jobs 1 --out m --json";
  const Said said = interrupt(arguments, "m/rows.jsonl", 10, Whom::copies);
  EXPECT_EQ(said.status, 1) << said.err;
  EXPECT_EQ(Json::parse(said.out)["rows"], 2) << said.err;
  EXPECT_EQ(Json::parse(said.out)["not_flown"], 1) << said.err;
  const Said again = run(arguments);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(Json::parse(again.out)["rows"], 3);
}

TEST_F(Commands, CtrlCStopsACampaignAndItsRuns) {
  const Said said =
      interrupt("campaign turn_only --seeds 1-40 --jobs 2 --set time_limit_s=600 --out many", "many/1.writing/can0.log", 1000);
  EXPECT_EQ(said.status, 130) << said.err;
  EXPECT_FALSE(std::filesystem::exists(folder() / "many" / "40"));
  const Json result = Json::parse(text_of(folder() / "many" / "1" / "result.json"), nullptr, false);
  ASSERT_FALSE(result.is_discarded()) << "the run's record is lost";
  EXPECT_EQ(result["failure"]["reason"], "interrupted");
  const Json campaign = Json::parse(text_of(folder() / "many" / "campaign.json"));
  EXPECT_EQ(int(campaign["runs"]) + int(campaign["not_flown"]), 40);
  EXPECT_GE(int(campaign["not_flown"]), 38);
  EXPECT_NE(text_of(folder() / "many" / "campaign.html").find("The campaign was interrupted"), std::string::npos);
  EXPECT_NE(text_of(folder() / "many" / "junit.xml").find("not flown: the campaign was interrupted"), std::string::npos);
}

}  // namespace

}  // namespace lf::app
