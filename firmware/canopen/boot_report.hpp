// How far the bus is booted, and what stopped it.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/canopen/drive_profile.hpp"
#include "shared/messages/capacity.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf::canopen {

enum class BootState : std::uint8_t { idle, running, done, failed };

enum class BootFailure : std::uint8_t {
  none,
  configuration,    // NetworkConfig is not valid: nothing was sent
  no_boot_up,       // no boot-up message after NMT reset communication
  sdo_aborted,      // the node refused, `abort_code` says why
  sdo_timeout,      // no answer, after all retries
  wrong_identity,   // device type, vendor or product is not the expected one
  wrong_setting,    // an object that the profile checks holds another value: the drive is not set up as the profile says
  no_rating,        // 6076 is 0, and nothing else states the rated torque
  wrong_rating,     // 6076 and the stated rated torque differ by more than a tenth
  other_motor,      // 6076 and the rated torque of the arm's description differ by more than `same_motor_factor`
  read_only,        // the object holds another value than it must, and cannot be written
  wrong_readback,   // the object holds another value than was written
  wrong_length,     // the object's value has another length than the standard's
  rebooted,         // a boot-up message while being configured
  not_operational,  // no heartbeat said operational after NMT start
  no_process_data,  // operational, but no TPDO came
};
const char* name(BootFailure failure);

// An object that the drive does not have, and what takes its place.
struct Substitution {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  Substitute by = Substitute::none;
};

struct NodeBoot {
  BootState state = BootState::idle;
  BootFailure failure = BootFailure::none;
  std::uint8_t node = 0;
  std::uint16_t index = 0;  // object at work, or that failed; 0 outside the SDO part
  std::uint8_t sub = 0;
  std::uint8_t retries = 0;  // so far, all steps together
  std::uint16_t step = 0;    // of the node's boot table
  std::uint16_t steps = 0;
  std::uint32_t abort_code = 0;  // of `failure`, see sdo_abort::name
  std::uint32_t expected = 0;    // for wrong_identity, wrong_setting, wrong_rating, other_motor, read_only and wrong_readback
  std::uint32_t read = 0;
  std::uint32_t device_type = 0;       // 1000
  std::uint32_t vendor = 0;            // 1018:01
  std::uint32_t product = 0;           // 1018:02
  std::uint32_t rated_torque_unm = 0;  // micro newton metres: 6076 in its unit, or as the profile states it
  std::int16_t quick_stop_option = 0;  // 605A, as the drive took it
  std::array<char, 33> device_name{};  // 1008, zero-terminated, printable ASCII, cut at 32
  StaticVector<Substitution, DriveProfile::max_absences> substitutions;
};

struct BootReport {
  BootState state = BootState::idle;
  StaticVector<NodeBoot, capacity::nodes> nodes;  // the drives in the order of the joints, then the output node

  // The first node that failed; nullptr if none did.
  const NodeBoot* failed() const {
    for (const NodeBoot& node : nodes) {
      if (node.state == BootState::failed) return &node;
    }
    return nullptr;
  }
  // Its index; -1 if none did.
  std::int32_t first_failed() const { return failed() == nullptr ? -1 : static_cast<std::int32_t>(failed() - nodes.data()); }
};

}  // namespace lf::canopen
