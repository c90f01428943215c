// The machine, the place it works at and the job, as a user writes them down, and what the core is told of them. The same tables serve simulated runs
// and the vehicle. Every default is the initial value of its member; the unit is in the name; angles that a user thinks of are in degrees.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/config.hpp"
#include "firmware/mission/orders.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/config/error_texts.hpp"
#include "hal/config/key.hpp"
#include "hal/config/panel_survey.hpp"
#include "shared/can/can_map.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::config {

struct Camera {
  std::int64_t exposure_us = 2000;
  std::array<double, 3> position_m{0.015, -0.245, 0.060};  // in the arm's base frame
  double down_deg = 43.5;
  double right_deg = 20.75;
  double focal_px = CameraIntrinsics{}.fx;
  std::vector<double> distortion{-0.06, 0.02, 0.0005, -0.0005, 0.0};
};

struct Laser {
  double fan_half_angle_deg = 40.0;                       // 38.5 is needed at the worst docking error
  std::array<double, 3> position_m{-0.090, 0.0, -0.365};  // in the tool frame
  double turn_deg = 0;                                    // about the tool's axis; of an arm that can point
};

// What of the vehicle the arm could reach, in the arm's base frame: skid, frame, hulls, the camera with its strut, and two lamps. The simulator makes its vehicle of it,
// and lights it from `lamps_m`.
struct Vehicle {
  // [x, y, z, dx, dy, dz]: centre and extents along the base's axes.
  std::vector<std::array<double, 6>> boxes_m{{-0.11, 0.0, -0.102, 0.50, 0.424, 0.060},  // the arm's mounting plate and its rails
                                             {0.0, 0.0, -0.062, 0.116, 0.116, 0.020},   // the mount
                                             {-0.37, 0.0, -0.115, 0.70, 0.64, 0.040},   // skid and its tubes
                                             {-0.30, -0.30, -0.46, 0.03, 0.03, 0.75},   // the struts to the hulls
                                             {-0.30, 0.30, -0.46, 0.03, 0.03, 0.75}};
  // [x, y, z, x, y, z, radius]: the ends of its axis.
  std::vector<std::array<double, 7>> capsules_m{{-1.025, -0.35, -0.85, -0.075, -0.35, -0.85, 0.16},  // the hulls
                                                {-1.025, 0.35, -0.85, -0.075, 0.35, -0.85, 0.16},
                                                {-1.025, 0.0, -0.30, -0.175, 0.0, -0.30, 0.15},
                                                {-0.0731, -0.2784, -0.0294, 0.0069, -0.2481, 0.0518, 0.034},  // camera
                                                {-0.035, -0.205, -0.072, -0.035, -0.222, 0.010, 0.010},       // its strut
                                                {0.02, -0.62, 0.02, 0.02, -0.62, 0.02, 0.06},                 // lamps
                                                {0.02, 0.45, 0.02, 0.02, 0.45, 0.02, 0.06}};
  static constexpr std::size_t most_lamps = 8;
  std::vector<std::array<double, 3>> lamps_m{{0.02, -0.62, 0.02}, {0.02, 0.45, 0.02}};
};

// In simulation free motions were taken for contacts at 1.1, and at 3 they were not.
inline constexpr double fewest_counts_per_rev = 3;

// The drive of one joint. What is 0 or empty is as for all, see Drives.
struct JointDriveChoice {
  std::int64_t node = 0;
  std::string profile;
  std::string polarity = "forward";  // reversed: the drive counts against the joint
  std::string holding = "gear";      // what holds the joint without power: gear, brake, nothing
  double counts_per_rev = 0;
  double rated_torque_nm = 0;  // 0: as the drive or the arm's description says
  double rated_current_a = 0;
};

struct Drives {
  std::string profile = "lanternfish";  // a shipped one's name, or a file
  double counts_per_rev = 64;           // of the arm's counts in a revolution of the motor: a hall sensor's 16 lines
  double rated_current_a = 0;           // at the rated torque; 0: not stated
  PerJoint<JointDriveChoice> joints;
  std::int64_t output_node = can_map::io_node;
};

