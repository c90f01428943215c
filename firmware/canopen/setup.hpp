// What the master is told before it boots the bus: plain numbers, filled by the hosted side and checked by `valid`.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/canopen/drive_profile.hpp"
#include "shared/can/can_map.hpp"
#include "shared/messages/capacity.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"

namespace lf::canopen {

// What 1018 must answer; 0 accepts any.
struct Identity {
  std::uint32_t vendor = 0;
  std::uint32_t product = 0;
};

// A motor that is larger or smaller by more than this factor is not the one that the arm was described with.
inline constexpr std::uint32_t same_motor_factor = 3;

// One CiA 402 drive. Every number is written at boot, in the drive's units, and read back; the object is named beside it.
struct DriveSetup {
  std::uint8_t node = 0;  // 1..126
  Identity identity;
  DriveProfile profile;

  std::int32_t min_counts = 0;  // what `Axis::set_target_counts` accepts
  std::int32_t max_counts = 0;  //
  std::int32_t drive_margin_counts =
      0;  // 607D lies so far outside of these: a drive enabled beyond its own limits jumps to them, or refuses
  std::uint16_t max_torque_permille = 1000;  // 6072, of `described_torque_unm`
  // The motor's rated torque by the arm's description. A drive whose own rating is another gets 6072 for the same torque, and one whose 6076 is more than
  // `same_motor_factor` times larger or smaller is not booted. 0: nothing is described, and 6072 is of the drive's own rating.
  std::uint32_t described_torque_unm = 0;
  std::uint32_t max_speed_counts_s = 0;       // 607F; the axis never lets its target go faster, see AxisLimits
  std::uint32_t max_motor_speed_rpm = 0;      // 6080, drives that have it; 0 leaves the drive's own
  std::uint32_t quick_stop_counts_s2 = 0;     // 6085; 0 leaves the drive's own
  std::uint32_t following_window_counts = 0;  // 6065; the axis never watches a wider one
  std::uint16_t following_timeout_ms = 100;   // 6066

  // 605A: 1, 2 stop and lose power; 5, 6 stop and stay powered. 2: on the quick-stop ramp, then off. With 6 the master takes the power (safety/power.hpp),
  // but a drive that lost its master keeps it.
  std::int16_t quick_stop_option = 2;
  std::int16_t abort_option = 3;  // 6007, the master is gone: 3 is a quick stop

  // What the drive counts, in the arm's counts and direction, where the arm's own count is 0; found at commissioning. The axis adds it to every target and
  // subtracts it from every reading.
  std::int32_t encoder_zero_counts = 0;
  // False for a joint that was never commissioned: `encoder_zero_counts` means nothing, and the axis takes no power. A drive that homes by itself
  // (`homing_method`) finds its zero under power, and needs none before.
  bool zero_known = true;

  std::int8_t homing_method = 0;  // 6098; 0: absolute encoder, nothing to home. 35, 37: here is home. Negative: the maker's, to a hard stop
  std::int32_t home_offset_counts = 0;       // 607C
  std::uint32_t homing_speed_counts_s = 0;   // 6099:01, toward the stop or switch; 6099:02 is a quarter of it
  std::uint32_t homing_accel_counts_s2 = 0;  // 609A
  Duration homing_timeout = Duration::from_ms(60'000);

  bool may_have_power() const { return zero_known || homing_method != 0; }
  // 6072 of a drive of this rated torque. Above its rating only where the set-up asks for it: not every drive has a reserve.
  std::uint16_t max_torque_of(std::uint32_t rated_torque_unm) const;
  bool is_other_motor(std::uint32_t rated_torque_unm) const;
};

// The CiA 401 output node.
struct IoSetup {
  std::uint8_t node = can_map::io_node;
  Identity identity;
};

struct NetworkConfig {
  StaticVector<DriveSetup, capacity::joints> drives;  // in the order of the joints
  IoSetup io;
  Duration sync_period = can_map::sync_period;             // 60C2 (and 1006): whole thousandths of 10^k s that fit one byte, see `valid`
  Duration sdo_timeout = Duration::from_ms(500);           // for each answer; servers on real drives take up to 100 ms while they store
  std::uint8_t retries = 2;                                // of a lost SDO transfer, a missing boot-up, a missing start
  Duration boot_up_timeout = Duration::from_ms(3'000);     // from the reset command to the boot-up message
  Duration start_timeout = Duration::from_ms(500);         // from the start command to a heartbeat that says operational: five heartbeats
  Duration transition_timeout = Duration::from_ms(2'000);  // a step of the CiA 402 state machine, with a brake's release
};

// Why a configuration is refused.
enum class ConfigError : std::uint8_t {
  none,
  node_id,
  node_twice,
  position_limits,
  positions,
  speed,
  torque,
  following,
  homing,
  profile,
  sync_period,
  timeout
};
const char* name(ConfigError error);

// First thing wrong with `config`. `drive` is set to the index of the offender (the number of drives: the output node or the network).
ConfigError check(const NetworkConfig& config, std::size_t& offender);

// 60C2: period = value * 10^exponent s, in milliseconds (exponent -3) where these fit: many drives take no other exponent. False when no byte and exponent
// give the period exactly.
bool interpolation_period(Duration period, std::uint8_t& value, std::int8_t& exponent);

}  // namespace lf::canopen
