#include "hal/vehicle/commissioning.hpp"

namespace lf::hal {

const char* name(Commissioning::State state) {
  switch (state) {
    case Commissioning::State::rubbing: return "finding its friction";
    case Commissioning::State::booting: return "booting";
    case Commissioning::State::enabling: return "powering up";
    case Commissioning::State::seeking: return "moving to its stop";
    case Commissioning::State::easing: return "easing off its stop";
    case Commissioning::State::backing_off: return "moving back";
    case Commissioning::State::releasing: return "powering off";
    case Commissioning::State::halting: return "stopping";
    case Commissioning::State::powering_off: return "losing power";
    case Commissioning::State::stopping: return "ending";
    case Commissioning::State::done: return "done";
    case Commissioning::State::failed: return "failed";
  }
  return "unknown";
}

}  // namespace lf::hal
