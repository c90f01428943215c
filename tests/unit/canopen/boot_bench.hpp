// What the boot's tests share: a configuration in which every object is written.
#pragma once

#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::canopen::test {

inline constexpr std::size_t elbow = arm5e_joint::elbow;
inline constexpr std::size_t io = arm5e_joint::count;

inline NetworkConfig full_config() {
  NetworkConfig config = plain_config();
  config.sdo_timeout = Duration::from_ms(20);
  config.boot_up_timeout = Duration::from_ms(300);
  for (DriveSetup& drive : config.drives) drive.identity = {0x1234, 0x5678};
  config.drives[elbow].homing_method = -3;
  config.drives[elbow].homing_speed_counts_s = 402;
  config.drives[elbow].homing_accel_counts_s2 = 5000;
  config.drives[elbow].home_offset_counts = -77;
  config.drives[elbow].quick_stop_counts_s2 = 90'000;
  config.drives[elbow].max_motor_speed_rpm = 3000;
  return config;
}

}  // namespace lf::canopen::test
