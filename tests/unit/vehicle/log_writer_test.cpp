// The log: rotation, a disk that is slow, a clock that is set.
#include "hal/vehicle/log_writer.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "hal/vehicle/tick_clock.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::hal {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

std::string unpacked(const std::string& path) {
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return "no file";
  std::string text(1 << 20, '\0');
  const int bytes = gzread(file, text.data(), static_cast<unsigned>(text.size()));
  gzclose(file);
  text.resize(bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
  return text;
}

bool exists(const std::string& path) { return access(path.c_str(), F_OK) == 0; }

TEST(RotatingFile, SetsAFullFileAsideAndKeepsTheYoungest) {
  const TemporaryFolder folder;
  const std::string path = folder / "x.log";
  RotatingFile file({.path = path, .largest_bytes = 10, .keep = 2, .pack = true});
  ASSERT_EQ(file.open(), 0);
  for (const char* text : {"first......", "second.....", "third......", "fourth....."}) {
    EXPECT_EQ(file.write(text), 0);
    EXPECT_EQ(file.flush(), 0);
    file.finish_packing();
  }
  EXPECT_EQ(folder.read("x.log"), "fourth.....");
  EXPECT_EQ(unpacked(path + ".1.gz"), "third......");
  EXPECT_EQ(unpacked(path + ".2.gz"), "second.....");
  EXPECT_FALSE(exists(path + ".3.gz"));
  EXPECT_FALSE(exists(path + ".1"));
}

TEST(RotatingFile, GoesOnBehindWhatIsThere) {
  const TemporaryFolder folder;
  folder.write("x.log", "before");
  RotatingFile file({.path = folder / "x.log", .largest_bytes = 10, .keep = 2, .pack = false});
  ASSERT_EQ(file.open(), 0);
  EXPECT_EQ(file.write(" more."), 0);
  EXPECT_EQ(file.write("next"), 0);
  EXPECT_EQ(file.close(), 0);
  EXPECT_EQ(folder.read("x.log"), "next");
  EXPECT_EQ(folder.read("x.log.1"), "before more.");
}

class Log : public testing::Test {
 protected:
  std::unique_ptr<LogRings> rings = std::make_unique<LogRings>();
  TemporaryFolder folder;
};

// A disk that takes less than comes: the frames' ring is never empty, and the lines of faults and orders waited for it to be.
TEST_F(Log, FramesThatComeFasterThanTheDiskLeaveRoomForLines) {
  const std::string pipe = folder / "can0.log";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDWR);
  ASSERT_GE(reader, 0);
  LogWriter writer(*rings, {.folder = folder.path().string(), .interface = "can0"});
  ASSERT_EQ(writer.open(), 0);
  std::atomic<bool> over = false;
  std::thread bus([&] {
    while (!over) {
      while (rings->frames.push(LogFrame{})) {
      }
      sleep_until(monotonic_now() + Duration::from_ms(1));
    }
  });
  std::thread disk([&] {
    std::vector<char> block(4096);
    while (!over && read(reader, block.data(), block.size()) > 0) sleep_until(monotonic_now() + Duration::from_ms(20));
  });
  writer.start();
  writer.say({{"kind", "said"}});
  const Time limit = monotonic_now() + Duration::from_s(20);
  while (folder.read("log.jsonl").find("said") == std::string::npos && monotonic_now() < limit)
    sleep_until(monotonic_now() + Duration::from_ms(20));
  EXPECT_THAT(folder.read("log.jsonl"), HasSubstr("said"));
  over = true;
  bus.join();
  disk.join();
  // What waits in the pipe is let go, so that the writer can end.
  std::atomic<bool> ended = false;
  std::thread drain([&] {
    std::vector<char> block(1 << 16);
    fcntl(reader, F_SETFL, O_NONBLOCK);
    while (!ended) {
      while (read(reader, block.data(), block.size()) > 0) {
      }
      sleep_until(monotonic_now() + Duration::from_ms(1));
    }
  });
  writer.stop();
  ended = true;
  drain.join();
  close(reader);
}

