// What one run leaves in its folder, and what it says.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <unistd.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class RunFolder : public Program {
 protected:
  Json result_of(const std::string& run_folder) const { return Json::parse(text_of(folder() / run_folder / "result.json")); }
  std::vector<Json> lines_of(const std::string& name) const {
    std::vector<Json> lines;
    std::istringstream text(text_of(folder() / name));
    for (std::string line; std::getline(text, line);) lines.push_back(Json::parse(line));
    return lines;
  }
};

TEST_F(RunFolder, SaysHowItCameAbout) {
  file("my.yaml", "time_limit_s: 400\n");
  EXPECT_EQ(run("run ./my.yaml --no-outside --seed 3 --set time_limit_s=2 --set 'description=a b' --out r").status, 1);
  const Json result = result_of("r");
  const Json& provenance = result["provenance"];
  EXPECT_THAT(provenance["date_utc"].get<std::string>(),
              MatchesRegex("20[0-9][0-9]-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-5][0-9]:[0-6][0-9]Z"));
  EXPECT_EQ(provenance["command"], "lanternfish run ./my.yaml --seed 3 --set time_limit_s=2 --set 'description=a b'");
  EXPECT_EQ(provenance["set"], Json::parse(R"(["time_limit_s=2", "description=a b"])"));
  EXPECT_EQ(provenance["scenario_file"], "./my.yaml");
  EXPECT_FALSE(result["version"].get<std::string>().empty());
  // The hash is that of the folder's own experiment.json, as any tool makes it.
  ASSERT_EQ(std::system(("cd '" + (folder() / "r").string() + "' && sha256sum experiment.json > ../sum").c_str()), 0);
  EXPECT_EQ(provenance["experiment"].get<std::string>(), text_of(folder() / "sum").substr(0, 64));
}

// The user's file and the arm that it names have changed since.
TEST_F(RunFolder, RunsAgainFromItsOwnResolvedScenario) {
  const std::string urdf = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  file("our.urdf", urdf);
  file("my.yaml", "time_limit_s: 4\narm: {urdf: our.urdf}\nvalve: {friction_nm: {min: 1, max: 1.7}}\n");
  EXPECT_EQ(run("run ./my.yaml --no-outside --seed 3 --set water.attenuation_per_m=0.37 --out first").status, 1);
  file("my.yaml", "time_limit_s: 3\n");
  std::filesystem::remove(folder() / "our.urdf");
  std::filesystem::rename(folder() / "first", folder() / "moved");
  const Said again = run("run ./moved/scenario.yaml --no-outside --seed 3 --out again");
  EXPECT_EQ(again.status, 1) << again.err;
  EXPECT_EQ(result_of("again")["digest"], result_of("moved")["digest"]);
  EXPECT_EQ(result_of("again")["provenance"]["experiment"], result_of("moved")["provenance"]["experiment"]);
  EXPECT_EQ(text_of(folder() / "again" / "our.urdf"), urdf);
  EXPECT_EQ(run("run ./moved/scenario.yaml --no-outside --seed 3 --set water.attenuation_per_m=0.38 --out other").status, 1);
  EXPECT_NE(result_of("other")["provenance"]["experiment"], result_of("moved")["provenance"]["experiment"]);
}

