// What the core knew of its joints, and the bus load, at 25 Hz; and joints.csv.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "firmware/safety/limits.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/observers/bus_observer.hpp"
#include "host_sim/record/joint_log.hpp"
#include "host_sim/record/report.hpp"

namespace lf::app {

// At which charts are sampled: 25 Hz.
inline constexpr std::uint32_t ticks_a_sample = 10;

class CurveObserver : public hal::SimObserver {
 public:
  // Files and bus outlive the observer.
  CurveObserver(RunFiles& files, const BusObserver& bus, const JointNames& joints);

  void on_telemetry(const Telemetry& telemetry) override;
  void finish();

  // Positions and torques of the joints, with `limits`; a gap where the core had none. And the load of the bus.
  std::vector<record::ReportChart> joint_charts(const safety::Limits& limits) const;
  record::ReportChart bus_chart() const;
  const std::vector<double>& times_s() const { return t_s_; }  // of the samples

 private:
  RunFiles& files_;
  const BusObserver& bus_;
  JointNames joints_;
  std::optional<record::JointLog> joint_log_;
  std::uint64_t bits_before_ = 0;
  std::uint32_t ticks_ = 0;
  std::vector<double> t_s_;
  PerJoint<std::vector<double>> target_rad_, actual_rad_, torque_nm_;
  std::vector<double> bus_load_percent_;
};

}  // namespace lf::app
