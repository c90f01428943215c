#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "host_sim/record/experiment.hpp"
#include "host_sim/record/folder_in_writing.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::record {
namespace {

namespace fs = std::filesystem;
using lf::test::message_of;
using lf::test::TemporaryFolder;
using testing::HasSubstr;

const Experiment ours{{"scenario", "valve:\n  friction_nm: 3   # torque, N m\n  start_deg: {min: -40, max: 40} # angle\n"},
                      {"program", "abc"},
                      {"seed", "1"}};

TEST(Experiment, TellsWhichKeysOfTheScenarioDiffer) {
  Experiment theirs = ours;
  theirs["scenario"] = "valve:\n  friction_nm: 2   # torque, N m\n  start_deg: {min: -40, max: 40} # angle\n";
  theirs["seed"] = "5";
  EXPECT_EQ(difference(theirs, ours), "valve.friction_nm was 2, is 3; seed was 5, is 1");
  theirs = ours;
  theirs["program"] = "abd";
  EXPECT_EQ(difference(theirs, ours), "program is another");
  EXPECT_EQ(difference(ours, ours), "");
  EXPECT_NE(hash_of(theirs), hash_of(ours));
}

TEST(Experiment, AFolderOfAnotherOneIsRefused) {
  const TemporaryFolder temporary;
  const fs::path place = temporary.path() / "run";
  { FolderInWriting(place, ours).publish(); }
  EXPECT_EQ(read_experiment(place), ours);
  EXPECT_NO_THROW(refuse_other(place, ours));
  Experiment other = ours;
  other["seed"] = "2";
  EXPECT_THAT(message_of<InputError>([&] { refuse_other(place, other); }), HasSubstr("holds another experiment: seed was 1, is 2"));
  fs::create_directories(temporary.path() / "foreign");
  temporary.write("foreign/photo.png", "x");
  EXPECT_THAT(message_of<InputError>([&] { refuse_other(temporary.path() / "foreign", ours); }), HasSubstr("has no experiment.json"));
}

TEST(FolderInWriting, TakesItsPlaceAsAWholeAndLeavesNothingOfAnEarlierRun) {
  const TemporaryFolder temporary;
  const fs::path place = temporary.path() / "run";
  {
    FolderInWriting first(place, ours);
    first.folder().write("cloud.pcd", std::string_view("of the first"));
    EXPECT_FALSE(fs::exists(place)) << "before it is whole";
    first.publish();
  }
  EXPECT_EQ(temporary.read("run/cloud.pcd"), "of the first");
  {
    FolderInWriting second(place, ours);
    second.folder().write("result.json", std::string_view("of the second"));
    second.publish();
  }
  EXPECT_FALSE(fs::exists(place / "cloud.pcd"));
  EXPECT_EQ(temporary.read("run/result.json"), "of the second");
  EXPECT_EQ(std::distance(fs::directory_iterator(temporary.path()), {}), 1) << "nothing beside it";
}

// They were removed with the earlier run.
TEST(FolderInWriting, FilesThatNoRunWritesAreRefused) {
  const TemporaryFolder temporary;
  const fs::path place = temporary.path() / "run";
  Experiment with_file = ours;
  with_file["file ../our.urdf"] = "abc";
  const auto refusal = [&] { return message_of<InputError>([&] { FolderInWriting(place, with_file); }); };
  {
    FolderInWriting first(place, with_file);
    for (const char* name : {"our.urdf", "drives/our.urdf", "scenario.yaml", "images/still_001.00s.png", "raw/000001_on.png"})
      first.folder().write(name, std::string_view("x"));
    first.publish();
  }
  fs::create_directories(place / "raw");
  EXPECT_NO_THROW(FolderInWriting(place, with_file));
  temporary.write("run/notes.txt", "mine");
  EXPECT_THAT(refusal(), HasSubstr("holds notes.txt, which no run writes"));
  fs::remove(place / "notes.txt");
  fs::create_directories(place / "mine");
  EXPECT_THAT(refusal(), HasSubstr("holds mine, which no run writes"));
  temporary.write("run/mine/plot.png", "mine");
  EXPECT_THAT(refusal(), HasSubstr("holds mine/plot.png, which no run writes"));
  EXPECT_EQ(temporary.read("run/mine/plot.png"), "mine");
}

// An empty one was replaced by the folder.
TEST(FolderInWriting, AFileInItsPlaceIsRefused) {
  const TemporaryFolder temporary;
  for (const char* text : {"", "x"}) {
    temporary.write("run", text);
    EXPECT_THAT(message_of<InputError>([&] { FolderInWriting(temporary.path() / "run", ours); }), HasSubstr("is a file, not a folder"));
    EXPECT_EQ(temporary.read("run"), text);
  }
}

TEST(FolderInWriting, WhatIsNotPublishedIsGoneAndTheEarlierRunStays) {
  const TemporaryFolder temporary;
  const fs::path place = temporary.path() / "run";
  { FolderInWriting(place, ours).publish(); }
  {
    FolderInWriting broken_off(place, ours);
    broken_off.folder().write("result.json", std::string_view("half"));
    EXPECT_TRUE(broken_off.place_is_taken());
  }
  EXPECT_FALSE(fs::exists(place / "result.json"));
  EXPECT_TRUE(fs::exists(place / "experiment.json"));
  EXPECT_EQ(std::distance(fs::directory_iterator(temporary.path()), {}), 1);
}

TEST(FolderInWriting, TwoAtOnceDoNotMix) {
  const TemporaryFolder temporary;
  const FolderInWriting first(temporary.path() / "run", ours);
  EXPECT_THAT(message_of<InputError>([&] { FolderInWriting(temporary.path() / "run", ours); }), HasSubstr("another run is writing there"));
  EXPECT_TRUE(fs::exists(temporary.path() / "run.writing" / "experiment.json")) << "the first goes on";
}

}  // namespace
}  // namespace lf::record
