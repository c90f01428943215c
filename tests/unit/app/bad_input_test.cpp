// What a user gets wrong: one clear line on stderr, the right exit status, no crash.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class BadInput : public Program {
 protected:
  void expect_refused(const std::string& arguments, const std::string& why, int status = 2, int lines = 1) const {
    SCOPED_TRACE(arguments);
    const Said said = run(arguments);
    EXPECT_EQ(said.status, status) << said.err;
    EXPECT_THAT(said.err, StartsWith("lanternfish: "));
    EXPECT_THAT(said.err, HasSubstr(why));
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), lines) << said.err;
    EXPECT_EQ(said.out, "");
  }
};

TEST_F(BadInput, UnknownCommandsAndOptions) {
  expect_refused("rnu", "no command 'rnu'; did you mean 'run'?");
  expect_refused("hydraulics", "no command 'hydraulics'");
  expect_refused("plane --no-such-option x.pcd", "--no-such-option");
  expect_refused("plane", "CLOUD is required");
  expect_refused("ik --x 0.3 --y 0", "--z is required");
  expect_refused("ik --x far --y 0 --z 0", "--x");
  expect_refused("ik --x 0,44 --y 0 --z 0.5", "'--x' takes a number, not '0,44': its decimals stand behind a point");
  expect_refused("markers x.png --decimate much", "--decimate: takes a number from 1 to 8, not much");
  expect_refused("ik --x nan --y 0 --z 0.5", "finite");
  expect_refused("run --seed -1", "--seed");
  expect_refused("run --render-threads 0", "--render-threads");
  for (const char* seed : {"-1", "1.5", "x", "1e3", "18446744073709551616", "99999999999999999999999"})
    expect_refused(std::string("run --seed=") + seed,
                   "--seed: takes a whole number from 0 to 18446744073709551615, not " + std::string(seed));
  expect_refused("render-frames default f --seed=-1", "--seed: takes");
  for (const char* option : {"markers x.png --size-m", "plane x.pcd --threshold-mm", "ik --x 0.3 --y 0 --z 0.5 --margin"}) {
    for (const char* number : {"nan", "inf", "1e9", "-1", "three"})
      expect_refused(std::string(option) + "=" + number, std::string(": takes a number from "));
  }
  for (const char* number : {"0", "-1", "nan", "inf"})
    expect_refused(std::string("serve --can x --for=") + number, "--for: takes a number above 0");
}

// A script that asked for JSON reads why from stdout, as a person does from stderr.
TEST_F(BadInput, AreADocumentWhereJsonWasAskedFor) {
  file("bad.yaml", "valve: {fricton_nm: 2}\nwater: {attenuation_per_m: 9}\n");
  const Said two = run("run ./bad.yaml --json");
  EXPECT_EQ(two.status, 2);
  const auto document = nlohmann::json::parse(two.out);
  EXPECT_EQ(document["exit_status"], 2);
  ASSERT_EQ(document["problems"].size(), 2u);
  EXPECT_THAT(document["problems"][1].get<std::string>(), StartsWith("./bad.yaml:2: 'water.attenuation_per_m' is 9"));
  EXPECT_EQ(nlohmann::json::parse(run("run defualt --json").out)["problems"].size(), 1u);
  EXPECT_EQ(nlohmann::json::parse(run("run --sed 3 --json").out)["exit_status"], 2);
}

