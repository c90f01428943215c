// An exposure that the core has ordered, until its shutter has closed: the light that it gets and where the bodies are at its middle.
//
// One rule for the simulated platform and for the served camera: an ordered exposure is obeyed, and an output that switches meanwhile lights its share.
#pragma once

#include <cstdint>

#include "hal/sim/shutter.hpp"
#include "host_sim/devices/exposure.hpp"
#include "host_sim/optics/optics.hpp"
#include "shared/scene/scene.hpp"

namespace lf::hal {

class ExposureUnderWay {
 public:
  // `delay`: from the trigger until the shutter opens.
  ExposureUnderWay(const devices::Exposure& ordered, std::uint32_t sequence, Duration delay)
      : ordered_(ordered), sequence_(sequence), shutter_(ordered.start, delay, ordered.duration) {}

  // A step of the physics, with the outputs as they were in it and the bodies as they are at its end.
  void pass(Time begin, Time end, bool laser, bool lamps, const scene::BodyPoses& poses);

  bool closed(Time now) const { return shutter_.closed(now); }
  const devices::Exposure& ordered() const { return ordered_; }
  std::uint32_t sequence() const { return sequence_; }
  const scene::BodyPoses& poses() const { return poses_; }  // at its middle

  // What the optics make of it, once it is closed.
  optics::Shot shot() const;

 private:
  devices::Exposure ordered_;
  std::uint32_t sequence_;
  Shutter shutter_;
  scene::BodyPoses poses_;
  bool posed_ = false;
};

}  // namespace lf::hal
