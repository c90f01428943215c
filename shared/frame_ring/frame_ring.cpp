#include "shared/frame_ring/frame_ring.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>

namespace lf {

namespace {

constexpr std::size_t record_header_bytes = 128;
constexpr std::size_t word = sizeof(std::uint64_t);
constexpr std::uint32_t most_slots = 4096;
constexpr int most_head_readings = 8;  // a camera's writer changes its header every 40 ms, a reading takes a microsecond
static_assert(sizeof(RecordInfo) % word == 0);

std::size_t round_up(std::size_t bytes, std::size_t to) { return (bytes + to - 1) / to * to; }

std::size_t slot_size(std::uint32_t payload_bytes) { return round_up(record_header_bytes + payload_bytes, record_header_bytes); }

// Shared words are read and written whole, acquire and release, so that who has seen a word of a record has also seen the ticket before it.
void store_words(std::byte* to, const void* from, std::size_t bytes) {
  const auto* source = static_cast<const std::byte*>(from);
  for (std::size_t i = 0; i < bytes; i += word) {
    std::uint64_t value = 0;
    std::memcpy(&value, source + i, std::min(word, bytes - i));
    std::atomic_ref<std::uint64_t>(*reinterpret_cast<std::uint64_t*>(to + i)).store(value, std::memory_order_release);
  }
}

void load_words(void* to, const std::byte* from, std::size_t bytes) {
  auto* target = static_cast<std::byte*>(to);
  for (std::size_t i = 0; i < bytes; i += word) {
    auto* source = const_cast<std::uint64_t*>(reinterpret_cast<const std::uint64_t*>(from + i));
    const std::uint64_t value = std::atomic_ref<std::uint64_t>(*source).load(std::memory_order_acquire);
    std::memcpy(target + i, &value, std::min(word, bytes - i));
  }
}

// A ring that lies about its records counts up to the end, not over it.
void count(std::uint64_t& counter, std::uint64_t more) { counter += std::min(more, ~counter); }

bool aligned(const void* address) { return reinterpret_cast<std::uintptr_t>(address) % 64 == 0; }

}  // namespace

std::size_t frame_ring_bytes(std::uint32_t slots, std::uint32_t payload_bytes) {
  return round_up(frame_ring_page + slots * slot_size(payload_bytes), frame_ring_page);
}

bool FrameRingWriter::open(std::span<std::byte> memory, std::uint32_t slots, std::uint32_t payload_bytes) {
  header_ = nullptr;
  if (slots < 2 || slots > most_slots || !aligned(memory.data()) || memory.size() < frame_ring_bytes(slots, payload_bytes)) return false;
  // The memory's zeroes, or what another writer left there, are valid numbers of these types.
  auto* header = std::launder(reinterpret_cast<RingHeader*>(memory.data()));
  const std::uint64_t generation = header->magic.load() == frame_ring_magic ? header->generation.load() : 0;
  header->magic.store(0);
  header->version.store(frame_ring_version);
  header->slot_bytes.store(static_cast<std::uint32_t>(slot_size(payload_bytes)));
  header->slots.store(slots);
  header->payload_bytes.store(payload_bytes);
  header->published.store(0);
  slot_count_ = slots;
  payload_bytes_ = payload_bytes;
  header_ = header;
  slots_ = memory.data() + frame_ring_page;
  for (std::uint32_t i = 0; i < slots; ++i) {
    auto* record = reinterpret_cast<RecordHeader*>(slots_ + i * slot_size(payload_bytes));
    record->ticket.store(0);
  }
  header->generation.store(generation + 1);
  header->magic.store(frame_ring_magic, std::memory_order_release);
  return true;
}

bool FrameRingWriter::write(const RecordInfo& info, std::span<const std::byte> payload, std::int64_t now_ns) {
  if (header_ == nullptr || payload.size() > payload_bytes_) return false;
  const std::uint64_t number = header_->published.load(std::memory_order_relaxed);
  std::byte* place = slots_ + number % slot_count_ * slot_size(payload_bytes_);
  auto* record = reinterpret_cast<RecordHeader*>(place);
  RecordInfo written = info;
  written.written_ns = now_ns;
  written.bytes = static_cast<std::uint32_t>(payload.size());
  record->ticket.store(2 * number + 1, std::memory_order_release);
  store_words(reinterpret_cast<std::byte*>(&record->info), &written, sizeof written);
  store_words(place + record_header_bytes, payload.data(), payload.size());
  record->ticket.store(2 * number + 2, std::memory_order_release);
  header_->published.store(number + 1, std::memory_order_release);
  beat(now_ns);
  return true;
}

void FrameRingWriter::beat(std::int64_t now_ns) {
  if (header_ != nullptr) header_->writer_beat_ns.store(now_ns, std::memory_order_relaxed);
}

FrameRingReader::FrameRingReader(std::span<const std::byte> memory)
    : memory_(memory.data()), bytes_(aligned(memory.data()) ? memory.size() : 0) {}

bool FrameRingReader::load(void* to, std::size_t from, std::size_t bytes) const {
  if (file_ == nullptr) {
    load_words(to, memory_ + from, bytes);
    return true;
  }
  if (file_->read(to, offset_ + from, bytes) != 0) return false;
#ifndef __SANITIZE_THREAD__  // GCC refuses a fence there
  // The kernel has copied with this thread's loads. Later loads, the kernel's too, stay behind them.
  std::atomic_thread_fence(std::memory_order_acquire);
#endif
  return true;
}

FrameRingReader::Answer FrameRingReader::load_head(Head& head) const {
  if (!load(&head, 0, sizeof head)) return Answer::no_ring;
  // The kernel need not copy a number in one piece. One that two readings agree on was not being written.
  bool settled = file_ == nullptr;
  for (int again = 0; !settled && again < most_head_readings; ++again) {
    const Head before = head;
    if (!load(&head, 0, sizeof head)) return Answer::no_ring;
    settled = std::memcmp(&head, &before, sizeof head) == 0;
  }
  if (!settled) return Answer::empty;
  return head.magic == frame_ring_magic ? Answer::record : Answer::no_ring;
}

FrameRingReader::Answer FrameRingReader::attach(Head& head) {
  if (bytes_ < frame_ring_page) return Answer::other_layout;
  if (const Answer answer = load_head(head); answer != Answer::record) return answer;
  const std::uint64_t slots = head.slots, slot_bytes = head.slot_bytes, payload = head.payload_bytes;
  const bool fits = head.version == frame_ring_version && slots >= 2 && slots <= most_slots &&
                    payload + record_header_bytes <= slot_bytes && slot_bytes % record_header_bytes == 0 &&
                    frame_ring_page + slots * slot_bytes <= bytes_;
  if (!fits) return Answer::other_layout;
  if (head.generation != generation_) {
    // What was written before this reader came is old news; what a new writer has written since it started is not.
    next_ = generation_ == 0 ? head.published : 0;
    if (generation_ != 0) ++stats_.restarts;
    generation_ = head.generation;
  }
  // A file that was emptied has lost its generation, too: the writer that lays the ring out again counts from 1, as the first one did.
  if (head.published < next_) next_ = 0;
  return Answer::record;
}

bool FrameRingReader::copy_record(std::uint64_t number, const Head& head, RecordInfo& info, std::span<std::byte> payload) const {
  const std::size_t place = frame_ring_page + number % head.slots * head.slot_bytes;
  const std::uint64_t whole = 2 * number + 2;
  std::uint64_t ticket = 0, generation = 0;
  if (!load(&ticket, place + offsetof(RecordHeader, ticket), sizeof ticket) || ticket != whole) return false;
  if (!load(&info, place + offsetof(RecordHeader, info), sizeof info)) return false;
  const std::size_t bytes = std::min({std::size_t{info.bytes}, payload.size(), head.slot_bytes - record_header_bytes});
  if (!load(payload.data(), place + record_header_bytes, bytes)) return false;
  return load(&ticket, place + offsetof(RecordHeader, ticket), sizeof ticket) && ticket == whole &&
         load(&generation, offsetof(RingHeader, generation), sizeof generation) && generation == generation_;
}

FrameRingReader::Answer FrameRingReader::take(RecordInfo& info, std::span<std::byte> payload) {
  Head head;
  if (const Answer answer = attach(head); answer != Answer::record) return answer;
  if (head.published > next_ && head.published - next_ > head.slots) {
    count(stats_.missed, head.published - head.slots - next_);
    next_ = head.published - head.slots;
  }
  while (next_ < head.published) {
    RecordInfo read;
    if (!copy_record(next_++, head, read, payload)) {
      ++stats_.torn;
      count(stats_.missed, 1);
      continue;
    }
    if (read.bytes > head.slot_bytes - record_header_bytes) {
      ++stats_.malformed;
      continue;
    }
    ++stats_.records;
    info = read;
    return Answer::record;
  }
  return Answer::empty;
}

std::int64_t FrameRingReader::writer_beat_ns() const {
  std::uint64_t magic = 0;
  std::int64_t beat = 0;
  if (bytes_ < frame_ring_page || !load(&magic, offsetof(RingHeader, magic), sizeof magic) || magic != frame_ring_magic) return 0;
  return load(&beat, offsetof(RingHeader, writer_beat_ns), sizeof beat) ? beat : 0;
}

}  // namespace lf
