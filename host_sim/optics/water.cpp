#include "host_sim/optics/water.hpp"

namespace lf::optics {

Water::Water(const WaterConfig& config)
    : forward(config.forward),
      forward_share(config.forward.sum()),
      asymmetry(static_cast<float>(config.asymmetry)),
      back_share(static_cast<float>(config.back_share)),
      ambient_w_m2(config.ambient_w_m2),
      water_w_m2_sr(config.water_w_m2_sr) {
  const double sea = sea_scattering_per_m(config.attenuation_per_m);
  const double nominal = config.scattering_share < 0 ? sea : config.attenuation_per_m * config.scattering_share;
  const double scattering = std::min(nominal * config.scattering_ratio, config.attenuation_per_m);
  scattering_per_m = static_cast<float>(scattering);
  for (std::size_t band = 0; band < 3; ++band) {
    // Scattering hardly depends on the band (large particles): what red loses more it loses by absorption.
    attenuation_per_m[band] = std::max(static_cast<float>(config.attenuation_per_m) * config.attenuation_ratio[band], scattering_per_m);
    // The water's own light is scattered daylight: an absorber is dark.
    water_w_m2_sr[band] *= static_cast<float>(sea > 0 ? std::min(scattering / sea, 2.0) : 0.0);
  }
}

}  // namespace lf::optics
