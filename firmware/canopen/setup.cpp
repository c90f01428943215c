#include "firmware/canopen/setup.hpp"

#include <algorithm>
#include <cstdint>

namespace lf::canopen {

const char* name(ConfigError error) {
  switch (error) {
    case ConfigError::none: return "none";
    case ConfigError::node_id: return "node id out of 1..126";
    case ConfigError::node_twice: return "node id used twice";
    case ConfigError::position_limits: return "minimum position not below maximum";
    case ConfigError::positions: return "positions over the joint's range do not fit 32 bits in the drive's units";
    case ConfigError::speed: return "maximum speed is zero";
    case ConfigError::torque: return "maximum torque is zero";
    case ConfigError::following: return "following error window is zero";
    case ConfigError::homing: return "homing without speed, acceleration or time-out";
    case ConfigError::profile: return "drive profile's scale is not positive, or its numbers do not fit 32 bits";
    case ConfigError::sync_period: return "SYNC period does not fit object 60C2, or is over 100 ms";
    case ConfigError::timeout: return "a time-out is not positive";
  }
  return "unknown";
}

bool interpolation_period(Duration period, std::uint8_t& value, std::int8_t& exponent) {
  constexpr std::int64_t ns_per_ms = 1'000'000;
  if (period.ns() > 0 && period.ns() % ns_per_ms == 0 && period.ns() / ns_per_ms <= 255) {
    value = static_cast<std::uint8_t>(period.ns() / ns_per_ms);
    exponent = -3;
    return true;
  }
  std::int64_t mantissa = period.ns();
  std::int8_t power = -9;
  if (mantissa <= 0) return false;
  while (mantissa % 10 == 0) {
    mantissa /= 10;
    ++power;
  }
  if (mantissa > 255) return false;
  value = static_cast<std::uint8_t>(mantissa);
  exponent = power;
  return true;
}

namespace {

// Node heartbeats come every 100 ms and are watched once a SYNC.
constexpr Duration longest_sync_period = Duration::from_ms(100);

// Targets beyond 32 bits would be held at their end, and the joint would stop short without a word.
bool positions_fit_32_bits(const DriveSetup& drive) {
  const auto fits = [&](std::int64_t counts) {
    const std::int64_t units = drive.profile.scale.position.times(counts + drive.encoder_zero_counts);
    return units > INT32_MIN && units <= INT32_MAX;  // the least number has no opposite, which a reversed drive needs
  };
  return fits(std::int64_t{drive.min_counts} - drive.drive_margin_counts) &&
         fits(std::int64_t{drive.max_counts} + drive.drive_margin_counts);
}

bool fits_32_bits(const DriveSetup& drive) {
  const DriveScale& scale = drive.profile.scale;
  return scale.speed.times(drive.max_speed_counts_s) <= UINT32_MAX && scale.acceleration.times(drive.quick_stop_counts_s2) <= UINT32_MAX &&
         scale.acceleration.times(drive.homing_accel_counts_s2) <= UINT32_MAX &&
         scale.position.times(drive.following_window_counts) <= UINT32_MAX;
}

ConfigError check_drive(const DriveSetup& drive) {
  if (drive.min_counts >= drive.max_counts) return ConfigError::position_limits;
  if (drive.max_speed_counts_s == 0) return ConfigError::speed;
  if (drive.max_torque_permille == 0) return ConfigError::torque;
  if (drive.following_window_counts == 0) return ConfigError::following;
  if (!drive.profile.scale.valid() || !fits_32_bits(drive)) return ConfigError::profile;
  if (!positions_fit_32_bits(drive)) return ConfigError::positions;
  // 35 and 37 take the present position and need no speed.
  const bool moves = drive.homing_method != 0 && drive.homing_method != 35 && drive.homing_method != 37;
  if (moves && (drive.homing_speed_counts_s == 0 || drive.homing_accel_counts_s2 == 0)) return ConfigError::homing;
  if (drive.homing_method != 0 && drive.homing_timeout <= Duration{}) return ConfigError::homing;
  return ConfigError::none;
}

std::uint8_t node_of(const NetworkConfig& config, std::size_t i) {
  return i < config.drives.size() ? config.drives[i].node : config.io.node;
}

}  // namespace

std::uint16_t DriveSetup::max_torque_of(std::uint32_t rated_torque_unm) const {
  if (described_torque_unm == 0 || rated_torque_unm == 0) return max_torque_permille;
  const std::uint64_t scaled = (std::uint64_t{max_torque_permille} * described_torque_unm + rated_torque_unm / 2) / rated_torque_unm;
  const std::uint64_t most = std::max<std::uint64_t>(1000, max_torque_permille);
  return static_cast<std::uint16_t>(std::clamp<std::uint64_t>(scaled, 1, most));
}

bool DriveSetup::is_other_motor(std::uint32_t rated_torque_unm) const {
  const std::uint64_t described = described_torque_unm, rated = rated_torque_unm;
  return described != 0 && (rated > same_motor_factor * described || described > same_motor_factor * rated);
}

ConfigError check(const NetworkConfig& config, std::size_t& offender) {
  std::uint8_t value = 0;
  std::int8_t exponent = 0;
  offender = config.drives.size();
  if (!interpolation_period(config.sync_period, value, exponent) || config.sync_period > longest_sync_period)
    return ConfigError::sync_period;
  const Duration shortest = config.sync_period;
  for (const Duration timeout : {config.sdo_timeout, config.boot_up_timeout, config.start_timeout, config.transition_timeout}) {
    if (timeout < shortest) return ConfigError::timeout;
  }
  for (std::size_t i = 0; i <= config.drives.size(); ++i) {
    offender = i;
    const std::uint8_t node = node_of(config, i);
    if (node < 1 || node >= can_map::master_node) return ConfigError::node_id;
    for (std::size_t other = 0; other < i; ++other) {
      if (node_of(config, other) == node) return ConfigError::node_twice;
    }
    if (i == config.drives.size()) break;
    if (const ConfigError error = check_drive(config.drives[i]); error != ConfigError::none) return error;
  }
  offender = config.drives.size();
  return ConfigError::none;
}

}  // namespace lf::canopen
