#include "shared/frame_ring/frame_ring.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "shared/frame_ring/mapped_file.hpp"
#include "shared/frame_ring/shared_file.hpp"

namespace lf {
namespace {

constexpr std::uint32_t slots = 4, payload = 1000;

struct alignas(64) Block {
  std::byte bytes[64];
};

class Memory {
 public:
  explicit Memory(std::size_t bytes = frame_ring_bytes(slots, payload)) : blocks_(bytes / sizeof(Block)) {}
  std::span<std::byte> span() { return {blocks_.front().bytes, blocks_.size() * sizeof(Block)}; }

 private:
  std::vector<Block> blocks_;
};

std::vector<std::byte> pattern(std::uint64_t n, std::size_t bytes) {
  std::vector<std::byte> data(bytes);
  for (std::size_t i = 0; i < bytes; ++i) data[i] = static_cast<std::byte>(n * 31 + i * (n + 1));
  return data;
}

RecordInfo info_of(std::uint32_t n) {
  RecordInfo info;
  info.sequence = n;
  info.trigger = static_cast<std::int32_t>(n % 256);
  info.start_ns = n * 1000;
  return info;
}

using Answer = FrameRingReader::Answer;

TEST(FrameRing, ARecordComesOutAsItWentIn) {
  Memory memory;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory.span(), slots, payload));
  FrameRingReader reader(memory.span());
  std::vector<std::byte> out(payload);
  RecordInfo info;
  EXPECT_EQ(reader.take(info, out), Answer::empty);
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{999}, std::size_t{payload}}) {
    const auto data = pattern(bytes, bytes);
    ASSERT_TRUE(writer.write(info_of(static_cast<std::uint32_t>(bytes)), data, 77));
    ASSERT_EQ(reader.take(info, out), Answer::record);
    EXPECT_EQ(info.bytes, bytes);
    EXPECT_EQ(info.sequence, bytes);
    EXPECT_EQ(info.written_ns, 77);
    EXPECT_TRUE(std::equal(data.begin(), data.end(), out.begin()));
  }
  EXPECT_EQ(reader.take(info, out), Answer::empty);
}

TEST(FrameRing, TooLargeARecordIsRefused) {
  Memory memory;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory.span(), slots, payload));
  EXPECT_FALSE(writer.write({}, pattern(1, payload + 1), 0));
}

TEST(FrameRing, ALateReaderGetsTheNewestAndKnowsHowManyItMissed) {
  Memory memory;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory.span(), slots, payload));
  FrameRingReader reader(memory.span());
  std::vector<std::byte> out(payload);
  RecordInfo info;
  ASSERT_EQ(reader.take(info, out), Answer::empty);
  for (std::uint32_t n = 0; n < 10; ++n) ASSERT_TRUE(writer.write(info_of(n), pattern(n, 10), 0));
  for (std::uint32_t n = 6; n < 10; ++n) {
    ASSERT_EQ(reader.take(info, out), Answer::record);
    EXPECT_EQ(info.sequence, n);
  }
  EXPECT_EQ(reader.take(info, out), Answer::empty);
  EXPECT_EQ(reader.stats().missed, 6u);
}

// Found by fuzz_frame_ring: the number of the missed came out below that of the torn ones.
TEST(FrameRing, ARingThatLiesAboutItsRecordsDoesNotCarryTheCountOver) {
  Memory memory;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory.span(), slots, payload));
  auto* header = reinterpret_cast<RingHeader*>(memory.span().data());
  FrameRingReader reader(memory.span());
  std::vector<std::byte> out(payload);
  RecordInfo info;
  ASSERT_EQ(reader.take(info, out), Answer::empty);
  for (int time = 0; time < 3; ++time) {
    header->published.store(~std::uint64_t{0});
    EXPECT_EQ(reader.take(info, out), Answer::empty);
    header->published.store(0);
    EXPECT_EQ(reader.take(info, out), Answer::empty);
  }
  EXPECT_EQ(reader.stats().missed, ~std::uint64_t{0});
  EXPECT_EQ(reader.stats().torn, 3 * slots);
}

TEST(FrameRing, WhatWasWrittenBeforeTheReaderCameIsOldNews) {
  Memory memory;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory.span(), slots, payload));
  ASSERT_TRUE(writer.write(info_of(1), pattern(1, 10), 0));
  FrameRingReader reader(memory.span());
  std::vector<std::byte> out(payload);
  RecordInfo info;
  EXPECT_EQ(reader.take(info, out), Answer::empty);
  ASSERT_TRUE(writer.write(info_of(2), pattern(2, 10), 0));
  ASSERT_EQ(reader.take(info, out), Answer::record);
  EXPECT_EQ(info.sequence, 2u);
}

