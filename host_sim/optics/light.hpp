// What eight rays bring back.
#pragma once

#include "host_sim/optics/water.hpp"

namespace lf::optics {

// Radiance toward the camera. Bit i of `reached` says that light i could reach the lane, of `lit` that it does: lasers from bit 0, lamps from bit 16.
struct Light {
  LaneMask reached{}, lit{};
  LaneMask beside{};     // lanes that a skirt of a stripe falls on
  RgbLanes radiance{};   // direct, with what the water scatters by less than a pixel
  RgbLanes scattered{};  // what it scatters on the way to the camera, and will lay elsewhere: formation/forward_scatter.hpp
  RgbLanes albedo{};     // of the surfaces, by base() alone
  RgbLanes laser{};      // direct light of the lasers' lines alone, not in `radiance`: it has speckle
};

}  // namespace lf::optics
