// A ring of records in shared memory: camera frames, or any other record of bounded size, from one writer to one reader.
//
// The writer never waits: it overwrites the oldest record. The reader copies a record out and then looks whether it was overwritten meanwhile, so
// neither side can hold up the other, and either may die and come back at any moment:
//   - a writer that died within a record leaves it unpublished; the one that comes back begins a new generation, which the reader notices;
//   - a reader that comes late or was away finds the newest records and knows how many it has missed.
// Everything is in the memory itself, in little-endian numbers of fixed size, so that two builds, two processes or a guest and its host agree:
//
//   0      RingHeader, one page of 4096 bytes
//   4096   slot 0: RecordHeader (128 bytes), payload, filled up to a multiple of 128 bytes
//   ...    slot 1 ...
//
// Both directions through one file: a ring each in a part of its own of MappedFile::bytes(), each written by one side.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/frame_ring/shared_file.hpp"

namespace lf {

// What is said of a record. Of a camera's frame everything counts; of other records what their kind says.
struct RecordInfo {
  std::uint32_t kind = 0;        // 0: an 8-bit grey image; others are the two sides' affair
  std::int32_t width = 0;        // px
  std::int32_t height = 0;       // px
  std::int32_t stride = 0;       // bytes from row to row
  std::int64_t start_ns = 0;     // of the exposure, on the writer's CLOCK_MONOTONIC; a guest's clock is not its host's
  std::int64_t exposure_ns = 0;  // its length
  std::int64_t written_ns = 0;   // when it was handed over, on the writer's CLOCK_MONOTONIC
  std::uint32_t sequence = 0;    // counts the camera's exposures; a gap is a lost frame
  std::int32_t trigger =
      -1;  // trigger counter of the output node (0..255) that asked for the exposure; -1: not triggered. Names the exposure whatever the clocks say
  std::uint32_t flags = 0;  // frame_laser | frame_lamps: outputs during the exposure, for the record only
  std::uint32_t bytes = 0;  // of the payload; filled by write()
};
inline constexpr std::uint32_t frame_laser = 1;
inline constexpr std::uint32_t frame_lamps = 2;

inline constexpr std::uint64_t frame_ring_magic = 0x31474E4952464CULL;  // "LFRING1"
inline constexpr std::uint32_t frame_ring_version = 1;
inline constexpr std::size_t frame_ring_page = 4096;

struct RingHeader {
  std::atomic<std::uint64_t> magic;  // written last: 0 while the ring is being laid out
  std::atomic<std::uint32_t> version;
  std::atomic<std::uint32_t> slot_bytes;  // from one slot to the next
  std::atomic<std::uint32_t> slots;
  std::atomic<std::uint32_t> payload_bytes;  // that fit into a slot
  std::atomic<std::uint64_t> generation;     // grows with every start of a writer
  std::atomic<std::uint64_t> published;      // records of this generation, ever
  std::atomic<std::int64_t> writer_beat_ns;  // the writer's CLOCK_MONOTONIC when it last wrote or beat
};
static_assert(sizeof(RingHeader) <= frame_ring_page && std::atomic<std::uint64_t>::is_always_lock_free);

struct RecordHeader {
  std::atomic<std::uint64_t> ticket;  // 2 n + 1 while record n is being written, 2 n + 2 when it is whole; 0 before the first
  RecordInfo info;
};
static_assert(sizeof(RecordHeader) <= 128);

// Bytes of memory for `slots` records of at most `payload_bytes`, a multiple of the page size.
std::size_t frame_ring_bytes(std::uint32_t slots, std::uint32_t payload_bytes);

// What four frames of a 640x480 camera take: 1.2 MB. The reader comes every few milliseconds, frames every 40.
inline constexpr std::uint32_t camera_ring_slots = 4;
inline constexpr std::uint32_t camera_ring_payload = 640 * 480;

class FrameRingWriter {
 public:
  // Lays the ring out in `memory`, which outlives the writer, as a new generation. False when `memory` is too small or not aligned to 64 bytes.
  bool open(std::span<std::byte> memory, std::uint32_t slots = camera_ring_slots, std::uint32_t payload_bytes = camera_ring_payload);
  bool is_open() const { return header_ != nullptr; }

  // Hands a record over. False, and nothing written, when it is larger than a slot's payload. `now_ns` is the writer's CLOCK_MONOTONIC.
  bool write(const RecordInfo& info, std::span<const std::byte> payload, std::int64_t now_ns);
  // Says that the writer lives, without a record.
  void beat(std::int64_t now_ns);

 private:
  // The layout as it was made: the memory's own numbers may be changed by the other side, these cannot.
  std::uint32_t slot_count_ = 0, payload_bytes_ = 0;
  RingHeader* header_ = nullptr;
  std::byte* slots_ = nullptr;
};

class FrameRingReader {
 public:
  enum class Answer : std::uint8_t {
    record,       // `info` and `payload` are a whole record
    empty,        // nothing new
    no_ring,      // nobody has laid a ring out here yet, or its file cannot be read: it is shorter than it was
    other_layout  // another version, or sizes that do not fit the memory
  };

  struct Stats {
    std::uint64_t records = 0;
    std::uint64_t missed = 0;     // overwritten before they were read
    std::uint64_t torn = 0;       // overwritten, or cut off with the end of the file, while they were read; among the missed
    std::uint32_t malformed = 0;  // records whose header makes no sense
    std::uint32_t restarts = 0;   // of the writer
  };

  // `memory` outlives the reader. Whether there is a ring in it is seen at each take(): the writer may come later. Records from before are passed over.
  explicit FrameRingReader(std::span<const std::byte> memory = {});
  // The ring in `bytes` of `file` from `offset` on; `file` is open and outlives the reader. Nothing that others do to the file ends the process.
  FrameRingReader(const SharedFile& file, std::size_t offset, std::size_t bytes) : file_(&file), offset_(offset), bytes_(bytes) {}

  // Copies the oldest record not read yet into `payload`, which has room for the ring's payload_bytes; at most its size is copied. Never blocks.
  Answer take(RecordInfo& info, std::span<std::byte> payload);
  // The writer's CLOCK_MONOTONIC when it last gave a sign of life; 0 before.
  std::int64_t writer_beat_ns() const;
  const Stats& stats() const { return stats_; }

 private:
  // The header's numbers, read once and checked: the other side may change them at any time.
  struct Head {
    std::uint64_t magic = 0;
    std::uint32_t version = 0, slot_bytes = 0, slots = 0, payload_bytes = 0;
    std::uint64_t generation = 0, published = 0;
  };
  static_assert(sizeof(Head) == offsetof(RingHeader, writer_beat_ns));

  // False when the file does not reach so far.
  bool load(void* to, std::size_t from, std::size_t bytes) const;
  // `record` when there is a head; `empty` when it changed in all readings.
  Answer load_head(Head& head) const;
  Answer attach(Head& head);
  // Copies record `number` out. False when it is not there, or no longer.
  bool copy_record(std::uint64_t number, const Head& head, RecordInfo& info, std::span<std::byte> payload) const;

  const std::byte* memory_ = nullptr;  // or the file
  const SharedFile* file_ = nullptr;
  std::size_t offset_ = 0, bytes_ = 0;
  std::uint64_t generation_ = 0;
  std::uint64_t next_ = 0;  // number of the record to be read
  Stats stats_;
};

}  // namespace lf
