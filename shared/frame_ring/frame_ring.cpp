#include "shared/frame_ring/frame_ring.hpp"

#include <algorithm>
#include <cstring>
#include <new>

namespace lf {

namespace {

constexpr std::size_t record_header_bytes = 128;
constexpr std::size_t word = sizeof(std::uint64_t);
constexpr std::uint32_t most_slots = 4096;
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

FrameRingReader::Answer FrameRingReader::attach(Layout& layout) {
  if (memory_.size() < frame_ring_page || !aligned(memory_.data())) return Answer::other_layout;
  const auto* header = reinterpret_cast<const RingHeader*>(memory_.data());
  if (header->magic.load(std::memory_order_acquire) != frame_ring_magic) return Answer::no_ring;
  const std::uint64_t slots = header->slots.load(), slot_bytes = header->slot_bytes.load(), payload = header->payload_bytes.load();
  const bool fits = header->version.load() == frame_ring_version && slots >= 2 && slots <= most_slots &&
                    payload + record_header_bytes <= slot_bytes && slot_bytes % record_header_bytes == 0 &&
                    frame_ring_page + slots * slot_bytes <= memory_.size();
  if (!fits) return Answer::other_layout;
  layout = {slots, slot_bytes};
  const std::uint64_t generation = header->generation.load();
  if (generation != generation_) {
    // What was written before this reader came is old news; what a new writer has written since it started is not.
    next_ = generation_ == 0 ? header->published.load(std::memory_order_acquire) : 0;
    if (generation_ != 0) ++stats_.restarts;
    generation_ = generation;
  }
  return Answer::record;
}

FrameRingReader::Answer FrameRingReader::take(RecordInfo& info, std::span<std::byte> payload) {
  Layout layout;
  if (const Answer answer = attach(layout); answer != Answer::record) return answer;
  const auto [slots, slot_bytes] = layout;
  const auto* header = reinterpret_cast<const RingHeader*>(memory_.data());
  for (std::uint64_t round = 0; round < slots; ++round) {
    const std::uint64_t published = header->published.load(std::memory_order_acquire);
    if (published <= next_) return Answer::empty;
    if (published - next_ > slots) {
      stats_.missed += published - slots - next_;
      next_ = published - slots;
    }
    const std::byte* place = memory_.data() + frame_ring_page + (next_ % slots) * slot_bytes;
    const auto* record = reinterpret_cast<const RecordHeader*>(place);
    const std::uint64_t whole = 2 * next_ + 2;
    const bool there = record->ticket.load(std::memory_order_acquire) == whole;
    RecordInfo read;
    if (there) {
      load_words(&read, reinterpret_cast<const std::byte*>(&record->info), sizeof read);
      const std::size_t bytes = std::min({std::size_t{read.bytes}, payload.size(), slot_bytes - record_header_bytes});
      load_words(payload.data(), place + record_header_bytes, bytes);
    }
    ++next_;
    if (!there || record->ticket.load(std::memory_order_acquire) != whole || header->generation.load() != generation_) {
      ++stats_.torn;
      ++stats_.missed;
      continue;
    }
    if (read.bytes > slot_bytes - record_header_bytes) {
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
  if (memory_.size() < frame_ring_page || !aligned(memory_.data())) return 0;
  const auto* header = reinterpret_cast<const RingHeader*>(memory_.data());
  return header->magic.load(std::memory_order_acquire) == frame_ring_magic ? header->writer_beat_ns.load(std::memory_order_relaxed) : 0;
}

}  // namespace lf
