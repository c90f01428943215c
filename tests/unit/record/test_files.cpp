#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "host_sim/record/candump_log.hpp"
#include "host_sim/record/run_folder.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::record {
namespace {

using lf::test::message_of;
using lf::test::TemporaryFolder;
using testing::EndsWith;
using testing::HasSubstr;

TEST(RunFolder, IsCreatedWithItsParentsAndTakesFilesInSubfolders) {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path() / "a" / "b");
  folder.write("images/still.txt", std::string_view("seen"));
  EXPECT_EQ(temporary.read("a/b/images/still.txt"), "seen");
  EXPECT_FALSE(std::filesystem::exists(temporary.path() / "a" / "b" / ".writable"));
}

TEST(RunFolder, ReplacesAFileAsAWholeAndLeavesNothingBesideIt) {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  folder.write("result.json", std::string_view("old and longer"));
  folder.write("result.json", std::string_view("new"));
  EXPECT_EQ(temporary.read("result.json"), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(temporary.path()), {}), 1);
}

TEST(RunFolder, RefusesAPlaceThatIsAFileOrLiesBelowOne) {
  const TemporaryFolder temporary;
  const auto file = temporary.write("file", "x");
  EXPECT_THAT(message_of<InputError>([&] { RunFolder folder(file); }), HasSubstr("is a file, not a folder"));
  EXPECT_THAT(message_of<InputError>([&] { RunFolder folder(file / "below"); }), HasSubstr("Not a directory"));
}

TEST(RunFolder, RefusesAPlaceWhereNothingCanBeWritten) {
  // /proc refuses new files, to root too.
  EXPECT_THAT(message_of<InputError>([] { RunFolder folder("/proc"); }), HasSubstr("cannot be written"));
}

TEST(RunFolder, RefusesNamesThatLeaveIt) {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  for (const char* name : {"../x", "/etc/x", "a/../../x", ""}) EXPECT_THROW(folder.file(name), InputError) << name;
}

// /dev/full takes every open and refuses every byte with ENOSPC.
TEST(FileSink, TellsOfAFullDiskInOneLineAndNeverThrows) {
  FileSink sink("/dev/full");
  sink.write("a few bytes");
  EXPECT_FALSE(sink.close());
  EXPECT_EQ(sink.error(), "/dev/full: No space left on device");
  EXPECT_FALSE(sink.write("more"));
  EXPECT_FALSE(sink.close());
}

TEST(FileSink, KeepsWhatWasWrittenBeforeADestruction) {
  const TemporaryFolder temporary;
  {
    FileSink sink(temporary.path() / "log");
    EXPECT_TRUE(sink.write("kept"));
    FileSink moved = std::move(sink);
    EXPECT_TRUE(moved.write(" too"));
  }
  EXPECT_EQ(temporary.read("log"), "kept too");
}

TEST(CandumpLog, OnAFullDiskStopsAndCountsOnlyWhatWasTaken) {
  CandumpLog log("/dev/full");
  const CanFrame frame{0x123, 2, {1, 2}};
  bool taken = true;
  for (int i = 0; i < 10'000 && taken; ++i) taken = log.write(Time::from_ns(i), frame);
  EXPECT_FALSE(taken);  // once the buffer is full
  EXPECT_FALSE(log.close());
  EXPECT_THAT(log.sink().error(), HasSubstr("No space left"));
  EXPECT_LT(log.frames(), 10'000u);
}

// A file is written beside and renamed: that would take a link's or a device's place.
TEST(AtomicWrite, FollowsALinkAndRefusesWhatIsNoFile) {
  const TemporaryFolder temporary;
  (void)temporary.write("target.txt", "old");
  std::filesystem::create_symlink("target.txt", temporary.path() / "link.txt");
  write_file_atomically(temporary.path() / "link.txt", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(temporary.path() / "link.txt"));
  EXPECT_EQ(temporary.read("target.txt"), "new");
  ASSERT_EQ(::mkfifo((temporary.path() / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(message_of<InputError>([&] { write_file_atomically(temporary.path() / "pipe", "new"); }), HasSubstr("no regular file"));
  EXPECT_TRUE(std::filesystem::is_fifo(temporary.path() / "pipe"));
}

TEST(AtomicWrite, OnAFullDiskThrowsOneLineAndKeepsTheOldFile) {
  const TemporaryFolder temporary;
  temporary.write("result.json", "old");
  std::filesystem::create_symlink("/dev/full", temporary.path() / "result.json.partial");
  const std::string message = message_of<RecordError>([&] { write_file_atomically(temporary.path() / "result.json", "new"); });
  EXPECT_THAT(message, EndsWith("No space left on device"));
  EXPECT_EQ(temporary.read("result.json"), "old");
}

// Lines as can-utils' log files have them (candump.c, lib.c: sprint_canframe).
TEST(CandumpLine, HasCandumpsFormatForEveryKindOfFrame) {
  const Time t = Time::from_ns(1'436'509'052'249'713'999);
  EXPECT_EQ(candump_line(t, "can0", {0x123, 2, {1, 2}}), "(1436509052.249713) can0 123#0102\n");
  EXPECT_EQ(candump_line(Time(), "vcan1", {0x080, 0, {}}), "(0000000000.000000) vcan1 080#\n");
  EXPECT_EQ(candump_line(Time(), "can0", {0x12345u | CanFrame::extended_flag, 1, {0xAB}}), "(0000000000.000000) can0 00012345#AB\n");
  EXPECT_EQ(candump_line(Time(), "can0", {0x701 | CanFrame::remote_flag, 0, {}}), "(0000000000.000000) can0 701#R\n");
  EXPECT_EQ(candump_line(Time(), "can0", {0x701 | CanFrame::remote_flag, 8, {}}), "(0000000000.000000) can0 701#R8\n");
  EXPECT_EQ(candump_line(Time(), "can0", {4 | CanFrame::error_flag, 8, {0, 4}}), "(0000000000.000000) can0 20000004#0004000000000000\n");
}

TEST(CandumpLog, WritesFramesInTheirOrderWithSimulatedTime) {
  const TemporaryFolder temporary;
  CandumpLog log(temporary.path() / "can0.log");
  log.write(Time::from_s(0.004), {0x080, 0, {}});
  log.write(Time::from_s(12.5), {0x181, 8, {0x37, 0x06, 0x4F, 0x0B, 0, 0, 0x12, 0}});
  EXPECT_TRUE(log.close());
  EXPECT_EQ(log.frames(), 2u);
  EXPECT_EQ(temporary.read("can0.log"), "(0000000000.004000) can0 080#\n(0000000012.500000) can0 181#37064F0B00001200\n");
}

}  // namespace
}  // namespace lf::record
