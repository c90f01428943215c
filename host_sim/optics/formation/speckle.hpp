// Speckle of a laser's light on a rough surface, as a camera's pixels have it.
//
// The light of one pixel is the sum of a few grains of the lens's spot: a gamma distribution of mean 1. Pixels larger than a grain are independent of each other.
// The grains stay as they are while emitter, surface and camera do; they are new when the direction from which the light comes turns by the aperture's angle,
// which is a move of the emitter by `grain_move_m`. Between, they change as the two share them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/geometry/pose.hpp"

namespace lf::optics {

class Speckle {
 public:
  static constexpr double grain_move_m = 0.0007;  // an aperture of 0.77 mm looking at 0.75 m, an emitter at 0.7 m

  // `contrast`: standard deviation of one pixel's light over its mean, 0 to 0.5. `emitter_m`: where the light comes from, in the surface's frame.
  Speckle(double contrast, std::uint64_t key, const Vec3& emitter_m);

  // What the light of `count` pixels, numbered from `first` on, is multiplied by, into `out`: it has room for a multiple of eight.
  void factors(std::uint32_t first, std::size_t count, float* out) const;

 private:
  float mean_, slope_;  // of the gamma distribution's cube root (Wilson and Hilferty, 1931)
  std::array<std::uint64_t, 8> key_;
  std::array<float, 8> share_;
};

}  // namespace lf::optics
