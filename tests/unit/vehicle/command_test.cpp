// `lanternfishd` as a user runs it where nothing of a vehicle is: what explains it, what prints its configuration, and the doctor.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "hal/vehicle/vehicle_config.hpp"
#include "tests/unit/app/printed_files.hpp"
#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::string> commands{"status", "estop", "start",      "home",        "hold",   "resume", "abort",     "reset",
                                        "jog",    "task",  "commission", "restart-bus", "doctor", "help",   "completion"};

class Daemon : public Program {
 protected:
  // What this machine lacks of it is known: an interface, a camera, a lock folder.
  std::string config(const std::string& more = "") const {
    return file("vehicle.yaml", "can: {interface: can99}\ncamera: {device: /dev/video77}\nlog: {folder: " + folder().string() +
                                    "/log, file_mb: 1, keep: 1}\noperator: {socket: " + folder().string() +
                                    "/s}\nlock_folder: " + folder().string() + "\n" + more);
  }
};

TEST_F(Daemon, ManualPagesAreWhatTheProgramPrints) {
  expect_in_repository("docs/man/lanternfishd.8", run("help --man 8").out);
  expect_in_repository("docs/man/lanternfish-vehicle.5", run("help --man 5").out);
}

TEST_F(Daemon, TheManualHasEveryCommandAndOption) {
  const std::string page = run("help --man 8").out;
  for (const std::string& option : options_in(run("--help").out)) EXPECT_THAT(page, HasSubstr("\n.B " + in_roff(option)));
  for (const std::string& command : commands) {
    const std::string part = part_of(page, ".SS " + in_roff(command));
    EXPECT_NE(part, "") << command;
    for (const std::string& option : options_in(run(command + " --help").out)) {
      if (option == "--help") continue;
      EXPECT_THAT(part, HasSubstr("\n.B " + in_roff(option))) << command;
    }
    EXPECT_EQ(run("help " + command).out, run(command + " --help").out) << command;
  }
}

TEST_F(Daemon, TheVehiclesPageHasEveryKeyOfTheUsersTable) {
  const std::string page = run("help --man 5").out;
  std::istringstream table(text_of(LANTERNFISH_SOURCE_DIR "/docs/operating.md"));
  int keys = 0;
  for (std::string row; std::getline(table, row) && row != "<!-- keys: drawn from the code -->";) {
  }
  for (std::string row; std::getline(table, row);) {
    if (!row.starts_with("| `")) continue;
    const std::string key = row.substr(3, row.find('`', 3) - 3);
    const std::size_t at = row.find(" | `", 3) + 4;
    const std::string usual = row.substr(at, row.find("` |", at) - at);
    const std::size_t place = page.find("\n.B " + key + "\n");
    ASSERT_NE(place, std::string::npos) << key;
    EXPECT_THAT(page.substr(place, page.find("\n.TP", place) - place), HasSubstr("Default: " + in_roff(usual))) << key;
    ++keys;
  }
  EXPECT_GT(keys, 90);
}

TEST_F(Daemon, CompletionIsWhatThePackageHas) {
  expect_in_repository("toolchain/completion/lanternfishd.bash", run("completion bash").out);
  expect_in_repository("toolchain/completion/_lanternfishd", run("completion zsh").out);
}

// An order takes the program's options behind it.
TEST_F(Daemon, CompletionOffersTheProgramsOptionsBehindAnOrder) {
  const std::string bash = run("completion bash").out, zsh = run("completion zsh").out;
  const std::string order = bash.substr(bash.find("'status')"), 600);
  EXPECT_THAT(order.substr(0, order.find(";;\n    'estop')")), ::testing::AllOf(HasSubstr("--json"), HasSubstr("--socket) compopt")));
  EXPECT_THAT(zsh.substr(zsh.find("        status)"), 900), HasSubstr("'--json[Answer in JSON]'"));
}

// Regenerate with: lanternfishd --print-schema > shared/vehicle/vehicle.schema.json
TEST_F(Daemon, TheShippedSchemaIsThatOfTheKeys) {
  const std::string schema = run("--print-schema").out;
  expect_in_repository("shared/vehicle/vehicle.schema.json", schema);
  const Json document = Json::parse(schema);
  EXPECT_EQ(document["additionalProperties"], false);
  EXPECT_EQ(document["properties"]["drives"]["properties"]["elbow"]["properties"]["polarity"]["enum"], Json({"forward", "reversed"}));
  EXPECT_EQ(document["properties"]["realtime"]["properties"]["priority"]["maximum"], 98);
}

