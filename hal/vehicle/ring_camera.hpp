// A camera whose frames come through a shared frame ring (shared/frame_ring): the simulator's, on this machine or beyond a guest's border.
//
// The file is read, not mapped: whatever others do to it, the camera is silent at worst. A file that is shortened gives no frames until it has its size again
// and a writer has laid the ring out anew. One that is deleted or replaced stays the one that was opened.
//
// Frames carry the trigger counter that asked for them, so that they are matched with their exposures whatever the writer's clock says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/ports.hpp"
#include "shared/frame_ring/frame_ring.hpp"
#include "shared/frame_ring/shared_file.hpp"
#include "shared/messages/image.hpp"

namespace lf::hal {

class RingCamera {
 public:
  struct Config {
    std::string path;                                                              // a file, or a device such as /dev/mmapper
    std::size_t bytes = frame_ring_bytes(camera_ring_slots, camera_ring_payload);  // of the file; a multiple of the page size
    std::size_t offset = 0;                                                        // of the ring within it
  };

  explicit RingCamera(const Config& config) : config_(config) {}

  // 0, or errno: ESPIPE for a pipe or socket. A ring that nobody has laid out yet is no error: it is waited for.
  PortStatus open();
  // Takes one frame, oldest first; port_empty when there is none; EPROTO for a ring of another layout. Its pixels stay valid until the next call.
  PortStatus receive(Image& image);
  // Looks every millisecond until there is a frame or the instant `until` has come.
  void wait(Time until);

  const FrameRingReader::Stats& stats() const { return reader_.stats(); }
  std::uint64_t skipped() const { return skipped_; }  // gaps in the writer's sequence
  std::uint64_t broken() const { return broken_; }    // not an image of the camera's size

 private:
  Config config_;
  SharedFile file_;
  FrameRingReader reader_;
  std::vector<std::byte> pixels_ = std::vector<std::byte>(camera_ring_payload);
  RecordInfo info_;
  bool has_record_ = false;  // found by wait()
  bool any_ = false;
  std::uint32_t last_sequence_ = 0;
  std::uint64_t skipped_ = 0, broken_ = 0;
  FrameRingReader::Answer answer_ = FrameRingReader::Answer::no_ring;
};

}  // namespace lf::hal
