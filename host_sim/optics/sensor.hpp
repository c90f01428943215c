// The camera's sensor: what its pixels make of the light, the noise of light and electronics, and the step to bytes. Terms as EMVA 1288 has them.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/optics/formation/normal_deviates.hpp"
#include "host_sim/optics/optics.hpp"
#include "shared/lanes/lanes.hpp"

namespace lf::optics {

// How one picture is exposed, against the camera's configuration.
struct Exposing {
  float light = 1;  // grey levels over those of the configured exposure and gain
  float gain = 1;   // over the configured one: noise goes with it
  std::uint64_t key = 0;
};

class Sensor {
 public:
  explicit Sensor(const CameraConfig& camera);

  // Grey levels for a radiance of 1 W/(m2 sr) at the configured exposure and gain.
  float grey_per_radiance() const { return grey_per_radiance_; }

  // Share of the light that comes to pixel (u, v) through the lens.
  float vignetting(int u, int v) const;

  // Turns row v into bytes: `grey` (channels interleaved, no noise, before vignetting) becomes pixels with the row's share of light, sensitivities, dark levels and noise.
  void expose(const float* grey, int v, const Exposing& exposing, std::uint8_t* pixels) const;

 private:
  // `deviate`: of the noise, in its standard deviations.
  void expose_packet(Lanes grey, Lanes dark, Lanes deviate, const Exposing& exposing, std::uint8_t* pixels) const;

  std::size_t row_size_;
  int width_, height_;
  double corner_loss_;
  float grey_per_radiance_, read_variance_, variance_per_grey_, row_noise_;
  std::vector<float> sensitivity_,
      dark_;  // of each pixel and channel; rows padded to packets. The light that goes into ghosts and stray light is taken off
};

}  // namespace lf::optics