TEST(FrameRing, AWriterThatComesBackIsNoticedAndAllItWroteIsRead) {
  Memory memory;
  std::vector<std::byte> out(payload);
  RecordInfo info;
  FrameRingReader reader(memory.span());
  EXPECT_EQ(reader.take(info, out), Answer::no_ring);
  {
    FrameRingWriter writer;
    ASSERT_TRUE(writer.open(memory.span(), slots, payload));
    EXPECT_EQ(reader.take(info, out), Answer::empty);
    ASSERT_TRUE(writer.write(info_of(1), pattern(1, 10), 0));
    ASSERT_EQ(reader.take(info, out), Answer::record);
  }
  FrameRingWriter again;
  ASSERT_TRUE(again.open(memory.span(), slots, payload));
  ASSERT_TRUE(again.write(info_of(50), pattern(50, 10), 0));
  ASSERT_EQ(reader.take(info, out), Answer::record);
  EXPECT_EQ(info.sequence, 50u);
  EXPECT_EQ(reader.stats().restarts, 1u);
}

TEST(FrameRing, ARecordHalfWrittenIsNeverRead) {
  Memory memory;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory.span(), slots, payload));
  FrameRingReader reader(memory.span());
  std::vector<std::byte> out(payload);
  RecordInfo info;
  ASSERT_EQ(reader.take(info, out), Answer::empty);
  ASSERT_TRUE(writer.write(info_of(0), pattern(0, 10), 0));
  // As a writer that died within record 1, after it had been published by a torn count.
  auto* header = reinterpret_cast<RingHeader*>(memory.span().data());
  auto* record = reinterpret_cast<RecordHeader*>(memory.span().data() + frame_ring_page + header->slot_bytes.load());
  record->ticket.store(3);
  header->published.store(2);
  ASSERT_EQ(reader.take(info, out), Answer::record);
  EXPECT_EQ(info.sequence, 0u);
  EXPECT_EQ(reader.take(info, out), Answer::empty);
  EXPECT_EQ(reader.stats().torn, 1u);
}

TEST(FrameRing, AnotherLayoutIsRefused) {
  Memory memory;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory.span(), slots, payload));
  auto* header = reinterpret_cast<RingHeader*>(memory.span().data());
  FrameRingReader reader(memory.span());
  std::vector<std::byte> out(payload);
  RecordInfo info;
  header->version.store(frame_ring_version + 1);
  EXPECT_EQ(reader.take(info, out), Answer::other_layout);
  header->version.store(frame_ring_version);
  header->slots.store(4000);  // beyond the memory
  EXPECT_EQ(reader.take(info, out), Answer::other_layout);
}

TEST(FrameRing, NotTooSmallAMemory) {
  Memory memory(frame_ring_bytes(slots, payload) - frame_ring_page);
  FrameRingWriter writer;
  EXPECT_FALSE(writer.open(memory.span(), slots, payload * 4));
  EXPECT_FALSE(writer.is_open());
}

// The other side changes the layout between the reader's look at it and its use: what is checked has to be what is used. Behind the memory there is none.
TEST(FrameRing, ALayoutThatChangesWhileItIsReadLeadsNowhereElse) {
  const std::size_t bytes = frame_ring_bytes(slots, payload);
  void* mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(mapped, MAP_FAILED);
  const std::span<std::byte> memory(static_cast<std::byte*>(mapped), bytes);
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory, slots, payload));
  auto* header = reinterpret_cast<RingHeader*>(mapped);
  const std::uint32_t honest = header->slot_bytes.load();
  std::atomic<bool> over = false;
  FrameRingReader reader(memory);
  std::vector<std::byte> out(payload);
  RecordInfo info;
  EXPECT_EQ(reader.take(info, out), Answer::empty);
  std::thread hostile([&] {
    for (std::uint64_t n = 1; n < 3'000'000; ++n) {
      header->published.store(n);
      header->slot_bytes.store(n % 2 == 0 ? 0x7FFF'FF80U : honest);
      header->slots.store(n % 7 == 0 ? 0 : slots);
    }
    over = true;
  });
  while (!over) (void)reader.take(info, out);
  hostile.join();
  munmap(mapped, bytes);
}

