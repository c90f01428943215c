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

}  // namespace
}  // namespace lf::app
