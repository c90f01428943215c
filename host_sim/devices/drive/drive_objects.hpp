// The objects of a servo drive's profile (CiA 402-2), with the defaults this motor has.
//
// Units: positions in counts, velocities in counts/s, accelerations in counts/s^2, torques in thousandths of the rated torque 6076 (mNm at the motor).
// Beyond the profile: 2080 torque at which a homing run takes a stop for hard (thousandths), 2081 winding temperature (0.1 degrees),
// 2082 part of the over-current guard used up (percent). The list is that of shared/can/can_map.yaml.
#pragma once

#include <vector>

#include "host_sim/devices/canopen/object_dictionary.hpp"
#include "host_sim/devices/devices_config.hpp"
#include "shared/can/object_tables.hpp"

namespace lf::devices {

inline constexpr std::int64_t mode_profile_position = 1, mode_profile_velocity = 3, mode_homing = 6, mode_cyclic_position = 8;

// A figure of the CAN map, as this drive has it.
std::int64_t figure_of(can_map::Figure figure, const DriveConfig& config);

// All of them, 1000 to 6502.
std::vector<Object> drive_objects(const DriveConfig& config);

// The ones the drive works with at every step, found once.
struct DriveObjects {
  explicit DriveObjects(ObjectDictionary& objects);

  Object &abort_option, &error_code, &controlword, &statusword;
  Object &quick_stop_option, &shutdown_option, &disable_option, &halt_option, &fault_option;
  Object &mode, &mode_display, &position_demand, &position_actual_internal, &position_actual;
  Object &following_window, &following_time_ms, &position_window, &position_time_ms;
  Object &velocity_actual, &velocity_demand, &max_torque, &torque_demand, &torque_actual, &current_actual;
  Object &target_position, &home_offset, &limit_low, &limit_high, &max_velocity;
  Object &profile_velocity, &profile_acceleration, &profile_deceleration, &quick_stop_deceleration;
  Object &homing_method, &homing_speed, &homing_threshold;
  Object &interpolation_time, &interpolation_exponent, &following_error, &target_velocity;
  Object &temperature, &overload;
};

}  // namespace lf::devices