TEST_F(BadInput, ScenariosThatAreNotWhatTheyShouldBe) {
  file("misspelt.yaml", "valve:\n  fricton_nm: 2\n");
  expect_refused("run ./misspelt.yaml", "./misspelt.yaml:2: unknown key 'valve.fricton_nm'; did you mean 'valve.friction_nm'?");
  expect_refused("run defualt", "no scenario 'defualt'; did you mean 'default'?");
  expect_refused("run ./missing.yaml", "./missing.yaml: No such file");
  expect_refused("run --set valve.start_deg=left", "'valve.start_deg' takes a number");
  expect_refused("run --set water.attenuation_per_m=9", "out of its range 0 to 5");
  expect_refused("run --set camera.noise_grey=.nan", "must be a finite number");
  expect_refused("run --set valve=3", "'valve' is a group of keys: name one of them, as valve.");
  expect_refused("run --set valve.start_deg.x=3", "unknown key 'valve.start_deg.x'");
  for (const char* text : {"''", "foo", "=3", "valve.start_deg"}) expect_refused(std::string("run --set ") + text, "path.to.key=value");
  expect_refused("run --set valve.start_deg=", "takes a number");
  std::filesystem::create_directory(folder() / "a_folder");
  expect_refused("run ./a_folder", "./a_folder: is a folder");
  file("unended.yaml", "valve:\n  start_deg: [1, 2\n");
  expect_refused("run ./unended.yaml", "./unended.yaml:3: not YAML");
  expect_refused("campaign ./misspelt.yaml --seeds 1-2", "./misspelt.yaml:2");
  expect_refused("reach ./misspelt.yaml", "./misspelt.yaml:2");
  expect_refused("scenarios ./misspelt.yaml", "./misspelt.yaml:2");
}

TEST_F(BadInput, JobsThatTheMachineCannotDo) {
  expect_refused("run --set panel.ahead_m=0.69 --set \"camera.position_m=[0.2, -0.245, 0.06]\"", "out of the arm's reach", 2, 4);
  expect_refused("run --set panel.ahead_m=0.69", "'panel.ahead_m' is 0.69", 2, 4);
  expect_refused("run --set camera.down_deg=10", "out of the camera's view", 2, 4);
  expect_refused("run --set camera.down_deg=10", "see 'camera.position_m', 'camera.down_deg'", 2, 4);
  expect_refused("run --set arm.urdf=missing.urdf", "missing.urdf");
  file("jointless.urdf", "<robot name=\"none\">\n</robot>\n");
  expect_refused("run --set arm.urdf=" + (folder() / "jointless.urdf").string(), "jointless.urdf");
}

// Whoever checks a file hears what a run of it would say, word for word, all of it.
TEST_F(BadInput, AScenarioIsCheckedAsItsRunIs) {
  file("elsewhere.yaml", "camera: {down_deg: 10}\ndrives: {jaw: {node: 3}}\n");
  file("blocked.yaml", "vehicle: {boxes_m: [[0, 0, 0.3, 0.2, 0.2, 0.2]]}\n");
  file("drive.yaml", "title: a drive of ours\n");
  file("unsimulated.yaml", "drives: {profile: drive.yaml}\n");
  for (const char* scenario : {"elsewhere.yaml", "blocked.yaml", "unsimulated.yaml"}) {
    SCOPED_TRACE(scenario);
    const Said ran = run(std::string("run ./") + scenario), checked = run(std::string("scenarios ./") + scenario);
    EXPECT_EQ(ran.status, 2) << ran.err;
    EXPECT_EQ(checked.status, 2);
    EXPECT_EQ(checked.err, ran.err);
    EXPECT_EQ(checked.out, "");
  }
  const Said all = run("scenarios ./elsewhere.yaml");
  EXPECT_THAT(all.err, HasSubstr("out of the camera's view"));
  EXPECT_THAT(all.err, HasSubstr("node"));
}

TEST_F(BadInput, AnArmWithoutFrictionIsToldOnceAtTheStart) {
  std::string urdf = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  const std::size_t joint = urdf.find("<joint name=\"elbow\""), from = urdf.find("<lanternfish:friction", joint);
  ASSERT_NE(from, std::string::npos);
  urdf.erase(from, urdf.find("/>", from) + 2 - from);
  const std::string arm = "--set arm.urdf=" + file("bare.urdf", urdf);
  const Said bare = run("run --no-outside --set time_limit_s=1 --out bare " + arm);
  const std::string note = "bare.urdf: no <lanternfish:friction> for elbow: ";
  const std::size_t at = bare.err.find(note);
  EXPECT_NE(at, std::string::npos) << bare.err;
  EXPECT_EQ(bare.err.find(note, at + 1), std::string::npos) << bare.err;
  EXPECT_EQ(run("run --no-outside --set time_limit_s=1 --out usual").err.find("note:"), std::string::npos);
}

