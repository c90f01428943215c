// From exposed light to 8-bit pixels: gain, shot and read noise, clipping.
//
// Noise is counter-based: a pixel's deviate is a hash of (seed, camera, frame number, pixel), so it does not depend on the order of the work.
#pragma once

#include <cstdint>

#include "host_sim/optics/formation/normal_deviates.hpp"
#include "host_sim/optics/lanes.hpp"
#include "host_sim/optics/optics.hpp"

namespace lf::optics {

class Sensor {
 public:
  // grey = gain * sensitivity * exposure * radiance; variance = (gain read_noise)^2 + gain grey / electrons_per_grey.
  explicit Sensor(const CameraConfig& camera);

  float grey_per_radiance() const { return grey_per_radiance_; }

  // One row: `grey` noise-free in, 8 bits out. `first` is the index of the row's first value in the frame; `key` picks the frame's noise.
  void expose(const float* grey, std::uint8_t* pixels, std::size_t count, std::uint32_t first, std::uint64_t key) const;

 private:
  void expose_packet(Lanes grey, std::uint8_t* pixels, std::uint32_t first, std::uint64_t key) const;

  float grey_per_radiance_, read_variance_, variance_per_grey_;
};

}  // namespace lf::optics