// A run knows its own files again, and its user's are left.
// A machine beside the scenario, or in a folder of its own: all that it names comes along, and the arm that flies again is the one that flew.
TEST_F(RunFolder, RunsAgainWithTheMachineThatFlew) {
  std::string urdf = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  const std::string tool = "xyz=\"0 0 0.1485\"";
  ASSERT_NE(urdf.find(tool), std::string::npos);
  urdf.replace(urdf.find(tool), tool.size(), "xyz=\"0 0 0.1545\"");
  const std::string limits = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/safety/limits.yaml");
  const std::string profile = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/drives/lanternfish.yaml");
  std::filesystem::create_directory(folder() / "robot");
  for (const std::string& place : {std::string(), std::string("robot/")}) {
    SCOPED_TRACE(place);
    file(place + "our.urdf", urdf);
    file(place + "ours.yaml", limits);
    file(place + "drive.yaml", profile);
    file(place + "robot.yaml", "version: 1\narm: {urdf: our.urdf}\nsafety: {limits: ours.yaml}\ndrives: {profile: drive.yaml}\n");
    file("mine.yaml", "time_limit_s: 4\nmachine: " + place + "robot.yaml\n");
    ASSERT_EQ(run("run ./mine.yaml --no-outside --seed 3 --out first").status, 1);
    for (const char* name : {"our.urdf", "ours.yaml", "drive.yaml", "robot.yaml"}) std::filesystem::remove(folder() / (place + name));
    std::filesystem::rename(folder() / "first", folder() / "moved");
    const Said again = run("run moved/scenario.yaml --no-outside --seed 3 --out second");
    EXPECT_EQ(again.status, 1) << again.err;
    EXPECT_EQ(result_of("second")["digest"], result_of("moved")["digest"]);
    for (const char* name : {"moved", "second"}) std::filesystem::remove_all(folder() / name);
  }
}

TEST_F(RunFolder, IsWrittenAgainUnlessItHoldsFilesOfItsUser) {
  file("our.urdf", text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf"));
  file("my.yaml", "time_limit_s: 2\narm: {urdf: our.urdf}\n");
  const std::string again = "run ./my.yaml --record-images --out r";
  EXPECT_EQ(run(again).status, 1);
  EXPECT_EQ(run(again).status, 1) << "the same files are written";
  file("r/notes.txt", "mine");
  const Said said = run(again);
  EXPECT_EQ(said.status, 2);
  EXPECT_THAT(said.err, HasSubstr("holds notes.txt, which no run writes"));
  EXPECT_EQ(text_of(folder() / "r" / "notes.txt"), "mine");
}

// What lies above the scenario's folder is found from the run's folder, too.
TEST_F(RunFolder, NamesFilesAboveTheScenarioByTheirWholePath) {
  std::filesystem::create_directory(folder() / "below");
  file("our.urdf", text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf"));
  file("below/my.yaml", "time_limit_s: 1\narm: {urdf: ../our.urdf}\n");
  EXPECT_EQ(run("run below/my.yaml --no-outside --out r").status, 1);
  const Said again = run("run r/scenario.yaml --no-outside --out again");
  EXPECT_EQ(again.status, 1) << again.err;
  EXPECT_EQ(result_of("again")["digest"], result_of("r")["digest"]);
}

TEST_F(RunFolder, HasALogOfStepsFaultsAndReactions) {
  const std::string fault = "--set 'faults=[{at_step: deploy, after_s: 0.1, kind: overcurrent, node: elbow}]'";
  EXPECT_EQ(run("run drive_fault --no-outside --out r " + fault).status, 0);
  const std::vector<Json> log = lines_of("r/log.jsonl");
  ASSERT_GT(log.size(), 10u);
  EXPECT_EQ(log.front()["kind"], "begin");
  EXPECT_EQ(log.front()["seed"], 1);
  EXPECT_EQ(log.back()["kind"], "end");
  EXPECT_EQ(log.back()["success"], true);
  double before_s = 0;
  std::map<std::string, int> kinds;
  for (const Json& line : log) {
    EXPECT_GE(double(line["t_s"]), before_s) << line;
    before_s = line["t_s"];
    ++kinds[line["kind"]];
  }
  EXPECT_EQ(kinds["order"], 1);
  EXPECT_GE(kinds["step"], 5);
  EXPECT_GE(kinds["emcy"], 1);
  EXPECT_GE(kinds["counted"], 1);
  const auto told = std::find_if(log.begin(), log.end(), [](const Json& line) { return line["kind"] == "fault"; });
  ASSERT_NE(told, log.end());
  EXPECT_EQ((*told)["fault"], "drive fault");
  EXPECT_EQ((*told)["step"], "deploy");
  EXPECT_THAT((*told)["text"].get<std::string>(), HasSubstr("drive fault: elbow"));
  EXPECT_EQ((*told)["reaction"], "quick stop");

  const Json result = result_of("r");
  const auto same =
      std::find_if(result["faults"].begin(), result["faults"].end(), [](const Json& row) { return row["fault"] == "drive fault"; });
  ASSERT_NE(same, result["faults"].end()) << result["faults"];
  EXPECT_EQ((*same)["t_s"], (*told)["t_s"]);
  EXPECT_EQ((*same)["text"], (*told)["text"]);
  EXPECT_THAT(text_of(folder() / "r" / "report.html"), HasSubstr("<h2>Faults and reactions</h2>"));
}

// Without a CAN interface nothing is served, and the folder is looked at before.
TEST_F(RunFolder, OfServedHardwareIsRefusedAsThatOfARun) {
  const std::string serve = "serve turn_only --can lf_none0 --out s";
  const Said said = run(serve);
  EXPECT_NE(said.status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder() / "s")) << "what was not served leaves nothing";
  EXPECT_FALSE(std::filesystem::exists(folder() / "s.writing"));

  std::filesystem::create_directory(folder() / "s.writing");
  const int other = ::open((folder() / "s.writing").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX | LOCK_NB), 0);
  EXPECT_THAT(run(serve).err, HasSubstr("another run is writing there"));
  ::close(other);

  std::filesystem::create_directory(folder() / "s");
  file("s/notes.txt", "mine");
  EXPECT_THAT(run(serve).err, HasSubstr("s: is not empty and has no experiment.json"));
  EXPECT_EQ(text_of(folder() / "s" / "notes.txt"), "mine");
}

