// The simulated camera: exposures in, frames out, and what can go wrong with a camera.
//
// An exposure is drawn with the bodies as they stand at its middle, and handed over `latency` after its start, or later when the renderer takes longer.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/devices/exposure.hpp"
#include "host_sim/serve/frame_renderer.hpp"
#include "host_sim/serve/frame_target.hpp"
#include "host_sim/serve/loop_camera.hpp"
#include "host_sim/serve/pace.hpp"

namespace lf::serve {

class ServedCamera : public LoopCamera {
 public:
  struct Stats {
    std::uint64_t exposures = 0, frames = 0;
    std::uint64_t not_rendered = 0;   // the renderer was too far behind
    std::uint64_t not_delivered = 0;  // the target could not take them
    std::uint64_t troubled = 0;       // dropped, frozen, repeated or away on purpose
    std::uint64_t late = 0;           // handed over more than 2 ms after their latency
    std::vector<double> latency_ms;   // from the start of the exposure to the frame's delivery
  };

  // Renderer and target outlive the camera.
  ServedCamera(FrameRenderer& renderer, FrameTarget& target, Duration latency) : renderer_(renderer), target_(target), latency_(latency) {}

  void expose(const devices::Exposure& exposure) override;
  void step(Time t, const scene::BodyPoses& poses, const Pace& pace) override;
  void set_trouble(CameraTrouble trouble, Time until) override;

  const Stats& stats() const { return stats_; }

 private:
  struct Pending {
    devices::Exposure exposure;
    std::uint32_t sequence = 0;
  };

  void submit(const Pending& pending, const scene::BodyPoses& poses, const Pace& pace);
  void deliver(Picture& picture, Time clock);

  FrameRenderer& renderer_;
  FrameTarget& target_;
  Duration latency_;
  std::deque<Pending> pending_;
  std::optional<Picture> next_;  // waits for its time
  std::vector<std::uint8_t> frozen_, last_pixels_;
  CameraTrouble trouble_ = CameraTrouble::none;
  Time trouble_end_;
  std::uint32_t sequence_ = 0;
  Stats stats_;
};

}  // namespace lf::serve