// The log's lock was held while the disk wrote: whoever had something to say waited with it.
TEST_F(Log, ADiskThatDoesNotWriteHoldsUpNobody) {
  const std::string pipe = folder / "log.jsonl";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDWR | O_NONBLOCK);  // never read from: the pipe is full after 64 KB
  ASSERT_GE(reader, 0);
  LogWriter writer(*rings, {.folder = folder.path().string(), .interface = "can0"});
  ASSERT_EQ(writer.open(), 0);
  writer.start();
  const Json line{{"text", std::string(1000, 'x')}};
  Duration longest;
  for (int i = 0; i < 12'000; ++i) {
    const Time before = monotonic_now();
    writer.say(line);
    longest = std::max(longest, monotonic_now() - before);
    if (i % 100 == 0) sleep_until(monotonic_now() + Duration::from_ms(1));
  }
  EXPECT_LT(longest.ns(), 500'000'000);
  EXPECT_GT(writer.lines_lost(), 0u);  // 4096 wait, the rest is counted
  std::vector<char> sink(1 << 16);
  std::thread drain([&] {  // so that the writer can end
    for (int i = 0; i < 4000; ++i) {
      while (read(reader, sink.data(), sink.size()) > 0) {
      }
      usleep(500);
    }
  });
  writer.stop();
  drain.join();
  close(reader);
}

// A frame is logged with the wall clock's time of now, not with that of the start.
TEST_F(Log, FollowsAWallClockThatIsSet) {
  class SetClock : public LinuxCalls {
   public:
    std::int64_t monotonic_ns() override { return now.ns(); }
    std::int64_t realtime_ns() override { return now.ns() + offset_ns; }
    Time now = Time::from_ns(1'000'000'000);
    std::atomic<std::int64_t> offset_ns{0};
  } clock;
  LogWriter writer(*rings, {.folder = folder.path().string(), .interface = "can0"}, clock);
  ASSERT_EQ(writer.open(), 0);
  clock.offset_ns = std::int64_t{1'700'000'000} * 1'000'000'000;
  writer.start();
  sleep_until(monotonic_now() + Duration::from_ms(100));
  CanFrame frame;
  frame.id = 0x123;
  ASSERT_TRUE(rings->frames.push({frame, Time::from_ns(2'000'000'000), false}));
  writer.stop();
  EXPECT_THAT(folder.read("can0.log"), HasSubstr("(1700000002.000000) can0 123#"));
  EXPECT_THAT(folder.read("log.jsonl"), HasSubstr("wall clock set"));
}

TEST_F(Log, SaysThatItIsNotWrittenForAsLongAsThatIsSo) {
  LogWriter nowhere(*rings, {.folder = "/proc/no/such/folder", .interface = "can0"});
  EXPECT_NE(nowhere.open(), 0);
  LogWriter writer(*rings, {.folder = folder.path().string(), .interface = "can0"});
  ASSERT_EQ(writer.open(), 0);
  EXPECT_EQ(writer.trouble(), "");
}

TEST_F(Log, OnAFullDiskSaysSoForAsLongAsWritesFail) {
  const std::string frames = folder / "can0.log";
  ASSERT_EQ(symlink("/dev/full", frames.c_str()), 0);
  LogWriter writer(*rings, {.folder = folder.path().string(), .interface = "can0"});
  ASSERT_EQ(writer.open(), 0);
  writer.start();
  ASSERT_TRUE(rings->frames.push(LogFrame{}));
  const auto wait_until = [&](bool trouble) {
    const Time limit = monotonic_now() + Duration::from_s(10);
    while (writer.trouble().empty() == trouble && monotonic_now() < limit) sleep_until(monotonic_now() + Duration::from_ms(10));
  };
  wait_until(true);
  EXPECT_THAT(writer.trouble(), testing::AllOf(HasSubstr("the log is not written"), HasSubstr("No space left")));
  wait_until(false);
  EXPECT_EQ(writer.trouble(), "") << "nothing more had to be written";
  writer.stop();
}

}  // namespace
}  // namespace lf::hal