TEST_F(Daemon, PrintsEveryKeyWithItsRangeAndDefault) {
  const Said said = run("--print-config");
  EXPECT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("\nrealtime:\n  priority: 80 "));
  EXPECT_THAT(said.out, HasSubstr("; 0 to 98\n"));
  EXPECT_THAT(said.out, HasSubstr("\n  elbow:\n    node: 0 ")) << "groups within groups";
  const hal::VehicleConfig read = hal::load_vehicle_config(file("printed.yaml", said.out));
  EXPECT_EQ(read.interface, hal::VehicleConfig().interface);
  EXPECT_EQ(run("--print-config --config printed.yaml").out, said.out) << "read back, it is the same";
}

TEST_F(Daemon, PrintsAFilesValuesBesideTheDefaults) {
  config("realtime: {priority: 50}\ndrives: {jaw: {node: 9}}\nhoming: {file: /nowhere/homing.yaml}\n");
  const Said said = run("--config vehicle.yaml --print-config");
  EXPECT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.out, ::testing::ContainsRegex("  priority: 50 +# [^\n]*; 0 to 98; default 80\n"));
  EXPECT_THAT(said.out, ::testing::ContainsRegex("  interface: \"can99\" +# [^\n]*; default \"can0\"\n"));
  EXPECT_THAT(said.out, HasSubstr("file: \"/nowhere/homing.yaml\"")) << "as it is written, whether or not it is there";
  file("bad.yaml", "realtime: {priorty: 5}\n");
  const Said bad = run("--config bad.yaml --print-config");
  EXPECT_EQ(bad.status, 2);
  EXPECT_EQ(bad.out, "");
  EXPECT_THAT(bad.err, HasSubstr("bad.yaml:1: unknown key 'realtime.priorty'; did you mean 'realtime.priority'?"));
}

TEST_F(Daemon, AMisspeltOptionOrOrderIsAnsweredWithTheNearest) {
  EXPECT_THAT(run("--confg x.yaml").err, HasSubstr("lanternfishd has no option '--confg'; did you mean '--config'?"));
  EXPECT_THAT(run("task --trun 45").err, HasSubstr("lanternfishd task has no option '--trun'; did you mean '--turn'?"));
  EXPECT_THAT(run("statsu").err, HasSubstr("did you mean 'status'?"));
  EXPECT_EQ(run("statsu").status, 2);
}

// "no option '--bus'; did you mean '--bus'?"
TEST_F(Daemon, AnOptionBeforeItsOrderIsAnsweredWithItsPlace) {
  EXPECT_EQ(run("--config v.yaml --bus doctor").err,
            "lanternfishd: '--bus' is an option of `lanternfishd doctor`: write it behind `doctor`\n");
}

TEST_F(Daemon, AFullDiskBehindTheOutputIsNoSuccess) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  for (const char* arguments : {"--help", "help", "doctor --help", "--version", "--print-config", "--print-schema"}) {
    const std::string command = "cd '" + folder().string() + "' && " LANTERNFISH_PROGRAM " " + arguments + " >/dev/full 2>.stderr";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 3) << arguments;
    EXPECT_EQ(text_of(folder() / ".stderr"), "lanternfishd: standard output: No space left on device\n") << arguments;
  }
}

// --check reported a document only where the file was sound.
TEST_F(Daemon, WhatIsRefusedIsADocumentWhereJsonWasAskedFor) {
  for (const char* arguments : {"--confg x --json", "--config missing.yaml --check --json", "--config missing.yaml doctor --json",
                                "doctor --json", "status --socket ./none --json"}) {
    const Said said = run(arguments);
    const Json document = Json::parse(said.out, nullptr, false);
    ASSERT_TRUE(document.is_object()) << arguments << ": " << said.out;
    EXPECT_FALSE(document["problems"].empty()) << arguments;
    EXPECT_NE(said.status, 0) << arguments;
  }
}

