#include "host_sim/devices/devices_config.hpp"

#include <cmath>
#include <set>

#include "host_sim/devices/drive/actuator.hpp"
#include "shared/arm/motor.hpp"
#include "shared/can/default_node.hpp"
#include "shared/can/object_tables.hpp"
#include "shared/input_error.hpp"

namespace lf::devices {
namespace {

void require(bool good, const DriveConfig& drive, const std::string& what) {
  if (!good) throw InputError("drive of node " + std::to_string(drive.node) + ": " + what);
}

void check_drive(const DriveConfig& drive) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  require(drive.node >= 1 && drive.node <= 126, drive, "node number outside 1 to 126");
  require(std::isfinite(drive.lower_rad) && std::isfinite(drive.upper_rad) && drive.lower_rad < drive.upper_rad, drive, "no stroke");
  require(positive(drive.rated_torque_nm) && drive.peak_torque_nm >= drive.rated_torque_nm, drive,
          "no rated torque, or one above the peak torque");
  require(drive.peak_torque_nm <= most_peak_of_rating * drive.rated_torque_nm, drive, "peak torque above 30 times the rated torque");
  const GearFriction& friction = drive.friction;
  require(
      std::isfinite(friction.coulomb_nm) && friction.coulomb_nm >= 0 && std::isfinite(friction.viscous_nm_s) && friction.viscous_nm_s >= 0,
      drive, "negative friction");
  require(
      positive(friction.efficiency) && friction.efficiency <= 1 && std::isfinite(friction.back_efficiency) && friction.back_efficiency <= 1,
      drive, "an efficiency above 1, or none");
  require(positive(drive.counts_per_rev), drive, "no counts in a revolution of the motor");
  require(positive(drive.max_velocity_rad_s) && positive(drive.max_acceleration_rad_s2), drive, "no top speed or acceleration");
  require(std::isfinite(drive.stiction_rad_s) && drive.stiction_rad_s >= 0 && drive.stiction_rad_s < drive.max_velocity_rad_s, drive,
          "stiction speed not below the top speed");
  require(std::isfinite(drive.encoder_offset_rad) && std::abs(drive.encoder_offset_rad) < 0.1, drive, "encoder offset above 0.1 rad");
  require(std::abs(static_cast<double>(drive.encoder_zero_counts)) < 1e9, drive, "encoder zero of more counts than 32 bits hold");
  const Actuator actuator(drive.actuator);
  const double sign = actuator.counts_per_rad(0.5 * (drive.lower_rad + drive.upper_rad));
  for (int i = 0; i <= 16; ++i) {
    const double q = drive.lower_rad + (drive.upper_rad - drive.lower_rad) * i / 16;
    const double slope = actuator.counts_per_rad(q);
    require(std::isfinite(slope) && std::abs(slope) > 1 && slope * sign > 0, drive, "the actuator does not reach over the whole stroke");
    require(std::abs(actuator.counts(q)) < 1e9, drive, "more counts than 32 bits hold");
  }
}

bool of_one_node(DeviceFaultKind kind) {
  using enum DeviceFaultKind;
  switch (kind) {
    case estop:
    case interlock_open:
    case drop_frames:
    case error_frames:
    case foreign_sync:
    case foreign_nmt:
    case foreign_reset:
    case foreign_heartbeat:
    case foreign_master: return false;
    default: return true;
  }
}

bool of_a_drive(DeviceFaultKind kind) {
  using enum DeviceFaultKind;
  switch (kind) {
    case overcurrent:
    case hot:
    case following:
    case stuck_encoder:
    case encoder_jump:
    case torque_frozen:
    case torque_high:
    case runaway: return true;
    default: return false;
  }
}

void check_fault(const DeviceFault& fault, const DevicesConfig& config) {
  if (!(fault.at_s >= 0) || !(fault.duration_s >= 0) || fault.at_s > 1e6 || fault.duration_s > 1e6) {
    throw InputError("a device fault's time is not within 0 to 1,000,000 s");
  }
  if (!of_one_node(fault.kind)) return;
  bool known = fault.kind == DeviceFaultKind::bus_off && fault.node == can_map::master_node;
  for (const DriveConfig& drive : config.drives) known = known || drive.node == fault.node;
  known = known || (fault.node == config.io.node && !of_a_drive(fault.kind));
  if (!known) throw InputError("a device fault names node " + std::to_string(fault.node) + ", which cannot have it");
}

}  // namespace

bool of_a_second_master(DeviceFaultKind kind) {
  using enum DeviceFaultKind;
  return kind == foreign_rpdo || kind == foreign_sdo || kind == foreign_sync || kind == foreign_nmt || kind == foreign_reset ||
         kind == foreign_heartbeat || kind == foreign_master;
}

bool of_the_bus(DeviceFaultKind kind) {
  using enum DeviceFaultKind;
  return kind == drop_frames || kind == error_frames || kind == bus_off || of_a_second_master(kind);
}

void set_motor(const ArmJoint& joint, double counts_per_rev, DriveConfig& drive) {
  const Motor motor = motor_of(joint, counts_per_rev);
  drive.counts_per_rev = counts_per_rev;
  drive.rated_torque_nm = motor.rated_torque_nm;
  drive.peak_torque_nm = motor.peak_torque_nm;
  drive.friction = {motor.coulomb_nm, motor.viscous_nm_s, joint.friction.efficiency, joint.friction.back_efficiency};
}

DriveConfig drive_config(const ArmJoint& joint, std::uint8_t node) {
  DriveConfig drive;
  drive.node = node;
  drive.name = std::string(can_map::servo_drive_title()) + ", " + joint.name;
  drive.actuator = joint.actuator;
  drive.lower_rad = joint.lower_rad;
  drive.upper_rad = joint.upper_rad;
  set_motor(joint, drive.counts_per_rev, drive);
  drive.max_velocity_rad_s = joint.velocity_rad_s;
  drive.max_acceleration_rad_s2 = joint.acceleration_rad_s2;
  drive.stiction_rad_s = joint.stiction_rad_s;
  return drive;
}

DevicesConfig devices_config(const ArmDescription& arm, const PerJoint<double>& joint_offsets_rad, std::uint64_t seed) {
  DevicesConfig config;
  config.seed = seed;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    config.drives.push_back(drive_config(arm.joints[i], can_map::default_node(i)));
    config.drives.back().encoder_offset_rad = joint_offsets_rad[i];
  }
  return config;
}

void check(const DevicesConfig& config) {
  std::set<int> nodes{config.io.node, can_map::master_node};
  if (nodes.size() != 2 || config.io.node == 0 || config.io.node > 126) throw InputError("output node: node number outside 1 to 126");
  for (const DriveConfig& drive : config.drives) {
    check_drive(drive);
    if (!nodes.insert(drive.node).second) throw InputError("node " + std::to_string(drive.node) + " stands twice on the bus");
  }
  for (const DeviceFault& fault : config.faults) check_fault(fault, config);
}

}  // namespace lf::devices
