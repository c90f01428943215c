// One run, ready to start: what is true of it, and what the core is told of it. The core's side is made of the scenario and of the operator's choice to
// light the lamps; the rest of the sample is the truth and enters the simulator's side only.
#pragma once

#include "firmware/config.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/sim/sim_config.hpp"
#include "host_sim/scenario/draw.hpp"
#include "host_sim/scenario/scenario.hpp"

namespace lf::scenario {

// Shipped files that a run reads besides those that its keys name: what the core knows of the simulated joints' zeros, found as arm.urdf is, and the objects of
// the simulated makes of drive.
inline constexpr const char* homing_file = "homing/simulator.yaml";
inline constexpr const char* drive_objects_file = "drives/objects.csv";

// What the core is told: nominal calibrations, the survey of the panel, the job, drives and limits.
using Nominal = config::Core;

// Reads the arm's URDF and the file of limits. Throws InputError with every problem of these, a line each, and for a job that the machine as it is described cannot do: a valve or button
// out of the arm's reach, a panel that the camera does not see.
Nominal make_nominal(const Scenario& scenario, bool lamps_lit);

// Throws InputError with every problem for which a run would be refused, a line each: what make_nominal refuses, and drives that are not simulated.
void check_runnable(const Scenario& scenario);

// Adds what make_nominal would refuse.
void add_job_problems(const Scenario& scenario, std::vector<std::string>& problems);

// The world, the optics, the devices with the sample's errors in them.
hal::SimConfig make_truth(const Scenario& scenario, const Sample& sample, const Nominal& nominal, int render_threads);

// A scenario's fault as the simulated platform takes it, at the node that `drives` gives the joint. Throws InputError for a kind that there is not.
hal::SimFault sim_fault(const Fault& fault, const config::Drives& drives, const JointNames& joints);
// The same for the devices alone, which know of times but not of steps.
devices::DeviceFault device_fault(const Fault& fault, const config::Drives& drives, const JointNames& joints);

// Drives that are not served are overheard on the bus at the CAN map's nodes, in encoder counts and forward. Throws InputError for one of another kind.
void check_overheard(const config::Drives& drives, const JointNames& joints, std::size_t joint);

// base_from_panel with the sample's docking error: shifted along the base's axes, turned about them at the panel's origin (roll, then pitch, then yaw).
Pose true_base_from_panel(const PanelLayout& layout, const Sample& sample);

}  // namespace lf::scenario