TEST_F(Daemon, TheDoctorNamesWhatTheMachineLacksWithItsRemedy) {
  const Said text = run("--config " + config() + " doctor");
  EXPECT_EQ(text.status, 3) << text.out << text.err;
  EXPECT_THAT(text.out, ::testing::ContainsRegex("interface +BAD +there is no interface can99\n +to do: `ip link` lists them"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("camera +BAD +/dev/video77: there is no camera"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("log +good +"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("drives +BAD +not read: "));
  const Said said = run("--config vehicle.yaml doctor --json");
  EXPECT_EQ(said.status, 3);
  const Json document = Json::parse(said.out);
  EXPECT_EQ(document["ok"], false);
  EXPECT_EQ(document["exit_status"], 3);
  EXPECT_TRUE(document["bus"].is_null());
  ASSERT_GT(document["findings"].size(), 10u);
  for (const Json& finding : document["findings"]) EXPECT_EQ(finding["remedy"].is_null(), finding["grade"] == "good") << finding.dump();
  EXPECT_EQ(document["findings"][1]["subject"], "interface");
  EXPECT_EQ(document["findings"][1]["key"], "can.interface");
  EXPECT_EQ(document["findings"][1]["grade"], "bad");
}

TEST_F(Daemon, TheDoctorLooksAtTheMachineEvenWhenTheFileIsWrong) {
  config("realtime: {priority: 500}\n");
  const Said said = run("--config vehicle.yaml doctor --machine --json");
  EXPECT_EQ(said.status, 2);
  const Json document = Json::parse(said.out);
  EXPECT_THAT(document["problems"].at(0).get<std::string>(), HasSubstr("'realtime.priority' is 500"));
  EXPECT_GT(document["findings"].size(), 10u);
}

// A daemon at work has read its file: what somebody has made of it since keeps no stop from it.
TEST_F(Daemon, AStopGoesOutWhateverIsWrongWithTheFile) {
  config("realtime: {priority: 500}\n");
  const Said stop = run("--config vehicle.yaml estop");
  EXPECT_THAT(stop.err, HasSubstr("'realtime.priority' is 500"));
  EXPECT_THAT(stop.err, HasSubstr("/s: no lanternfishd answers there"));
  EXPECT_THAT(run("--config vehicle.yaml home").err, Not(HasSubstr("no lanternfishd answers")))
      << "anything else waits for a file that is right";
}

// In the middle of an edit it may be no YAML at all, or be gone. Whose daemon answers at the usual place nobody knows then.
TEST_F(Daemon, AStopOfAFileThatTellsNoSocketGoesToTheUsualOneAndSaysSo) {
  for (const char* text : {"can: {interface: can0\n\tcamera", "operator: {soket: /x}\n", ""}) {
    if (*text != '\0')
      std::ofstream(folder() / "broken.yaml") << text;
    else
      std::filesystem::remove(folder() / "broken.yaml");
    const Said stop = run("--config broken.yaml estop");
    EXPECT_THAT(stop.err, HasSubstr("the stop goes to /run/lanternfishd/operator.sock. Look whether that is this arm's")) << text;
    EXPECT_THAT(stop.err, HasSubstr("/run/lanternfishd/operator.sock: no lanternfishd answers there")) << text;
    EXPECT_NE(stop.status, 0);
  }
}

// The environment's may be another arm's, and the usual one this arm's.
TEST_F(Daemon, AStopOfAFileThatTellsNoSocketGoesToAllThatItMayBe) {
  std::ofstream(folder() / "broken.yaml") << "camera: {foo: 1}\n";
  setenv("LANTERNFISHD_SOCKET", "/tmp/of_another_arm", 1);
  const Said stop = run("--config broken.yaml estop");
  unsetenv("LANTERNFISHD_SOCKET");
  EXPECT_THAT(stop.err,
              HasSubstr("goes to /run/lanternfishd/operator.sock and /tmp/of_another_arm. Look whether this arm's is among them"));
  EXPECT_THAT(stop.err, HasSubstr("/tmp/of_another_arm: no lanternfishd answers there"));
  EXPECT_THAT(stop.err, HasSubstr("/run/lanternfishd/operator.sock: no lanternfishd answers there"));
  EXPECT_NE(stop.status, 0);
}

TEST_F(Daemon, TheDoctorsPartsAreChosen) {
  const Said machine = run("--config " + config() + " doctor --machine");
  EXPECT_THAT(machine.out, ::testing::Not(HasSubstr("drives")));
  const Said bus = run("--config vehicle.yaml doctor --bus");
  EXPECT_EQ(bus.status, 3) << "no such interface";
  EXPECT_EQ(bus.out, "");
  EXPECT_EQ(run("doctor --machine").status, 2) << "there is nothing to hold the machine against";
  EXPECT_EQ(run("--config vehicle.yaml doctor --machine --bus").status, 2);
}

}  // namespace

}  // namespace lf::app
