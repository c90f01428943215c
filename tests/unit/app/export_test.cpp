// What the program writes of a machine's bus. Other programs read it in tests/can.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "hal/config/text_file.hpp"
#include "tests/unit/app/program.hpp"

namespace lf::app {
namespace {

using ::testing::HasSubstr;

using Export = Program;

// Words, and numbers as numbers: 1e-05 is 0.00001.
std::vector<std::string> words_of(std::string text) {
  for (char& c : text)
    if (std::string("()[]|,").find(c) != std::string::npos) c = ' ';
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    std::ostringstream number;
    number.precision(14);
    number << value;
    words.push_back(*end == '\0' ? number.str() : word);
  }
  return words;
}

// The build's own DBC is written by another program, in another language, from the same table.
TEST_F(Export, OfTheDefaultMachineIsTheDbcThatTheBuildMakes) {
  const std::string built = (std::filesystem::path(LANTERNFISH_PROGRAM).parent_path().parent_path() / "share/can/lanternfish.dbc").string();
  const Said said = run("export dbc arm5e");
  ASSERT_EQ(said.status, 0) << said.err;
  EXPECT_EQ(words_of(said.out), words_of(config::read_text_file(built)));
}

TEST_F(Export, WritesAFileAndTellsWhatItCannotDo) {
  EXPECT_EQ(run("export dbc oberon7 --out oberon.dbc").status, 0);
  EXPECT_THAT(config::read_text_file((folder() / "oberon.dbc").string()), HasSubstr("BO_ 387 elbow_tpdo1: 8 elbow"));
  EXPECT_EQ(run("export dbc oberno7").status, 2);
  EXPECT_THAT(run("export dbc oberno7").err, HasSubstr("oberon7"));
  EXPECT_EQ(run("export dcb oberon7").status, 2);
  EXPECT_THAT(run("export dcb oberon7").err, HasSubstr("dbc"));
  const Said nowhere = run("export dbc arm5e --out nowhere/a.dbc");
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("nowhere/a.dbc: cannot be written: No such file or directory"));
}

// So are the data sheets.
TEST_F(Export, TheDefaultMachinesDataSheetsAreThoseThatTheBuildMakes) {
  const std::filesystem::path built = std::filesystem::path(LANTERNFISH_PROGRAM).parent_path().parent_path() / "share/can";
  const Said said = run("export eds arm5e --out sheets");
  ASSERT_EQ(said.status, 0) << said.err;
  for (const char* name :
       {"node1_slew.eds", "node2_shoulder.eds", "node3_elbow.eds", "node4_roll.eds", "node5_jaw.eds", "node6_outputs.eds"})
    EXPECT_EQ(config::read_text_file((folder() / "sheets" / name).string()), config::read_text_file((built / name).string())) << name;
}

TEST_F(Export, ADriveOfAnotherMakeHasItsMakersDataSheet) {
  std::ofstream(folder() / "other.yaml")
      << "version: 1\narm: {urdf: arm/arm5e.urdf}\ndrives: {elbow: {profile: epos4, node: 9}, roll: {node: 14}}\n";
  const Said said = run("export eds other.yaml --out sheets");
  ASSERT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.err, HasSubstr("no data sheet for node 9 (elbow): its drive is of another make, "));
  EXPECT_FALSE(std::filesystem::exists(folder() / "sheets/node9_elbow.eds"));
  EXPECT_THAT(config::read_text_file((folder() / "sheets/node14_roll.eds").string()),
              HasSubstr("Description=LF servo drive, roll, node 14\r\n"));
}

// A drive that is simulated as the project's own is still another's.
TEST_F(Export, ADriveThatIsOnlyLikeOursHasNoneOfOurs) {
  std::ofstream(folder() / "acme.yaml") << "title: ACME servo\nlike: cia402\nidentity: {vendor: \"0x00000ABC\", product: \"0x1\"}\n";
  std::ofstream(folder() / "other.yaml") << "version: 1\narm: {urdf: arm/arm5e.urdf}\ndrives: {profile: acme.yaml}\n";
  std::filesystem::create_directory(folder() / "sheets");
  std::ofstream(folder() / "sheets/node1_slew.eds") << "of another machine";
  const Said said = run("export eds other.yaml --out sheets");
  ASSERT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.err, HasSubstr("no data sheet for node 1 (slew): its drive is of another make, ACME servo, whose maker has one"));
  EXPECT_THAT(said.err, HasSubstr("sheets/node1_slew.eds is not of this export"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "sheets/node2_shoulder.eds"));
  EXPECT_TRUE(std::filesystem::exists(folder() / "sheets/node6_outputs.eds"));
}

TEST_F(Export, DataSheetsNeedAFolder) {
  EXPECT_EQ(run("export eds arm5e").status, 2);
  EXPECT_THAT(run("export eds arm5e").err, HasSubstr("--out FOLDER is missing"));
  std::ofstream(folder() / "a_file") << "x";
  const Said said = run("export eds arm5e --out a_file/sheets");
  EXPECT_EQ(said.status, 2);
  EXPECT_THAT(said.err, HasSubstr("a_file/sheets: cannot be made"));
  EXPECT_THAT(run("export eds arm5e --out a_file").err, HasSubstr("a_file: is a file, not a folder"));
}

}  // namespace
}  // namespace lf::app