TEST_F(BadInput, AnArmOfAnotherFormIsRefusedWithItsLine) {
  std::string urdf = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  const std::string fingers = "<origin xyz=\"0.04 0 0.045\"";
  ASSERT_NE(urdf.find(fingers), std::string::npos);
  const std::string arm =
      " --set arm.urdf=" + file("other.urdf", urdf.replace(urdf.find(fingers), fingers.size(), "<origin xyz=\"0.05 0 0.045\""));
  for (const char* command : {"run default", "campaign default --seeds 1", "serve default --can no_such_can", "reach default"}) {
    const Said said = run(command + arm);
    EXPECT_EQ(said.status, 2) << command;
    EXPECT_THAT(said.err, ::testing::ContainsRegex("other.urdf:[0-9]+: joint 'finger_b' must be the mirror image of 'jaw'")) << command;
  }
}

TEST_F(BadInput, ABadUrdfIsRefusedWithItsLine) {
  std::string urdf = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  const std::size_t at = urdf.find("upper=\"0.5488\"");
  ASSERT_NE(at, std::string::npos);
  file("impossible.urdf", urdf.replace(at, 14, "upper=\"-9.000\""));
  const Said said = run("run --set arm.urdf=" + (folder() / "impossible.urdf").string());
  EXPECT_EQ(said.status, 2);
  EXPECT_THAT(said.err, ::testing::ContainsRegex("impossible.urdf:[0-9]+: "));
}

TEST_F(BadInput, SeedsOfACampaign) {
  for (const char* seeds : {"x", "3-1", "1-", "-3", "1-2-3", "1-99999999"})
    expect_refused(std::string("campaign default --seeds=") + seeds, "--seeds");
}

TEST_F(BadInput, ImagesThatAreNone) {
  file("text.png", "no image");
  file("empty.png", "");
  for (const char* command : {"peaks", "markers"}) {
    expect_refused(std::string(command) + " missing.png", "missing.png");
    expect_refused(std::string(command) + " text.png", "text.png");
    expect_refused(std::string(command) + " empty.png", "empty.png");
  }
}

// libpng's own words never reach the user.
TEST_F(BadInput, ImagesThatAreDamaged) {
  const std::string png = text_of(LANTERNFISH_SOURCE_DIR "/tests/data/marker_still/seed_146.png");
  ASSERT_GT(png.size(), 1000u);
  const auto with_byte = [&png](std::size_t at, char change) {
    std::string changed = png;
    changed[at] = static_cast<char>(changed[at] ^ change);
    return changed;
  };
  file("header.png", with_byte(20, 1));
  file("pixels.png", with_byte(png.size() / 2, 0x55));
  file("cut.png", png.substr(0, png.size() - 30));
  file("signature.png", png.substr(0, 8));
  std::filesystem::create_directory(folder() / "a_folder");
  for (const char* command : {"peaks", "markers"}) {
    expect_refused(std::string(command) + " header.png", "header.png: the image is damaged");
    expect_refused(std::string(command) + " pixels.png", "pixels.png: the image is damaged");
    expect_refused(std::string(command) + " cut.png", "cut.png: the image is truncated");
    expect_refused(std::string(command) + " signature.png", "signature.png: the image is truncated");
    expect_refused(std::string(command) + " a_folder", "a_folder: is a folder");
  }
}

