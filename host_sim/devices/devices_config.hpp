// What the simulated CAN nodes are made of, and what goes wrong with them and when.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/devices/drive/drive_habits.hpp"
#include "host_sim/devices/drive/gear_train.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/can/can_map.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf::devices {

struct DictionaryRow;

// One servo drive and its motor. `drive_config` fills it from the arm's description.
struct DriveConfig {
  std::uint8_t node = 1;
  std::string name = "LF servo drive";  // object 1008
  ArmActuator actuator;
  double lower_rad = 0, upper_rad = 0;  // mechanical stroke: defaults of 607D and the limit of a homing run
  double peak_torque_nm = 0;            // of the motor, at its shaft; object 6072 at 6076's scale, as a default
  double rated_torque_nm = 0;           // of the motor, at its shaft; object 6076, in mNm
  GearFriction friction;                // between motor and joint
  double max_velocity_rad_s = 0;
  double max_acceleration_rad_s2 = 0;
  double stiction_rad_s = 0;      // asked of a joint that stands, it winds the motor up within Drive402::winding_s; less takes longer
  double encoder_offset_rad = 0;  // the encoder says motor angle + offset: an assembly error that nobody measures
  std::int32_t encoder_zero_counts = 0;  // what an absolute encoder counts where the motor stands at 0: commissioning finds it
  bool absolute_encoder = true;          // else the position reads 0 at power-on until homed
  double torque_noise_ratio = 0.004;     // 1 sigma of the torque reading over the rated torque: 12-bit current sensing
  double water_celsius = 12;
  double rise_at_rated_celsius = 30;  // of the winding in the long run at rated torque
  double trip_celsius = 85;

  // A make of drive with its own dictionary, units and habits; nullptr: the simulator's own. Both or neither.
  const DriveHabit* habit = nullptr;
  std::shared_ptr<const std::vector<DictionaryRow>> dictionary;
  DriveSwitches switches;
  std::uint32_t vendor = 0, product = 0;  // 1018; 0: the make's own
  double counts_per_rev = 64;             // of the motor's encoder
  double rated_current_a = 1.333;         // at the rated torque
  bool reversed = false;                  // it counts against the joint
};

// The motor's figures and its nominal friction, for an encoder with so many counts in a revolution of the motor.
void set_motor(const ArmJoint& joint, double counts_per_rev, DriveConfig& drive);

// From the URDF: the only source of the arm's geometry and of its joints' figures.
DriveConfig drive_config(const ArmJoint& joint, std::uint8_t node);

struct IoConfig {
  std::uint8_t node = can_map::io_node;
};

// What a drive's power stage does to its joint.
enum class DrivePower : std::uint8_t {
  off,        // nothing: the gear or the brake holds it
  operation,  // it follows its targets
  stopping,   // it brakes or holds by itself: quick stop active, fault reaction active
};

enum class DeviceFaultKind : std::uint8_t {
  overcurrent,     // EMCY 2310: as long as it lasts the drive cannot be reset
  hot,             // winding at 95 degrees: EMCY 4210
  following,       // the motor is jammed: velocity 0 whatever the loop asks; EMCY 8611 when the command moves on
  stuck_encoder,   // position reading frozen while the joint moves
  silent,          // the node's cable is cut: nothing in, nothing out. The drive's own heartbeat consumer notices too
  reboot,          // power dip: comes back with a boot-up message and its stored values
  estop,           // the emergency-stop chain is open
  interlock_open,  // the laser's interlock is open
  drop_frames,     // frames with the identifier `can_id` are lost on their way, to every receiver
  error_frames,    // one frame in sixteen is destroyed by an error frame and sent again
  bus_off,         // the node's CAN controller goes off the bus; afterwards EMCY 8140. `node` 0x7F is the master's

  encoder_jump,    // the position reads 0.25 rad too much
  torque_frozen,   // object 6077 keeps its value
  torque_high,     // 1.2 times the peak torque is added to the torque reading of a drive with power
  runaway,         // while enabled the joint moves at 1.5 times its top speed, and the drive's following-error window is gone
  wrong_identity,  // object 1018:02 names another product

  // A second master, with a controller of its own on the bus, sends every 50 ms, if not said otherwise:
  foreign_rpdo,       // the node's first RPDO: a drive's target, or the output node's laser
  foreign_sdo,        // an SDO upload request to the node
  foreign_sync,       // a SYNC
  foreign_nmt,        // NMT "enter pre-operational", to all nodes
  foreign_reset,      // NMT "reset communication", to all nodes: some drives keep their state through it
  foreign_heartbeat,  // a heartbeat with the master's own node number
  foreign_master,     // every SYNC period SYNC, the RPDO of each drive and a heartbeat, as a master that runs the arm
};

// Frames of a second master come from this controller on the simulated bus; the number stands for no node.
inline constexpr std::uint8_t second_master = 0x7D;
inline constexpr Duration second_master_period = Duration::from_ms(50);

// Whether the kind is the bus's, which whoever owns the bus makes.
bool of_the_bus(DeviceFaultKind kind);
bool of_a_second_master(DeviceFaultKind kind);

struct DeviceFault {
  double at_s = 0;
  DeviceFaultKind kind = DeviceFaultKind::silent;
  std::uint8_t node = 0;     // where the kind is a node's
  double duration_s = 0;     // 0 lasts for the rest of the run; `reboot` takes the boot time alone
  std::uint32_t can_id = 0;  // drop_frames only
};

struct DevicesConfig {
  std::vector<DriveConfig> drives;  // in the order of the joints
  IoConfig io;
  std::uint64_t seed = 1;
  Duration boot_time = Duration::from_ms(150);  // from power or NMT reset node to the boot-up message
  Duration reaction = Duration::from_us(30);    // from a frame's last bit to the node's answer queued
  std::vector<DeviceFault> faults;
};

// The drives of `arm`, at the nodes of the CAN map as far as it has any, then at those after them. Joint i reads `joint_offsets_rad[i]` too much.
DevicesConfig devices_config(const ArmDescription& arm, const PerJoint<double>& joint_offsets_rad, std::uint64_t seed);

// Throws InputError with what cannot be: see Devices.
void check(const DevicesConfig& config);

}  // namespace lf::devices
