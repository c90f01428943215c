// A frame ring whose memory the other side writes as it likes, also while it is read: every answer is one of the four, and nothing outside of the memory is
// touched. Both ends are tried: the reader, the camera on top of it, and the writer.
#include "shared/frame_ring/frame_ring.hpp"

#include <new>

#include "hal/vehicle/ring_camera.hpp"
#include "shared/frame_ring/mapped_file.hpp"
#include "tests/fuzz/input.hpp"

namespace lf::fuzz {
namespace {

constexpr std::size_t pages = 3;
constexpr std::size_t file_bytes = pages * frame_ring_page;
constexpr std::uint32_t small_slots = 3, small_payload = 1000;

// What of the memory the other side changes: mostly the ring's header, or a record's.
void poke(Input& in, std::span<std::byte> memory) {
  const auto place = in.take<std::uint16_t>();
  const std::size_t slot = frame_ring_page + (place >> 4 & 3U) * 1152U;
  const std::size_t offset = (place & 1U) != 0 ? (place >> 1 & 7U) * 8U : slot + (place >> 1 & 7U) * 8U;
  const auto value = in.take<std::uint64_t>();
  if (offset + sizeof value <= memory.size()) std::memcpy(memory.data() + offset, &value, sizeof value);
}

void write_record(Input& in, FrameRingWriter& writer) {
  static const std::array<std::byte, 2 * small_payload> payload{};
  RecordInfo info;
  info.kind = in.byte() & 1U;
  info.width = in.take<std::int16_t>();
  info.height = in.take<std::int16_t>();
  info.stride = in.take<std::int16_t>();
  info.sequence = in.byte();
  (void)writer.write(info, std::span(payload).first(in.take<std::uint16_t>() % payload.size()), 7);
}

void check_record(const RecordInfo& info, std::span<const std::byte> payload) {
  unsigned sum = 0;
  for (std::size_t i = 0; i < payload.size() && i < info.bytes; ++i) sum += static_cast<unsigned>(payload[i]);
  expect(sum <= 255U * payload.size(), "a payload can be read");
}

void both_ends(Input& in, std::span<std::byte> memory) {
  FrameRingWriter writer;
  FrameRingReader reader(memory);
  if ((in.byte() & 1U) != 0) (void)writer.open(memory, small_slots, small_payload);
  std::array<std::byte, small_payload> payload{};
  RecordInfo info;
  while (!in.empty()) {
    const std::uint8_t what = in.byte();
    switch (what & 7U) {
      case 0: (void)writer.open(memory, in.byte() % 8U, in.take<std::uint16_t>()); break;
      case 1:
      case 2: write_record(in, writer); break;
      case 3:
      case 4: poke(in, memory); break;
      case 5: writer.beat(reader.writer_beat_ns()); break;
      default: {
        const auto room = std::span(payload).first(what >> 3U == 0 ? 0 : payload.size());
        if (reader.take(info, room) == FrameRingReader::Answer::record) check_record(info, room);
      }
    }
  }
  const FrameRingReader::Stats& stats = reader.stats();
  expect(stats.torn <= stats.missed, "what is torn is missed");
}

// The mapped memory is the same for all runs: cleared at each begin.
void camera_over_it(Input& in) {
  static MemoryFile file;
  static MappedFile mapped;
  if (!mapped.is_open()) expect(mapped.open(file.path(), file_bytes) == 0, "the file is mapped");
  std::memset(mapped.bytes().data(), 0, mapped.bytes().size());
  FrameRingWriter writer;
  (void)writer.open(mapped.bytes(), small_slots, small_payload);
  static hal::RingCamera camera({file.path(), file_bytes, 0});
  static const bool open = camera.open() == hal::port_ok;
  expect(open, "the camera opens");
  while (!in.empty()) {
    const std::uint8_t what = in.byte();
    if ((what & 3U) == 0) write_record(in, writer);
    if ((what & 3U) == 1) poke(in, mapped.bytes());
    Image image;
    if (camera.receive(image) != hal::port_ok) continue;
    expect(image.view.valid(), "an image that is given is one");
    unsigned sum = 0;
    for (std::int32_t v = 0; v < image.view.height; ++v) sum += image.view.at(image.view.width - 1, v);
    expect(sum <= 255U * 480U * 640U, "its pixels can be read");
  }
}

}  // namespace
}  // namespace lf::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lf::fuzz::Input in(data, size);
  const std::uint8_t which = in.byte();
  if ((which & 1U) != 0) {
    lf::fuzz::camera_over_it(in);
    return 0;
  }
  // Exactly so large, so that a byte beyond is found.
  const std::size_t bytes = (which & 2U) != 0 ? lf::fuzz::file_bytes : (which >> 2U) * 128U;
  auto* memory = static_cast<std::byte*>(::operator new (bytes, std::align_val_t{64}));
  std::memset(memory, 0, bytes);
  lf::fuzz::both_ends(in, {memory, bytes});
  ::operator delete (memory, std::align_val_t{64});
  return 0;
}
