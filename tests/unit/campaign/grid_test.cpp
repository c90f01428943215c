#include "host_sim/campaign/grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/input_error.hpp"

namespace lf::campaign {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal_of(const std::vector<std::string>& set) {
  try {
    (void)grid_of(set);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::vector<std::string> labels_of(const Grid& grid) {
  std::vector<std::string> labels;
  for (const Choice& cell : grid.cells) labels.push_back(label_of(cell));
  return labels;
}

TEST(Grid, WithoutAListThereIsOneCell) {
  const Grid grid = grid_of({"valve.friction_nm=2"});
  EXPECT_TRUE(grid.keys.empty());
  EXPECT_THAT(labels_of(grid), ElementsAre(""));
  EXPECT_THAT(grid.set_of(grid.cells[0]), ElementsAre("valve.friction_nm=2"));
  EXPECT_THAT(labels_of(grid_of({})), ElementsAre(""));
}

TEST(Grid, SeveralKeysAreFlownInAllCombinations) {
  const Grid grid = grid_of({"a.x=1, 2,3", "b=7", "c=u,v"});
  EXPECT_THAT(grid.keys, ElementsAre("a.x", "c"));
  EXPECT_THAT(labels_of(grid), ElementsAre("a.x=1, c=u", "a.x=1, c=v", "a.x=2, c=u", "a.x=2, c=v", "a.x=3, c=u", "a.x=3, c=v"));
  EXPECT_THAT(grid.set_of(grid.cells[3]), ElementsAre("b=7", "a.x=2", "c=v"));
}

// A value is written as in the scenario's file: its own commas stand in brackets or quotes.
TEST(Grid, CommasOfAValueDivideNothing) {
  EXPECT_TRUE(grid_of({"tasks=[turn_valve: {to_deg: 45}, press_button: left]"}).keys.empty());
  EXPECT_TRUE(grid_of({"x={min: 1, max: 2}"}).keys.empty());
  EXPECT_TRUE(grid_of({"expect.failure=\"drive fault: elbow, in step scan\""}).keys.empty());
  EXPECT_THAT(labels_of(grid_of({"x=[1, 2],{min: 1, max: 2}"})), ElementsAre("x=[1, 2]", "x={min: 1, max: 2}"));
  EXPECT_THAT(labels_of(grid_of({"x='a,b',it's"})), ElementsAre("x='a,b'", "x=it's"));
  EXPECT_TRUE(grid_of({"x=[1, 2"}).keys.empty());  // for the scenario's reader to refuse
  EXPECT_TRUE(grid_of({"novalue"}).keys.empty());
}

TEST(Grid, WhatIsEmptyOrTwiceIsRefusedByName) {
  EXPECT_THAT(refusal_of({"a=1,,2"}), HasSubstr("--set a=1,,2: value 2 of the list is empty"));
  EXPECT_THAT(refusal_of({"a=1,"}), HasSubstr("value 2 of the list is empty"));
  EXPECT_THAT(refusal_of({"a=1,2,1"}), HasSubstr("1 is given twice"));
  EXPECT_THAT(refusal_of({"a=1,2", "a=3"}), HasSubstr("--set a: it has several values, and is set twice"));
  EXPECT_THAT(refusal_of({"a=3", "a=1,2"}), HasSubstr("set twice"));
  std::string many = "=0";
  for (int i = 1; i < 40; ++i) many += "," + std::to_string(i);
  EXPECT_THAT(refusal_of({"a" + many, "b" + many}), HasSubstr("more than a thousand"));
}

TEST(Grid, ACellsFolderSaysWhatItIsAndLeavesItsPlaceAlone) {
  EXPECT_EQ(folder_of({{"valve.friction_nm", "2"}, {"lamps.lit", "true"}}, "0123456789abcdef"),
            "valve.friction_nm=2,lamps.lit=true-01234567");
  const std::string strange = folder_of({{"x", "../[a b]\n?#%é\"'"}}, "0123456789");
  EXPECT_EQ(strange.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789._-=,+"), std::string::npos) << strange;
  EXPECT_LE(folder_of({{"x", std::string(500, 'y')}}, "0123456789").size(), 70u);
}

}  // namespace
}  // namespace lf::campaign
