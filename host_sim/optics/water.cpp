#include "host_sim/optics/water.hpp"

namespace lf::optics {

Water::Water(const WaterConfig& config)
    : asymmetry(static_cast<float>(config.asymmetry)),
      halo_share(static_cast<float>(config.halo_share)),
      halo_rad(static_cast<float>(config.halo_rad)),
      ambient_w_m2(config.ambient_w_m2),
      water_w_m2_sr(config.water_w_m2_sr) {
  // Scattering hardly depends on the band (large particles): what red loses more it loses by absorption.
  for (std::size_t band = 0; band < 3; ++band) {
    attenuation_per_m[band] = static_cast<float>(config.attenuation_per_m) * config.attenuation_ratio[band];
    scattering_per_m[band] = static_cast<float>(config.attenuation_per_m * config.scattering_share);
  }
}

}  // namespace lf::optics