struct Machine {
  std::string file;       // where it was read; the files it names are looked for beside it, then among the shipped ones
  std::string told_also;  // the machine's file that it names; empty: none
  // Where a value comes from that messages speak of.
  std::string told_in() const { return told_also.empty() ? file : file + " with machine " + told_also; }
  PanelLayout panel;
  PanelSurvey survey;  // of the panel: where it was read, and what its features are called
  Camera camera;
  std::string camera_calibration;  // YAML of OpenCV or ROS that overrules `camera.focal_px` and `camera.distortion`; empty: none
  Laser laser;
  Vehicle vehicle;
  std::string arm_urdf = "arm/arm5e.urdf";
  std::vector<double> park_rad{0, 0.60, 1.90, 0};  // folded: slew, shoulder, elbow and roll
  JointNames joints;                               // of the same
  bool arm_told = false;                           // why that file cannot be read: nobody says it again
  arm::Arm arm = arm::arm5e();                     // of `arm_urdf`: whoever reads the file fills it in; make_core() reads it itself
  std::string safety_limits = "safety/limits.yaml";
  std::string mission_limits;          // a file of the same form, none of whose limits is wider; empty: `safety_limits` again
  std::string homing_file;             // of the joints' zeros; empty: none is known, and no joint takes power
  bool zeros_by_construction = false;  // without a homing file: the drives count as the arm does, as simulated ones do
  Drives drives;
  mission::MissionConfig mission;  // its speeds, distances and tries; layout, lamps and tasks are filled from the rest
  std::vector<Task> tasks{Task{}, Task{Task::Kind::press_buttons}};
  bool lamps_lit = true;
  bool camera_always_on = false;
};

// Parts of the tables, in the order of the documentation. The pointers are into the arguments.
void add_panel(Keys& all, std::string& file, DockedPanel& panel);
void add_tasks(Keys& all, std::vector<Task>& tasks, const PanelNames& names, const std::string& doc);
void add_valve_stops(Keys& all, ValveStops& valve);
void add_arm(Keys& all, std::string& urdf, std::vector<double>& park_rad);
void add_camera(Keys& all, Camera& camera);
void add_laser(Keys& all, Laser& laser);
void add_vehicle(Keys& all, Vehicle& vehicle);
void add_drives(Keys& all, Drives& drives, const JointNames& names);
void add_mission(Keys& all, mission::MissionConfig& mission);

// The drive of a joint with everything stated: its node, profile's name, and figures.
JointDriveChoice drive_of(const Drives& drives, std::size_t joint);

// What the core is told: nominal calibrations, the survey of the panel, the job, drives and limits; and what people are told of it.
struct Core {
  ControllerConfig controller;
  ScanConfig scan;
  ErrorTexts error_texts;          // of the joints' drives
  double hand_torque_nm = 0;       // most that the hand can turn with
  std::vector<std::string> notes;  // what is accepted and yet to be known, a sentence each
};

// Reads the arm's URDF, the file of limits and the camera's calibration. Throws InputError for these, and for a job that the machine as it is described
// cannot do: a valve or button out of the arm's reach, a panel that the camera does not see, more tasks than the core holds.
Core make_core(const Machine& machine);
// The same, but goes on after each problem and adds it to `problems`; what comes back is of use only when there is none.
Core make_core(const Machine& machine, std::vector<std::string>& problems);

// Where the camera is and looks for the file's angles: first to the right, then down.
Pose base_from_camera(const Camera& camera);

// As the core has them. Throws InputError, beginning with `where`, when there are more than it holds, or none, and for a valve or button that the panel has not.
mission::Tasks core_tasks(const std::vector<Task>& tasks, const PanelNames& names, const std::string& where);

}  // namespace lf::config