// The page's charts are the record's own numbers: those of joints.csv and result.json.
TEST_F(RunFolder, HasAReportWithTheNumbersOfTheRecord) {
  EXPECT_EQ(run("run drive_fault --no-outside --out r").status, 0);
  const std::string page = text_of(folder() / "r" / "report.html");
  EXPECT_LT(page.size(), 5'000'000u);
  const std::string open = "<script type=\"application/json\" id=\"run\">";
  const std::size_t at = page.find(open);
  ASSERT_NE(at, page.npos);
  const std::size_t from = at + open.size();
  const Json shown = Json::parse(page.substr(from, page.find("</script>", from) - from));

  std::map<std::string, Json> charts;
  for (const Json& chart : shown["charts"]) charts[chart["title"]] = chart;
  for (const char* title : {"Joint positions, measured and asked", "Motor torques at the joints, measured", "Joint speeds, truth",
                            "Tool's place in the base frame, truth, and asked", "Tool's distance from where it is asked to be, truth",
                            "Valve's angle, truth", "Contact force, truth", "Each stripe of the sweeps", "Recall of each stripe, truth",
                            "Bus load, stuff bits included", "Core's tick, the longest of ten, CPU time on this host"})
    EXPECT_EQ(charts.count(title), 1u) << title;

  // joints.csv: t_s, then of each joint its angle, target and torque.
  std::istringstream csv(text_of(folder() / "r" / "joints.csv"));
  std::string line;
  std::getline(csv, line);
  const Json& positions = charts["Joint positions, measured and asked"]["series"];
  const Json& torques = charts["Motor torques at the joints, measured"]["series"];
  const Json& times = shown["times"][positions[0]["t"].get<std::size_t>()];
  std::size_t row = 0;
  for (; std::getline(csv, line); ++row) {
    ASSERT_LT(row, times.size());
    std::istringstream cells(line);
    const auto expect_next = [&](const Json& shown_value, double tolerance) {
      std::string cell;
      std::getline(cells, cell, ',');
      ASSERT_EQ(shown_value.is_null(), cell.empty()) << line;
      if (!cell.empty()) {
        ASSERT_NEAR(shown_value.get<double>(), std::stod(cell), tolerance);
      }
    };
    expect_next(times[row], 1e-6);
    for (std::size_t joint = 0; joint < 5; ++joint) {
      expect_next(positions[2 * joint]["v"][row], 1e-5);
      expect_next(positions[2 * joint + 1]["v"][row], 1e-5);
      expect_next(torques[joint]["v"][row], 1e-3);
    }
    // Before the drives have answered the core knows nothing of its joints; the first that it knows is how the arm is parked, with the shoulder at 0.6 rad.
    const Json& shoulder = positions[2]["v"];
    if (row == 0) {
      EXPECT_TRUE(shoulder[row].is_null()) << shoulder[row];
    } else if (shoulder[row - 1].is_null() && !shoulder[row].is_null()) {
      EXPECT_NEAR(shoulder[row].get<double>(), 0.6, 0.01);
      EXPECT_NEAR(positions[3]["v"][row].get<double>(), 0.6, 0.01);
    }
  }
  // Of shared/safety/limits.yaml.
  EXPECT_EQ(positions[0]["limits"], Json::parse("[-1.5508, 0.5288]"));
  EXPECT_EQ(torques[3]["limits"], Json::parse("[-6.5, 6.5]"));
  EXPECT_EQ(row, times.size());

  const Json result = result_of("r");
  ASSERT_EQ(shown["faults"].size(), result["faults"].size());
  for (std::size_t i = 0; i < shown["faults"].size(); ++i) {
    EXPECT_NEAR(double(shown["faults"][i]["t"]), double(result["faults"][i]["t_s"]), 1e-6);
    EXPECT_EQ(shown["faults"][i]["text"], result["faults"][i]["text"]);
  }
  // The 3D view's joints are where the drives say, within the gears' play and wind-up.
  ASSERT_EQ(shown["motion"]["coordinates"].size(), 9u);
  EXPECT_EQ(shown["motion"]["parts"].size(), 13u) << "the bodies of robot and panel, and the obstacle of a fault, which has no shape";
  for (std::size_t joint = 0; joint < 5; ++joint) {
    EXPECT_NEAR(shown["motion"]["coordinates"][joint]["v"].back().get<double>(), positions[2 * joint]["v"].back().get<double>(), 0.02);
  }
  // The largest force ever, sampled at 25 Hz, is no more than the record's peak.
  double largest_n = 0;
  for (const Json& force : charts["Contact force, truth"]["series"][0]["v"]) largest_n = std::max(largest_n, force.get<double>());
  EXPECT_LE(largest_n, double(result["contact"]["peak_force_n"]) + 1e-3);
}

