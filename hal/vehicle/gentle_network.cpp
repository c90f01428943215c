#include "hal/vehicle/gentle_network.hpp"

#include <algorithm>
#include <limits>

namespace lf::hal {

namespace {

// Half of the range of counts, since the zero is what is not known yet, or what 32 bits hold in the drive's units. Two units are lost in rounding.
std::int32_t any_count(const canopen::DriveSetup& drive) {
  constexpr std::int32_t half = std::numeric_limits<std::int32_t>::max() / 2;
  const std::int64_t held = drive.profile.scale.position.over(std::numeric_limits<std::int32_t>::max()) - 2 - drive.drive_margin_counts;
  return static_cast<std::int32_t>(std::min<std::int64_t>(half, held));
}

}  // namespace

std::uint16_t pressing_permille(const Commissioning::Config& config, std::size_t joint) {
  return config.arm.joint(joint).actuator.counts_per_rad > 0 ? config.gear_permille : config.screw_permille;
}

canopen::NetworkConfig gentle_network(const Commissioning::Config& config) {
  canopen::NetworkConfig network = config.network;
  for (std::size_t i = 0; i < network.drives.size(); ++i) {
    canopen::DriveSetup& drive = network.drives[i];
    drive.encoder_zero_counts = 0;
    drive.zero_known = true;  // what is looked for: all counts here are the encoder's own, and wide open
    drive.min_counts = -any_count(drive);
    drive.max_counts = any_count(drive);
    drive.max_torque_permille = std::min(drive.max_torque_permille, pressing_permille(config, i));
    drive.homing_method = 0;
  }
  return network;
}

}  // namespace lf::hal
