// A world with the shipped arm at the nominal docking, and scripted drives, for the tests of host_sim/world.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "host_sim/world/world.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/scene/panel_scene.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::world {

inline WorldConfig nominal_config() {
  WorldConfig config;
  config.arm = load_arm_urdf(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  config.scene = scene::make_scene(config.arm, config.layout);
  config.base_from_panel = config.layout.nominal_base_from_panel();
  return config;
}

using Targets = PerJoint<double>;

// Drives that move to their targets at up to `speed_rad_s`, proportionally within 10 ms of them.
struct Script {
  World& world;
  PerJoint<double> torque_limit_nm{80, 100, 80, 12, 10};
  Targets targets_rad;
  PerJoint<double> speed_rad_s{0.2, 0.15, 0.2, 0.4, 0.4};

  Script(World& of, const Targets& start_rad) : world(of), targets_rad(start_rad) {}

  void step() {
    const JointReadings readings = world.readings();
    JointDrives drives;
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      const double wanted = (targets_rad[i] - readings[i].motor_position_rad) / 0.010;
      drives[i] = {std::clamp(wanted, -speed_rad_s[i], speed_rad_s[i]), torque_limit_nm[i], false};
    }
    world.set_drives(drives);
    world.step();
  }

  void run(double seconds) {
    const double end_s = world.time_s() + seconds;
    while (world.time_s() < end_s) step();
  }
};

}  // namespace lf::world