// An error message's text may quote another fault's name; the fault itself is what is expected.
TEST_F(RunFolder, AnExpectedFaultIsTheFaultItselfNotAWordOfItsText) {
  const std::string follow = "run drive_fault --no-outside --set 'faults=[{at_step: deploy, after_s: 0.1, kind: hot, node: elbow}]' ";
  const Said right = run(follow + "--out right --set 'expect.failure=drive fault'");
  EXPECT_EQ(right.status, 0) << right.out;
  const Said wrong = run(follow + "--out wrong --set 'expect.failure=emergency stop'");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.out, HasSubstr("expected was 'emergency stop'"));
  const Said misspelt = run(follow + "--out no --set 'expect.failure=drive falt'");
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("did you mean 'drive fault'?"));
}

// Counted again from the log of all frames: 47 bits and the data without stuff bits, ISO 11898-1.
TEST_F(RunFolder, TellsItsBusLoadWithAndWithoutStuffBits) {
  const Said said = run("run turn_only --no-outside --set time_limit_s=6 --out r");
  EXPECT_FALSE(std::filesystem::exists(folder() / "r" / "raw")) << "pictures are kept on request only";
  const Json bus = result_of("r")["bus"];
  EXPECT_THAT(said.out, HasSubstr("without stuff bits"));
  EXPECT_THAT(said.out, HasSubstr("with worst-case stuffing"));
  double bits = 0, first_s = 0, last_s = 0;
  std::istringstream log(text_of(folder() / "r" / "can0.log"));
  for (std::string line; std::getline(log, line);) {
    const std::string frame = line.substr(line.rfind(' ') + 1);
    const std::string data = frame.substr(frame.find('#') + 1);
    bits += 47 + (data[0] == 'R' ? 0.0 : 4.0 * static_cast<double>(data.size()));
    last_s = std::stod(line.substr(1));
    if (first_s == 0) first_s = last_s;
  }
  EXPECT_NEAR(bus["load_unstuffed_percent"], 100 * bits / ((last_s - first_s) * 1e6), 0.05);
  EXPECT_LT(double(bus["load_unstuffed_percent"]), double(bus["load_percent"]));
  EXPECT_LT(double(bus["load_percent"]), double(bus["load_worst_case_percent"]));
}

