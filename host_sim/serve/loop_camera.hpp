// What the served bus's loop needs of a camera: a mission's bus can be served without one, and without all that renders.
#pragma once

#include <cstdint>

#include "host_sim/devices/exposure.hpp"
#include "host_sim/serve/pace.hpp"
#include "shared/messages/time.hpp"
#include "shared/scene/scene.hpp"

namespace lf::serve {

enum class CameraTrouble : std::uint8_t {
  none,
  freeze,  // the picture stands still, while time stamps and counter go on
  drop,    // exposures are counted, frames do not come
  repeat,  // each frame comes twice
  away,    // unplugged
};

// As they light the scene: after the interlock.
struct Outputs {
  bool laser = false, lamps = false;
};

class LoopCamera {
 public:
  virtual ~LoopCamera() = default;
  // In the order of the exposures.
  virtual void expose(const devices::Exposure& exposure) = 0;
  // Once a step, at simulated time `t`, with the bodies as they are then and the outputs as they were in the step.
  virtual void step(Time t, Outputs outputs, const scene::BodyPoses& poses, const Pace& pace) = 0;
  // Until simulated time `until`.
  virtual void set_trouble(CameraTrouble trouble, Time until) = 0;
};

}  // namespace lf::serve
