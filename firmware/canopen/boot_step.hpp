// One row of a boot table: an object, what is done with it, and where its number comes from.
#pragma once

#include <cstdint>

namespace lf::canopen {

enum class BootAction : std::uint8_t {
  check,           // read; must equal the value under the mask
  record,          // read; kept in the report
  write,           // read; written when it differs under the mask, and then read back
  invalidate_pdo,  // read a PDO's COB-ID, set bit 31 if it is not, read back: the identifier must not change while the PDO is valid
  set_mode,        // write 6060, read 6061 until it follows
};

// Where a row's number comes from.
enum class BootValue : std::uint8_t {
  literal,
  nothing,
  vendor,
  product,
  rated_torque,
  emcy_cob_id,
  master_heartbeat,  // 1016: (node of the master << 16) | milliseconds
  node_heartbeat,
  guard_time,   // 100C, milliseconds
  life_factor,  // 100D
  sync_period_us,
  interpolation_value,
  interpolation_exponent,
  rpdo1_cob_id,
  process_data_deadline,  // 1400:05, milliseconds
  rpdo1_torque_offset,    // the third entry of RPDO1
  rpdo1_entries,
  tpdo1_cob_id,
  abort_option,
  quick_stop_option,
  quick_stop_deceleration,
  following_window,
  following_timeout,
  min_position,
  max_position,
  max_torque,
  max_speed,
  max_motor_speed,
  homing_method,
  homing_speed,
  homing_creep_speed,
  homing_acceleration,
  home_offset,
};

struct BootStep {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t width = 4;  // bytes of the object; 0: a string
  BootAction action = BootAction::write;
  BootValue value = BootValue::literal;
  std::uint32_t literal = 0;
  std::uint32_t mask = 0xFFFFFFFFu;
  bool optional = false;     // a node without the object (06020000, 06090011) is accepted
  bool best_effort = false;  // and one that refuses the value, or has another: nothing is built on it
};

}  // namespace lf::canopen
