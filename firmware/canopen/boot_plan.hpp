// What is asked of and written to each node at boot, as tables in the order of the bus. docs/canopen.md explains the rows.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/canopen/setup.hpp"

namespace lf::canopen {

enum class BootAction : std::uint8_t {
  check,           // read; must equal the value under the mask
  record,          // read; kept in the report
  write,           // write, read back, must be equal under the mask
  invalidate_pdo,  // read a PDO's COB-ID, set bit 31 if it is not, read back: the identifier must not change while the PDO is valid
  set_mode,        // write 6060, read 6061 until it follows
};

// Where a row's number comes from.
enum class BootValue : std::uint8_t {
  literal,
  nothing,
  vendor,
  product,
  emcy_cob_id,
  master_heartbeat,  // 1016: (node of the master << 16) | milliseconds
  node_heartbeat,
  sync_period_us,
  interpolation_value,
  interpolation_exponent,
  rpdo1_cob_id,
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
  bool optional = false;  // a node without the object (06020000, 06090011) is accepted
};

// The node a table is run for; `drive` is null for the output node.
struct BootContext {
  const NetworkConfig* config = nullptr;
  const DriveSetup* drive = nullptr;
  std::uint8_t node = 0;
};

std::span<const BootStep> drive_boot_plan();
std::span<const BootStep> io_boot_plan();

// The row's number for this node; nothing when the configuration leaves the object alone and the row is skipped.
std::optional<std::uint32_t> boot_value(const BootStep& step, const BootContext& context);

}  // namespace lf::canopen
