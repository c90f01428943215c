// A machine's file: what it says comes through, and what is wrong with it is told with its place.
#include "hal/config/machine_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "hal/config/key_text.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

struct Read {
  Machine machine;
  std::vector<std::string> problems;
};

Read read(const std::filesystem::path& file) {
  Read read;
  read_machine_file(file, read.machine, read.problems);
  return read;
}

Read read_text(const std::string& text) {
  const test::TemporaryFolder folder;
  return read(folder.write("machine.yaml", text));
}

std::vector<std::string> texts_of(Machine machine) {
  std::vector<std::string> texts;
  for (const Key& key : machine_keys(machine)) texts.push_back(key.path + ": " + value_text(key));
  return texts;
}

TEST(MachineFile, ThatIsShippedIsTheDefaultMachine) {
  const Read shipped = read(share_folder() / "machines" / "arm5e.yaml");
  EXPECT_THAT(shipped.problems, IsEmpty());
  EXPECT_EQ(texts_of(shipped.machine), texts_of(Machine()));
}

TEST(MachineFile, ThatIsWrittenForAUserIsTheDefaultMachine) {
  const Read listed = read_text("version: 1\n" + machine_listing());
  EXPECT_THAT(listed.problems, IsEmpty());
  EXPECT_EQ(texts_of(listed.machine), texts_of(Machine()));
}

TEST(MachineFile, SaysOnlyWhatItSays) {
  const Read some = read_text("version: 1\ncamera: {down_deg: 30}\narm: {park_rad: [0.1, 0.5, 1.8, 0.2]}\ndrives: {elbow: {node: 17}}\n");
  EXPECT_THAT(some.problems, IsEmpty());
  EXPECT_EQ(some.machine.camera.down_deg, 30);
  EXPECT_EQ(some.machine.camera.right_deg, Machine().camera.right_deg);
  EXPECT_THAT(some.machine.park_rad, ElementsAre(0.1, 0.5, 1.8, 0.2));
  EXPECT_EQ(some.machine.drives.joints[2].node, 17);
  EXPECT_EQ(some.machine.arm_urdf, Machine().arm_urdf);
}

TEST(MachineFile, FindsWhatItNamesBesideItAndThenAmongTheShipped) {
  const test::TemporaryFolder folder;
  folder.write("my.urdf", read_text_file(share_folder() / "arm" / "arm5e.urdf"));
  folder.write("my_limits.yaml", "");
  folder.write("profile.yaml", "");
  const auto file = folder.write("machine.yaml",
                                 "version: 1\narm: {urdf: my.urdf}\nsafety: {limits: my_limits.yaml}\ndrives: {profile: epos4, roll: "
                                 "{profile: ./profile.yaml}}\n");
  const Read named = read(file);
  EXPECT_THAT(named.problems, IsEmpty());
  EXPECT_EQ(named.machine.arm_urdf, folder / "my.urdf");
  EXPECT_EQ(named.machine.safety_limits, folder / "my_limits.yaml");
  EXPECT_EQ(named.machine.drives.profile, "epos4");
  EXPECT_EQ(named.machine.drives.joints[3].profile, folder / "profile.yaml");
}

// A robot's folder may have files of the same names as the shipped ones, and so may the folder of whoever names the machine.
TEST(MachineFile, NamesAShippedFileByItsWholePathWhereTheNameMeansAnotherOne) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "mission/arm");
  folder.write("mission/arm/arm5e.urdf", "another arm");
  Read named;
  named.machine.file = folder / "mission/mine.yaml";
  read_machine_file(folder.write("machine.yaml", "version: 1\narm: {urdf: arm/arm5e.urdf}\n"), named.machine, named.problems);
  EXPECT_THAT(named.problems, IsEmpty());
  EXPECT_EQ(named.machine.arm_urdf, std::filesystem::absolute(share_folder() / "arm" / "arm5e.urdf"));
}

TEST(MachineFile, OfAnArmOfOnesOwnNamesItsLimits) {
  const test::TemporaryFolder folder;
  folder.write("my.urdf", read_text_file(share_folder() / "arm" / "arm5e.urdf"));
  EXPECT_THAT(read(folder.write("machine.yaml", "version: 1\narm: {urdf: my.urdf}\n")).problems,
              ElementsAre(HasSubstr("'safety.limits' has to name its limits")));
}

TEST(MachineFile, IsTheSchemasThatIsShipped) {
  EXPECT_EQ(read_text_file(share_folder() / "machines" / "machine.schema.json"), machine_schema());
}

