// What is asked of and written to each node at boot, as tables in the order of the bus. docs/canopen.md explains the rows.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/canopen/boot_step.hpp"
#include "firmware/canopen/setup.hpp"

namespace lf::canopen {

// The node a table is run for; `drive` is null for the output node.
struct BootContext {
  const NetworkConfig* config = nullptr;
  const DriveSetup* drive = nullptr;
  std::uint8_t node = 0;
  std::uint32_t rated_torque_unm = 0;  // of the drive, once it is known
};

// The rows for this node, one after the other. A drive's profile adds its own behind the identity, and may send a number to another object.
std::size_t boot_step_count(const BootContext& context);
BootStep boot_step(std::size_t i, const BootContext& context);

// The row's number for this node; nothing when the configuration leaves the object alone and the row is skipped.
std::optional<std::uint32_t> boot_value(const BootStep& step, const BootContext& context);

}  // namespace lf::canopen
