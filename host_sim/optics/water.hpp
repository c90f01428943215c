// Light's way through the water: Beer-Lambert attenuation per band, and single scattering after Henyey and Greenstein.
#pragma once

#include <array>

#include "host_sim/optics/lanes.hpp"
#include "host_sim/optics/optics.hpp"

namespace lf::optics {

using RgbLanes = std::array<Lanes, 3>;

class Water {
 public:
  explicit Water(const WaterConfig& config);

  // The share of a band that is left after `path_m`.
  Lanes transmission(std::size_t band, Lanes path_m) const { return exp(-attenuation_per_m[band] * path_m); }
  float transmission(std::size_t band, float path_m) const { return std::exp(-attenuation_per_m[band] * path_m); }

  // Scattered radiance per irradiance and metre of path, 1/(sr m), of light that turns by an angle with this cosine.
  Lanes scattering(std::size_t band, Lanes cosine) const {
    const float g = asymmetry;
    const Lanes base = max(1.f + g * g - 2.f * g * cosine, all_lanes(1e-4f));
    return scattering_per_m[band] * (1.f - g * g) / (static_cast<float>(4 * pi) * base * sqrt(base));
  }

  // The power in the skirt that forward scattering lays round a line after `path_m`, per power that is left in the line itself.
  Lanes halo_power(std::size_t band, Lanes path_m) const { return halo_share * (exp(scattering_per_m[band] * path_m) - 1.f); }

  Rgb attenuation_per_m{}, scattering_per_m{};
  float asymmetry, halo_share, halo_rad;
  Rgb ambient_w_m2, water_w_m2_sr;
};

}  // namespace lf::optics
