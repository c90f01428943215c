// How much of a beam sea water scatters, and how far it lays the light that scatters once.
//
// The scattering that goes with an attenuation is a line through Petzold's three waters at 514 nm (clear ocean, coast, turbid harbour; Mobley, Ocean Optics Web
// Book). The kernel is that of single scattering at small angles (Wells, 1977: light that turns by theta at a share t of its way appears at t theta) with Petzold's
// mean phase function, as a mixture of Gaussians: its line spread is within 4 % from 3 to 180 mrad. A share of 0.024 turns back and is lost.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace lf::optics {

inline double sea_scattering_per_m(double attenuation_per_m) {
  return std::min(attenuation_per_m, std::max(0.03, 0.89 * (attenuation_per_m - 0.145)));
}

struct ScatterTerm {
  float weight = 0;
  float angle_rad = 0;  // standard deviation, seen from where the way ends
};

// Weights are shares of the light that scatters once.
struct ForwardScatter {
  float core = 0.136f;  // is not told from the direct light
  std::array<ScatterTerm, 4> terms{{{0.199f, 0.0055f}, {0.248f, 0.022f}, {0.275f, 0.088f}, {0.118f, 0.354f}}};

  constexpr float sum() const {
    float sum = core;
    for (const ScatterTerm& term : terms) sum += term.weight;
    return sum;
  }

  // Water with another phase function: each weight, the core's first, times its `ratio`, and all of them to the same sum as before. As much light turns back.
  constexpr ForwardScatter varied(const std::array<double, 5>& ratio) const {
    ForwardScatter other = *this;
    other.core *= static_cast<float>(ratio[0]);
    for (std::size_t i = 0; i < terms.size(); ++i) other.terms[i].weight *= static_cast<float>(ratio[i + 1]);
    const float scale = sum() / other.sum();
    other.core *= scale;
    for (ScatterTerm& term : other.terms) term.weight *= scale;
    return other;
  }
};

}  // namespace lf::optics