Eigen::Isometry3d pose_of(const Json& rows) {
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) matrix(row, column) = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  }
  return Eigen::Isometry3d(matrix);
}

// A machine without mounting errors: told and true poses agree to what encoders and interpolation leave.
TEST_F(RunFolder, KeepsRawPairsThatPeaksWorksOn) {
  run("run turn_only --no-outside --record-images --set time_limit_s=14 --set mounting.camera_m=0 --set mounting.camera_deg=0 "
      "--set mounting.laser_m=0 --set mounting.laser_deg=0 --set mounting.joints_deg=0 --set water.attenuation_per_m=0.3 --out r");
  const std::vector<Json> lines = lines_of("r/raw/images.jsonl");
  ASSERT_GT(lines.size(), 60u);
  EXPECT_EQ(lines[0]["kind"], "calibration");
  EXPECT_EQ(lines[0]["camera"]["width"], 640);
  EXPECT_EQ(lines[0]["camera"]["fx"], 361.7);
  int pairs = 0;
  double most_shift_mm = 0;
  Json pair;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Json& line = lines[i];
    ASSERT_EQ(line["kind"], "image");
    EXPECT_EQ(line["exposure_us"], 2000);
    EXPECT_TRUE(std::filesystem::exists(folder() / "r" / line["file"].get<std::string>())) << line;
    const Eigen::Isometry3d off = pose_of(line["told"]["base_from_laser"]).inverse() * pose_of(line["true"]["base_from_laser"]);
    most_shift_mm = std::max(most_shift_mm, 1e3 * off.translation().norm());
    if (!line["laser"] || line["off"].is_null()) continue;
    pair = line;
    ++pairs;
  }
  EXPECT_GT(pairs, 40);
  EXPECT_LT(most_shift_mm, 0.5);
  const std::string on = "r/" + pair["file"].get<std::string>(), off = "r/" + pair["off"].get<std::string>();
  const std::string png = text_of(folder() / on);
  EXPECT_EQ(png.substr(12, 4), "IHDR");
  EXPECT_EQ(png[24], 8) << "bits";
  EXPECT_EQ(png[25], 0) << "grey";
  const Said said = run("peaks " + on + " --off " + off + " --json");
  EXPECT_EQ(said.status, 0) << said.err;
  EXPECT_GT(Json::parse(said.out)["peaks"].size(), 300u);
}

TEST_F(RunFolder, NamesWhyALookFailedOnTheConsoleInTheReportAndInTheResult) {
  const std::string once = "run turn_only --no-outside --set mission.tries=1 --set lamps.lit=true ";
  for (const auto& [set, cause] :
       {std::pair{"water.attenuation_per_m=5", "the water is too turbid"}, std::pair{"camera.exposure_us=10", "the pictures are dark"}}) {
    SCOPED_TRACE(set);
    const Said said = run(once + "--set " + set + " --out r" + std::string(set).substr(0, 5));
    EXPECT_EQ(said.status, 1);
    EXPECT_THAT(said.out, HasSubstr(cause));
    EXPECT_THAT(said.out, HasSubstr("the look saw: "));
    const std::string name = "r" + std::string(set).substr(0, 5);
    const Json failure = result_of(name)["failure"];
    EXPECT_THAT(failure["cause"].get<std::string>(), HasSubstr(cause));
    EXPECT_FALSE(failure["remedy"].get<std::string>().empty());
    EXPECT_THAT(text_of(folder() / name / "report.html"), HasSubstr(cause));
    EXPECT_THAT(text_of(folder() / name / "log.jsonl"), HasSubstr(cause));
  }
}

}  // namespace

}  // namespace lf::app
