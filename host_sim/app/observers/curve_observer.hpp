// What is shown over time: joints, valve and bus load, at 25 Hz, and joints.csv.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/observers/bus_observer.hpp"
#include "host_sim/record/joint_log.hpp"
#include "host_sim/record/report.hpp"

namespace lf::app {

class CurveObserver : public hal::SimObserver {
 public:
  // Both outlive the observer.
  CurveObserver(RunFiles& files, const BusObserver& bus);

  void on_step(Time, const world::World& world) override { world_ = &world; }
  void on_telemetry(const Telemetry& telemetry) override;
  void finish();

  std::vector<record::ReportChart> charts() const;

 private:
  RunFiles& files_;
  const BusObserver& bus_;
  std::optional<record::JointLog> joint_log_;
  const world::World* world_ = nullptr;
  std::uint64_t bits_before_ = 0;
  std::uint32_t ticks_ = 0;
  std::vector<double> t_s_;
  std::array<std::vector<double>, joint_count> target_rad_, actual_rad_, torque_nm_;
  std::vector<double> valve_deg_, bus_load_percent_;
};

}  // namespace lf::app