TEST_F(BadInput, CloudsThatAreNone) {
  file("cut.pcd",
       "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 5\nHEIGHT 1\nPOINTS 5\nDATA ascii\n0 0 0\n1 0 "
       "0\n");
  file("words.csv", "x,y,z\n1,2,three\n");
  file("cloud.txt", "1 2 3\n");
  expect_refused("plane missing.pcd", "missing.pcd");
  expect_refused("plane cut.pcd", "cut.pcd");
  expect_refused("plane words.csv", "words.csv:2");
  expect_refused("plane cloud.txt", "cloud.txt");
}

TEST_F(BadInput, CalibrationsThatAreNone) {
  file("camera.yaml", "camera_matrix: {rows: 3, cols: 3, data: [1, 2]}\n");
  expect_refused("markers x.png --camera camera.yaml --size-m 0.1", "camera.yaml");
  expect_refused("markers x.png --camera camera.yaml", "--camera needs --size-m");
  expect_refused("markers x.png --family 99h9", "99h9");
  expect_refused("markers x.png --channel infrared", "infrared");
}

TEST_F(BadInput, CampaignsThatWouldTestNothing) {
  expect_refused("campaign default --faults --into nan --out m", "--into takes a share");
  expect_refused("campaign default --faults --into 1.5 --out m", "1.5");
  expect_refused("campaign default --faults --pairs --steps grip --out m", "no row of the matrix");
  expect_refused("campaign default --seeds 1-4 --shard 2/2 --out m", "--shard and --kinds go with");
}

TEST_F(BadInput, FoldersThatCannotBeWritten) {
  file("in_the_way", "");
  expect_refused("run --out in_the_way/run", "in_the_way");
  expect_refused("campaign default --seeds 1-2 --out in_the_way/c", "in_the_way");
  expect_refused("reach --draws 1 --out in_the_way/reach.png", "in_the_way/reach.png: cannot be written: Not a directory");
  expect_refused("reach --draws 1 --out nowhere/reach.png", "nowhere/reach.png: cannot be written: No such file");
  std::filesystem::create_directory(folder() / "a_folder");
  expect_refused("reach --draws 1 --out a_folder", "a_folder: is a folder, not a file");
}

TEST_F(BadInput, APictureOfAnotherKindThanItsNameSays) {
  expect_refused("peaks missing.png --overlay o.jpg", "--overlay: takes the name of a .png, not o.jpg");
  expect_refused("markers missing.png --overlay o.jpg", "--overlay: takes the name of a .png, not o.jpg");
}

TEST_F(BadInput, AFolderThatCannotBeMadeSaysWhichOptionNamesAnother) {
  file("runs", "");
  expect_refused("run default", "--out names another");
}

TEST_F(BadInput, AShareFolderWithoutScenarios) {
  const Said said = run("scenarios", "LANTERNFISH_SHARE=/");
  EXPECT_EQ(said.status, 2);
  EXPECT_THAT(said.err, HasSubstr("LANTERNFISH_SHARE names this folder"));
  EXPECT_EQ(run("doctor", "LANTERNFISH_SHARE=/").status, 3);
}

TEST_F(BadInput, AFullDiskBehindTheOutputIsNoCrash) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  for (const std::string arguments : {"scenarios default", "--help", "run --help", "--version"}) {
    const std::string command = "cd '" + folder().string() + "' && " LANTERNFISH_PROGRAM " " + arguments + " >/dev/full 2>.stderr";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 3) << arguments;
    EXPECT_THAT(text_of(folder() / ".stderr"), HasSubstr("No space left on device")) << arguments;
  }
}

