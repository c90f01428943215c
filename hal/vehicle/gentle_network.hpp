// The drives as a commissioning has them: all counts are allowed, since the zero is what is looked for, and a joint presses with little.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/vehicle/commissioning.hpp"

namespace lf::hal {

// What the joint may press with, thousandths of its rated torque.
std::uint16_t pressing_permille(const Commissioning::Config& config, std::size_t joint);

canopen::NetworkConfig gentle_network(const Commissioning::Config& config);

}  // namespace lf::hal
