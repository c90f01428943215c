// What truly moved, at 25 Hz, for the report's charts and its 3D view. Nothing of it goes back into the core.
#pragma once

#include <array>
#include <vector>

#include "firmware/arm/kinematics.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/record/report.hpp"
#include "shared/arm/joint_names.hpp"

namespace lf::app {

class MotionObserver : public hal::SimObserver {
 public:
  // `arm`: as the core knows it.
  explicit MotionObserver(const arm::Arm& arm, const JointNames& joints = {}, const PanelNames& names = {})
      : arm_(arm), joints_(joints), names_(names) {}

  void on_step(Time, const world::World& world) override { world_ = &world; }
  void on_telemetry(const Telemetry& telemetry) override;

  // Speeds, tool, valve and contact.
  std::vector<record::ReportChart> charts() const;
  // `config` is that of the world it watched.
  record::ReportMotion motion(const world::WorldConfig& config) const;

 private:
  const world::World* world_ = nullptr;
  arm::Arm arm_;
  JointNames joints_;
  PanelNames names_;
  std::uint32_t ticks_ = 0;
  std::vector<double> t_s_;
  PerJoint<std::vector<double>> position_rad_, speed_rad_s_;
  std::array<std::vector<double>, 3> tool_mm_, asked_tool_mm_;
  std::vector<double> tool_error_mm_;
  std::vector<double> contact_n_, grip_n_;
  std::vector<std::vector<double>> valves_rad_, button_depth_m_;  // of each valve and button of the world
};

}  // namespace lf::app
