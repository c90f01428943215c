// The simulated camera: exposures in, frames out, and what can go wrong with a camera.
//
// An exposure is drawn once its shutter has closed, with the bodies as they stood at its middle. It is handed over `latency` after its start, or later when the
// shutter or the renderer take longer.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "hal/sim/exposure_under_way.hpp"
#include "hal/sim/sim_config.hpp"
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

  // Renderer and target outlive the camera. Of `timing` its latency, exposure delay and stamp offset count.
  ServedCamera(FrameRenderer& renderer, FrameTarget& target, const hal::SimConfig& timing)
      : renderer_(renderer),
        target_(target),
        latency_(timing.image_latency),
        exposure_delay_(timing.exposure_delay),
        stamp_offset_(timing.stamp_offset) {}

  void expose(const devices::Exposure& exposure) override;
  void step(Time t, Outputs outputs, const scene::BodyPoses& poses, const Pace& pace) override;
  void set_trouble(CameraTrouble trouble, Time until) override;

  const Stats& stats() const { return stats_; }

 private:
  void submit(const hal::ExposureUnderWay& exposure, const Pace& pace);
  void deliver(Picture& picture, Time clock);

  FrameRenderer& renderer_;
  FrameTarget& target_;
  Duration latency_, exposure_delay_, stamp_offset_;
  std::deque<hal::ExposureUnderWay> pending_;
  std::optional<Picture> next_;  // waits for its time
  std::vector<std::uint8_t> frozen_, last_pixels_;
  CameraTrouble trouble_ = CameraTrouble::none;
  Time trouble_end_;
  std::uint32_t sequence_ = 0;
  Stats stats_;
};

}  // namespace lf::serve
