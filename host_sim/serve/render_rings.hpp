// Two rings in one file, so that poses are published in one place and pictures made in another: `lanternfish serve --renderer FILE` in a guest with one
// processor, `lanternfish render-frames ... FILE` on its host.
//
//   0                    ring of exposures with the bodies' poses, written by serve
//   exposure_ring_bytes  ring of pictures, written by the renderer
//
// In User Mode Linux the guest's FILE is /dev/mmapper, and the host's the one that was given with iomem=mmapper,/absolute/file: it has to be there, in its
// full size, before the guest starts, which is why render-frames is started first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "host_sim/serve/frame_renderer.hpp"
#include "shared/frame_ring/frame_ring.hpp"
#include "shared/frame_ring/mapped_file.hpp"

namespace lf::serve {

inline constexpr std::uint32_t kind_exposure =
    3;  // RecordInfo::kind of what follows here; 1 had twelve bodies, 2 no room for an arm of more than four joints

// base_from_body of each of `bodies` bodies: rotation column by column, then translation in metres. Doubles, so that the picture is the very one of a single process.
// Then the shares of the exposure during which laser and lamps are on, and the time of its middle, s. Its length and number are the record's.
struct ExposurePayload {
  std::array<double, 12 * scene::max_bodies> poses{};
  std::uint64_t bodies = 0;
  double laser = 0, lamps = 0, time_s = 0;
};
ExposurePayload pack(const optics::Shot& shot);  // of at most scene::max_bodies bodies
optics::Shot unpack(const RecordInfo& info, const ExposurePayload& payload);

inline constexpr std::uint32_t exposure_slots = 16;
std::size_t exposure_ring_bytes();
std::size_t render_rings_bytes();

// Throws InputError when the file cannot be mapped.
MappedFile map_render_rings(const std::string& file);

// Serve's side. The ring would hold many more exposures than may be under way: a renderer that has fallen behind once, and is then just fast enough, would
// deliver every later picture half a second late.
class RemoteRenderer : public FrameRenderer {
 public:
  explicit RemoteRenderer(const std::string& file);
  bool submit(const PictureOrder& order) override;
  bool take(Picture& picture) override;

 private:
  void forget_lost(std::int64_t start_ns);

  MappedFile file_;
  std::deque<RecordInfo> under_way_;  // oldest first
  FrameRingWriter exposures_;
  FrameRingReader pictures_;
};

// The renderer's side: makes pictures until `stop` says so. Returns how many.
struct RenderServer {
  std::uint64_t pictures = 0;
  std::uint64_t missed = 0;       // exposures that were overwritten before they were drawn
  std::vector<double> render_ms;  // of each picture
};
RenderServer render_frames(const optics::OpticsConfig& config, const std::string& file, bool (*stop)());

}  // namespace lf::serve