TEST(MachineFile, TellsWhichOfItsKeysAreTheDefaultMachines) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("machine.yaml", "version: 1\ncamera: {down_deg: 30}\narm.urdf: arm/arm5e.urdf\nlaser:\n");
  const std::vector<std::string> left_out = keys_left_out(file);
  EXPECT_THAT(left_out, testing::Contains("laser.position_m"));
  EXPECT_THAT(left_out, testing::Contains("arm.park_rad"));
  EXPECT_THAT(left_out, testing::Not(testing::Contains("camera.down_deg")));
  EXPECT_THAT(left_out, testing::Not(testing::Contains("arm.urdf")));
}

TEST(MachineFile, IsRefusedWithTheLineOfEachProblem) {
  struct Case {
    const char *text, *line, *message;
  };
  for (const Case& bad :
       {Case{"camera: {down_deg: 30}\n", ":1: ", "has no version"}, Case{"version: 2\n", ":1: ", "version"},
        Case{"version: 1\ncamra: {down_deg: 30}\n", ":2: ", "did you mean"},
        Case{"version: 1\ncamera:\n  down_deg: steep\n", ":3: ", "camera.down_deg"},
        Case{"version: 1\ncamera:\n  down_deg: 95\n", ":3: ", "95"},
        Case{"version: 1\nlaser:\n  position_m: [0, 1]\n", ":3: ", "laser.position_m"},
        Case{"version: 1\narm:\n  urdf: nowhere.urdf\n", ": ", "there is no nowhere.urdf"},
        Case{"version: 1\nsafety: {limits: /}\n", ": ", "is a folder"},
        Case{"version: 1\npanel: {file: pandora}\n", ":2: ", "a scenario says"},
        Case{"version: 1\narm: {park_rad: [0, 1]}\n", ": ", "'arm.park_rad' takes 4 numbers"},
        Case{"version: 1\narm: {urdf: \"\"}\n", ": ", "'arm.urdf' is empty"},
        Case{"- version: 1\n", ":1: ", "a machine's file has version, arm"},
        Case{"version: 1\ncamera: {down_deg: 30, down_deg: 31}\n", ":2: ", "down_deg"}, Case{"version: 1\ncamera: [\n", ":", ""}}) {
    const test::TemporaryFolder folder;
    const Read refused = read(folder.write("machine.yaml", bad.text));
    ASSERT_FALSE(refused.problems.empty()) << bad.text;
    EXPECT_THAT(refused.problems.front(), AllOf(StartsWith(folder / "machine.yaml" + bad.line), HasSubstr(bad.message))) << bad.text;
  }
  EXPECT_THAT(read("/nowhere/machine.yaml").problems, ElementsAre(StartsWith("/nowhere/machine.yaml")));
}

// Of the file for a user: lines taken away, doubled, cut, their numbers made negative, huge or none. Refused with the file's name, or read; never worse.
TEST(MachineFile, MutatedIsReadOrRefusedByName) {
  constexpr std::uint64_t seed = 20261128;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  const std::string good = "version: 1\n" + machine_listing();
  const auto any = [&](std::size_t below) { return std::uniform_int_distribution<std::size_t>(0, below - 1)(random); };
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    std::vector<std::string> lines;
    std::istringstream stream(good);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    const std::size_t at = any(lines.size());
    std::string& line = lines[at];
    const std::size_t digit = line.find_first_of("0123456789");
    switch (any(7)) {
      case 0: lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at)); break;
      case 1: lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), line); break;
      case 2: line.resize(any(line.size() + 1)); break;
      case 3:
        if (digit != std::string::npos) line.insert(digit, "-");
        break;
      case 4:
        if (digit != std::string::npos) line.insert(digit, "9e99");
        break;
      case 5:
        if (digit != std::string::npos) line.replace(digit, 1, ".nan");
        break;
      default: line += std::string(1, static_cast<char>(33 + any(90)));
    }
    std::string text;
    for (const std::string& one : lines) text += one + "\n";
    const test::TemporaryFolder folder;
    const Read one = read(folder.write("machine.yaml", text));
    refused += one.problems.empty() ? 0 : 1;
    for (const std::string& problem : one.problems) EXPECT_THAT(problem, StartsWith(folder / "machine.yaml")) << text;
  }
  EXPECT_GT(refused, 60) << "mutations that no reader minds test nothing";
}

}  // namespace
}  // namespace lf::config