TEST(FrameRing, AWriterKeepsToItsOwnLayout) {
  Memory memory;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory.span(), slots, payload));
  auto* header = reinterpret_cast<RingHeader*>(memory.span().data());
  header->slots.store(0);
  header->payload_bytes.store(0xFFFF'FFFFU);
  header->slot_bytes.store(0xFFFF'FF80U);
  header->published.store(3);
  EXPECT_FALSE(writer.write(info_of(0), std::vector<std::byte>(payload + 1), 0));
  EXPECT_TRUE(writer.write(info_of(0), pattern(0, payload), 0));
  // In the fourth slot of 1152 bytes.
  EXPECT_EQ(std::memcmp(memory.span().data() + frame_ring_page + 3 * 1152 + 128, pattern(0, payload).data(), payload), 0);
}

class TemporaryFile {
 public:
  TemporaryFile() : path("/dev/shm/lf_frame_ring_test_" + std::to_string(getpid())) { std::remove(path.c_str()); }
  ~TemporaryFile() { std::remove(path.c_str()); }
  const std::string path;
};

// One file, as its writer maps it and as its reader reads it.
struct BothSides {
  BothSides() {
    EXPECT_EQ(mapped.open(path.path, bytes), 0);
    EXPECT_EQ(file.open(path.path, bytes), 0);
  }
  const TemporaryFile path;
  const std::size_t bytes = frame_ring_bytes(slots, payload);
  MappedFile mapped;
  SharedFile file;
};

// The payload is a function of the sequence: whatever the reader gets must agree with itself, however fast the writer overruns it.
void overrun(std::span<std::byte> memory, FrameRingReader reader) {
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(memory, slots, payload));
  std::vector<std::byte> out(payload);
  RecordInfo info;
  ASSERT_EQ(reader.take(info, out), Answer::empty);
  constexpr std::uint32_t records = 20'000;
  std::atomic<bool> done{false};
  std::thread writing([&] {
    for (std::uint32_t n = 0; n < records; ++n) (void)writer.write(info_of(n), pattern(n, payload), n);
    done = true;
  });
  std::uint64_t read = 0;
  std::int64_t last = -1;
  while (true) {
    const bool finished = done;
    const Answer answer = reader.take(info, out);
    if (answer == Answer::empty) {
      if (finished) break;
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(answer, Answer::record);
    ASSERT_GT(static_cast<std::int64_t>(info.sequence), last);
    last = info.sequence;
    ASSERT_EQ(info.trigger, static_cast<std::int32_t>(info.sequence % 256));
    ASSERT_EQ(out, pattern(info.sequence, payload)) << "record " << info.sequence;
    ++read;
  }
  writing.join();
  EXPECT_EQ(last, records - 1);
  EXPECT_EQ(read + reader.stats().missed, records);
}

TEST(FrameRing, AReaderThatIsOverrunSeesOnlyWholeRecords) {
  Memory memory;
  overrun(memory.span(), FrameRingReader(memory.span()));
}

TEST(FrameRing, AReaderOfAFileThatIsOverrunSeesOnlyWholeRecords) {
  BothSides ring;
  overrun(ring.mapped.bytes(), FrameRingReader(ring.file, 0, ring.bytes));
}

// Slots 2 and 3 are cut off. What the reader had not yet read there is missed; the writer that comes back is read from its first record on.
TEST(FrameRing, AFileCutShortLosesItsLastSlotsOnly) {
  BothSides ring;
  FrameRingWriter writer;
  ASSERT_TRUE(writer.open(ring.mapped.bytes(), slots, payload));
  FrameRingReader reader(ring.file, 0, ring.bytes);
  std::vector<std::byte> out(payload);
  RecordInfo info;
  ASSERT_EQ(reader.take(info, out), Answer::empty);
  for (std::uint32_t n = 0; n < slots; ++n) ASSERT_TRUE(writer.write(info_of(n), pattern(n, payload), n));
  ASSERT_EQ(truncate(ring.path.path.c_str(), static_cast<off_t>(frame_ring_page + 2 * 1152)), 0);
  for (std::uint32_t n = 0; n < 2; ++n) {
    ASSERT_EQ(reader.take(info, out), Answer::record);
    EXPECT_EQ(info.sequence, n);
    EXPECT_EQ(out, pattern(n, payload));
  }
  EXPECT_EQ(reader.take(info, out), Answer::empty);
  EXPECT_EQ(reader.stats().missed, 2u);
  EXPECT_EQ(reader.writer_beat_ns(), 3);
  ASSERT_EQ(truncate(ring.path.path.c_str(), 0), 0);
  EXPECT_EQ(reader.take(info, out), Answer::no_ring);
  EXPECT_EQ(reader.writer_beat_ns(), 0);
  ASSERT_EQ(truncate(ring.path.path.c_str(), static_cast<off_t>(ring.bytes)), 0);
  EXPECT_EQ(reader.take(info, out), Answer::no_ring);
  ASSERT_TRUE(writer.open(ring.mapped.bytes(), slots, payload));
  ASSERT_TRUE(writer.write(info_of(50), pattern(50, payload), 0));
  ASSERT_EQ(reader.take(info, out), Answer::record);
  EXPECT_EQ(info.sequence, 50u);
  EXPECT_EQ(out, pattern(50, payload));
}

// Slots 2 and 3 are cut off and come back as zeroes. Every record that is taken is whole.
TEST(FrameRing, AFileCutShortWhileItIsReadGivesOnlyWholeRecords) {
  const TemporaryFile path;
  const std::size_t bytes = frame_ring_bytes(slots, payload);
  MappedFile mapped;
  SharedFile file;
  ASSERT_EQ(mapped.open(path.path, bytes), 0);
  ASSERT_EQ(file.open(path.path, bytes), 0);
  std::atomic<bool> over = false;
  std::thread cutting([&] {
    FrameRingWriter writer;
    for (std::uint32_t n = 0; n < 2000; ++n) {
      // The writer maps the file, so it writes only while all of it is there.
      (void)writer.open(mapped.bytes(), slots, payload);
      for (std::uint32_t i = 0; i < slots; ++i) (void)writer.write(info_of(slots * n + i), pattern(slots * n + i, payload), n);
      (void)!truncate(path.path.c_str(), static_cast<off_t>(frame_ring_page + 2 * 1152));
      (void)!truncate(path.path.c_str(), static_cast<off_t>(bytes));
    }
    over = true;
  });
  FrameRingReader reader(file, 0, bytes);
  std::vector<std::byte> out(payload);
  RecordInfo info;
  bool all_whole = true;
  while (!over) {
    if (reader.take(info, out) == Answer::record) all_whole = all_whole && out == pattern(info.sequence, payload);
  }
  cutting.join();
  EXPECT_TRUE(all_whole);
  EXPECT_GT(reader.stats().records, 0u);
}

TEST(MappedFile, IsTheSameMemoryForTwoProcessesAndOutlivesAKilledWriter) {
  const TemporaryFile file;
  const std::size_t bytes = frame_ring_bytes(slots, payload);
  MappedFile mapped;
  ASSERT_EQ(mapped.open(file.path, bytes), 0);
  FrameRingReader reader(mapped.bytes());
  const pid_t child = fork();
  if (child == 0) {
    MappedFile own;
    FrameRingWriter writer;
    if (own.open(file.path, bytes) != 0 || !writer.open(own.bytes(), slots, payload)) _exit(1);
    for (std::uint32_t n = 0;; ++n) {
      (void)writer.write(info_of(n), pattern(n, payload), n);
      usleep(200);
    }
  }
  std::vector<std::byte> out(payload);
  RecordInfo info;
  int read = 0;
  for (int look = 0; look < 200'000 && read < 100; ++look) {
    if (reader.take(info, out) != Answer::record) {
      usleep(50);
      continue;
    }
    ASSERT_EQ(out, pattern(info.sequence, payload));
    ++read;
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_EQ(read, 100);
  while (reader.take(info, out) == Answer::record) ASSERT_EQ(out, pattern(info.sequence, payload));
  FrameRingWriter again;
  ASSERT_TRUE(again.open(mapped.bytes(), slots, payload));
  ASSERT_TRUE(again.write(info_of(7), pattern(7, payload), 0));
  ASSERT_EQ(reader.take(info, out), Answer::record);
  EXPECT_EQ(info.sequence, 7u);
}

TEST(MappedFile, TellsWhatIsWrong) {
  MappedFile mapped;
  EXPECT_EQ(mapped.open("/nowhere/ring", 4096), ENOENT);
  EXPECT_EQ(mapped.open("/dev/shm", 4096), EISDIR);
  EXPECT_EQ(mapped.open("/dev/shm/lf_ring", 5000), EINVAL);
  EXPECT_FALSE(mapped.is_open());
}

}  // namespace
}  // namespace lf
