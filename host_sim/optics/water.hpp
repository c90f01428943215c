// Light's way through the water: Beer-Lambert attenuation per band, forward scatter, and single scattering by large angles.
#pragma once

#include <array>

#include "host_sim/optics/formation/forward_scatter.hpp"
#include "host_sim/optics/lanes.hpp"
#include "host_sim/optics/optics.hpp"

namespace lf::optics {

using RgbLanes = std::array<Lanes, 3>;

class Water {
 public:
  explicit Water(const WaterConfig& config);

  // The share of a band that is left of a thin beam after `path_m`.
  Lanes transmission(std::size_t band, Lanes path_m) const { return exp(-attenuation_per_m[band] * path_m); }

  // The same of light that is as bright all round, a lamp's or a wide surface's: what is scattered forward is not lost to it.
  Lanes broad_transmission(std::size_t band, Lanes path_m) const {
    return exp((forward_share * scattering_per_m - attenuation_per_m[band]) * path_m);
  }

  // Light that scatters again and again: the kernel of one scattering K makes exp(b R K) of the direct light (Wells, 1977). K's core is no spread at all, so that
  // direct() is exactly the part that has none, and scattered() the rest, whose shape is taken to be K's. Both are over the light that has not scattered.
  Lanes direct(Lanes path_m) const { return exp(forward.core * depth(path_m)); }
  Lanes scattered(Lanes path_m) const {
    const Lanes d = depth(path_m);
    return (exp(forward_share * d) - exp(forward.core * d)) / (forward_share - forward.core);
  }

  // Scattered radiance per irradiance and metre of path, 1/(sr m), of light that turns by an angle with this cosine: two lobes after Henyey and Greenstein. With the
  // default's forward lobe 0.66, 0.83 and 0.94 of the light stay within 10, 20 and 45 degrees and 0.020 turns back; Petzold's mean has 0.67, 0.81, 0.93 and 0.018.
  Lanes scattering(Lanes cosine) const {
    return scattering_per_m * ((1.f - back_share) * lobe(asymmetry, cosine) + back_share * lobe(back_asymmetry, cosine));
  }

  bool scatters() const { return scattering_per_m > 0; }

  Rgb attenuation_per_m{};
  float scattering_per_m = 0;  // of every band
  ForwardScatter forward;
  float forward_share;  // of the light that scatters once
  float asymmetry, back_share;
  Rgb ambient_w_m2, water_w_m2_sr;

 private:
  static constexpr float back_asymmetry = -0.14f;
  static constexpr float most_depth = 20;  // optical: nothing is seen through more
  Lanes depth(Lanes path_m) const { return min(scattering_per_m * path_m, all_lanes(most_depth)); }
  static Lanes lobe(float g, Lanes cosine) {
    const Lanes base = max(1.f + g * g - 2.f * g * cosine, all_lanes(1e-4f));
    return (1.f - g * g) / (static_cast<float>(4 * pi) * base * sqrt(base));
  }
};

}  // namespace lf::optics
