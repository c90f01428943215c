// One exposure that the output node triggered.
#pragma once

#include <cstdint>

#include "shared/messages/time.hpp"

namespace lf::devices {

struct Exposure {
  Time start;  // the SYNC's last bit
  Duration duration;
  std::uint8_t counter = 0;  // the trigger counter that asked for it
  bool laser = false;        // outputs as they are from `start` on
  bool lamps = false;
};

}  // namespace lf::devices
