// Makes the picture of an exposure, while the world goes on: on a thread of this process, or in another one (render_rings.hpp).
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "hal/sim/render_worker.hpp"
#include "host_sim/optics/optics.hpp"
#include "shared/frame_ring/frame_ring.hpp"
#include "shared/scene/scene.hpp"

namespace lf::serve {

// What is to be drawn. `info` is handed on with the picture.
struct PictureOrder {
  RecordInfo info;
  optics::Shot shot;
};

struct Picture {
  RecordInfo info;
  std::vector<std::uint8_t> pixels;
};

// Pictures that are being made or wait at most: the one after would be older than three camera periods when it comes, and so would all that follow it.
inline constexpr std::size_t most_pictures_under_way = 3;

class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;
  // False when it is too far behind to take another one.
  virtual bool submit(const PictureOrder& order) = 0;
  // Takes a finished picture, in the order of their orders; false when there is none. Never waits.
  virtual bool take(Picture& picture) = 0;
};

class ThreadRenderer : public FrameRenderer {
 public:
  // Throws what optics::Optics throws.
  explicit ThreadRenderer(const optics::OpticsConfig& config) : worker_(config) {}

  bool submit(const PictureOrder& order) override;
  bool take(Picture& picture) override;

 private:
  struct Waiting {
    RecordInfo info;
    hal::RenderWorker::Ticket ticket = 0;
  };
  hal::RenderWorker worker_;
  std::deque<Waiting> waiting_;
  optics::Frame frame_;
};

void fill_size(RecordInfo& info, const optics::Frame& frame);

}  // namespace lf::serve