// In a file system of its own, which a user namespace may mount without being root.
TEST_F(BadInput, ADiskThatFillsUpDuringARunLeavesWhatWasWritten) {
  std::filesystem::create_directory(folder() / "disk");
  const std::string in_namespace = "unshare --user --map-root-user --mount sh -c ";
  const std::string mount = "mount -t tmpfs -o size=128k none '" + (folder() / "disk").string() + "'";
  if (std::system((in_namespace + "\"" + mount + "\" 2>/dev/null").c_str()) != 0) GTEST_SKIP() << "no file system can be mounted here";
  const std::string run = LANTERNFISH_PROGRAM " run --quiet --set time_limit_s=2 --no-outside --out disk/run >out 2>err; echo \\$? >status";
  const std::string command =
      "cd '" + folder().string() + "' && " + in_namespace + "\"" + mount + " && { " + run + "; cp -r disk/run kept; }\"";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(text_of(folder() / "status"), "3\n");
  const std::string said = text_of(folder() / "err");
  EXPECT_THAT(said, StartsWith("lanternfish: disk/run"));
  EXPECT_THAT(said, HasSubstr("No space left on device; what was recorded before is kept"));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  const std::string out = text_of(folder() / "out");
  EXPECT_THAT(out, HasSubstr("FAILED in record: "));
  EXPECT_THAT(out, ::testing::Not(HasSubstr("SUCCESS")));
  EXPECT_THAT(out, ::testing::Not(HasSubstr("report:")));
  const std::string log = text_of(folder() / "kept" / "can0.log");
  EXPECT_GT(log.size(), 50'000u);
  EXPECT_THAT(log, ::testing::MatchesRegex("\\([0-9.]+\\) can0 .*"));
  for (const auto& entry : std::filesystem::directory_iterator(folder() / "kept")) {
    EXPECT_NE(entry.path().extension(), ".partial") << entry.path();
  }
}

TEST_F(BadInput, ADiskThatFillsUpEndsACampaignWithItsCauseAndWithoutATable) {
  std::filesystem::create_directory(folder() / "disk");
  const std::string in_namespace = "unshare --user --map-root-user --mount sh -c ";
  const std::string mount = "mount -t tmpfs -o size=96k none '" + (folder() / "disk").string() + "'";
  if (std::system((in_namespace + "\"" + mount + "\" 2>/dev/null").c_str()) != 0) GTEST_SKIP() << "no file system can be mounted here";
  const std::string run =
      LANTERNFISH_PROGRAM " campaign default --seeds 1-3 --jobs 1 --set time_limit_s=2 --out disk/c >out 2>err; echo \\$? >status";
  ASSERT_EQ(std::system(("cd '" + folder().string() + "' && " + in_namespace + "\"" + mount + " && { " + run + "; }\"").c_str()), 0);
  EXPECT_EQ(text_of(folder() / "status"), "3\n");
  EXPECT_THAT(text_of(folder() / "err"), HasSubstr("No space left on device"));
  EXPECT_THAT(text_of(folder() / "out"), ::testing::Not(HasSubstr("nan")));
  EXPECT_THAT(text_of(folder() / "out"), ::testing::Not(HasSubstr("succeeded")));
}

TEST_F(BadInput, LimitsThatAreNotThoseOfTheirChecksumAreNamedWithTheRightOne) {
  std::filesystem::copy(LANTERNFISH_SOURCE_DIR "/shared", folder() / "share", std::filesystem::copy_options::recursive);
  const std::filesystem::path limits = folder() / "share" / "safety" / "limits.yaml";
  std::string text = text_of(limits);
  const std::size_t at = text.find("max_contact_torque_nm: 13");
  ASSERT_NE(at, std::string::npos);
  file("share/safety/limits.yaml", text.replace(at, 25, "max_contact_torque_nm: 12"));
  const std::string share = "LANTERNFISH_SHARE='" + (folder() / "share").string() + "'";
  const Said doctor = run("doctor", share);
  EXPECT_EQ(doctor.status, 3);
  EXPECT_THAT(doctor.out, ::testing::ContainsRegex("limits.yaml:[0-9]+: the checksum is 0x[0-9a-f]+, but these limits give 0x[0-9a-f]{8}"));
  const Said refused = run("run", share);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("but these limits give 0x"));
}

}  // namespace

}  // namespace lf::app
