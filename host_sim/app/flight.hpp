// A mission, on given sight if nothing else is asked for, in simulated time and on one thread: platform and core taking turns. What campaigns run whose matter is not seeing.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/core_loop.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"

namespace lf::app {

enum class Sight : std::uint8_t {
  given,     // vision answers with the true pose
  rendered,  // camera and vision see what is drawn
};

class Flight {
 public:
  // Nothing is ordered yet. `observer` outlives the flight. Throws InputError for a scenario that cannot be run.
  Flight(const scenario::Scenario& scenario, std::uint64_t seed, hal::SimObserver& observer, Sight sight = Sight::given);

  bool order(Command command) { return controller_->on_command(command, now_); }
  bool order(const mission::Order& order) { return controller_->on_order(order, now_); }
  // One control period.
  void step();

  Time now() const { return now_; }
  const mission::Mission& mission() const { return controller_->mission(); }
  mission::Step mission_step() const { return mission().step(); }
  // Of each fault, how often the core has reported it since power-on.
  const std::array<std::uint32_t, safety::fault_count>& fault_counts() const { return out_.telemetry.faults; }
  hal::SimPlatform& platform() { return *platform_; }
  // Of the panel's features.
  const PanelNames& panel_names() const { return names_; }
  std::size_t arm_joints() const { return error_texts_.names().arm_joints(); }
  // Of the joints' drives.
  const config::ErrorTexts& error_texts() const { return error_texts_; }
  // Of the joints, by their drives' best: what a stop may take.
  const PerJoint<double>& deceleration_rad_s2() const { return deceleration_rad_s2_; }
  // Every drive is the simulator's own, which keeps its deadline for process data.
  bool has_own_drives() const { return has_own_drives_; }
  // Of the joints, by which one may be off its motor: half of its gear's play, and the wind-up under the motor's rated torque.
  const PerJoint<double>& gear_gives_rad() const { return gear_gives_rad_; }
  const PerJoint<double>& slips_rad() const { return slips_rad_; }
  // Of each drive's position, for an encoder's count.
  const PerJoint<double>& units_per_count() const { return units_per_count_; }

 private:
  PerJoint<double> deceleration_rad_s2_{}, gear_gives_rad_{}, slips_rad_{}, units_per_count_{};
  bool has_own_drives_ = true;
  config::ErrorTexts error_texts_;
  PanelNames names_;
  std::unique_ptr<hal::SimPlatform> platform_;
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<ScanPipeline> pipeline_;
  std::unique_ptr<hal::CoreRings> rings_;
  TickOutput out_;
  Time now_;
};

}  // namespace lf::app
