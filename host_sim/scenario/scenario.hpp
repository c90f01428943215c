// What a run is made of, as its YAML file says: the place, the water, the machine's errors, the job, and what goes wrong.
//
// Every default is the initial value of its member, here or in the struct it comes from, and nowhere else; keys.hpp gives each its path, unit, range
// and words. Members that a run draws at random are a Spread or a Chance; draw() turns them into a Sample. The unit is in the name; angles that a user
// thinks of are in degrees.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/mission/mission_config.hpp"
#include "hal/config/machine.hpp"
#include "hal/config/panel_survey.hpp"
#include "host_sim/devices/devices_config.hpp"
#include "host_sim/optics/optics.hpp"
#include "host_sim/world/world.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::scenario {

struct SceneFile;

using config::Chance;
using config::Fault;
using config::Spread;
using config::Task;

// How far the panel stands from its nominal place once the vehicle is docked: shifted along the base's axes, turned about them at the valve's base.
struct Docking {
  Spread x_m = Spread::around(0, 0.020);  // toward the panel
  Spread y_m = Spread::around(0, 0.020);  // right
  Spread z_m = Spread::around(0, 0.020);  // down
  Spread roll_deg = Spread::around(0, 2);
  Spread pitch_deg = Spread::around(0, 2);
  Spread yaw_deg = Spread::around(0, 2);
};

struct Valve : config::ValveStops {
  Spread start_deg = Spread::around(0, 40);
  Spread friction_nm{0.5, 3};
  std::vector<double> detents_deg{-90, 0, 90};  // the named positions: shut, half, open
  double detent_nm = world::ValveConfig{}.detent_nm;
  double viscous_nm_s = world::ValveConfig{}.viscous_nm_s;
};

// All three are alike, but for those that are broken.
struct Buttons : world::ButtonConfig {
  std::vector<std::string> stuck;    // by name
  std::vector<std::string> missing;  // gone, cap and all
};

struct Water {
  Spread attenuation_per_m{0.1, 0.8};  // of green light, absorption and scattering together
  double scattering_share = optics::WaterConfig{}.scattering_share;
  Spread scattering_percent = Spread::around(0, 30);  // of what scatters of that attenuation
  Spread phase_percent = Spread::around(0, 30);       // of each share of the phase function, before they are brought to their sum
  double asymmetry = optics::WaterConfig{}.asymmetry;
  Spread particles_per_l{0.1, 3};
  double ambient = 1.0;  // daylight over the default's
};

struct Lamps {
  Chance lit = Chance::either;  // whether the mission uses the lamps
  double power = 1.0;           // over the default's
};

struct Camera : config::Camera {
  bool always_on = false;  // a frame every camera period, needed or not
  Spread noise_grey{1, 3};
  double blur_px = optics::CameraConfig{}.blur_px;
  Spread corner_blur{1.3, 2.0};
  Spread electrons_per_grey{20, 80};     // at gain 1: wells of 5,000 to 20,000 electrons; the core takes it for 40
  Spread exposure_jitter{0.002, 0.007};  // of two frames' ratio 0.3 to 1 %
  Spread ghost_share{1e-4, 1.6e-3};      // from a port to an uncoated filter
  Spread ghost_px{6, 17};                // 2 t tan(angle): a filter of 1 mm that is tilted by 1 to 3 degrees, pixels of 6 um
};

struct Laser : config::Laser {
  double power_w = optics::LaserConfig{}.power_w;
  double waist_sigma_m = optics::LaserConfig{}.waist_sigma_m;
  Spread speckle{0.13, 0.25};                   // from a diode to a DPSS laser
  Spread waist_at_m = Spread::around(0, 0.18);  // 30 % of the range to the panel
  Spread lobe_share{0.01, 0.03};
  Spread lobe_sigmas{2, 3};
  Chance lobe_ahead = Chance::either;  // on which side
  Spread fan_low_percent{0, 15};       // of the power, slowly along the line
  Spread fan_fine_percent{0, 5};       // and in fine structure
};

// Assembly errors that nobody measured: between the machine as it is and as its calibration says. Drawn for each axis and joint on its own.
struct Mounting {
  Spread camera_m = Spread::around(0, 0.0002);
  Spread camera_deg = Spread::around(0, 0.05);
  Spread laser_m = Spread::around(0, 0.0002);
  Spread laser_deg = Spread::around(0, 0.05);
  Spread joints_deg = Spread::around(0, 0.05);
  Spread marker_m = Spread::around(0, 0.0002);
  Spread marker_deg = Spread::around(0, 0.05);
};

// The machine as it is, against the calibration that the core has of it: what a good calibration leaves. Drawn once a run.
struct Calibration {
  Spread principal_point_px = Spread::around(0, 0.3);
  Spread focal_percent = Spread::around(0, 0.05);
  Spread distortion_px = Spread::around(0, 0.3);  // at the picture's corners, each of three terms: some 0.1 px rms over the picture
  Spread lens_percent = Spread::around(0, 20);    // of the spot's width
  Spread laser_cone_mrad = Spread::around(0, 5);  // the line's bow: 0.1 % of its length
  Spread beam_percent = Spread::around(0, 20);    // of the line's width
  Spread buttons_m = Spread::around(0, 0.0005);
  Spread exposure_delay_ms{0, 0.5};
  Spread stamp_ms = Spread::around(0, 0.2);
  Spread handle_m = Spread::around(0, 0.0005);
  Spread button_size_m = Spread::around(0, 0.0005);
  Spread marker_size_m = Spread::around(0, 0.0002);
  Spread marker_flat_m = Spread::around(0, 0.0002);
};

struct Arm {
  std::string urdf = config::Machine().arm_urdf;
  std::vector<double> park_rad = config::Machine().park_rad;
};

struct Jaw {
  double torque_nm = 0;     // 0: as the URDF says
  double pad_friction = 0;  // 0: as the URDF says
};

struct Physics {
  Physics();  // those of world::WorldConfig and devices::DriveConfig
  double restitution = 0;
  double joint_drag_nm_s = 0;
  double drag_coefficient = 0;
  double torque_noise_ratio = 0;
  double water_celsius = 0;
  bool stops_from_demand = false;  // what no maker's document says
};

// The machine's true friction between motors and joints, over what the arm's description says and the core takes for it. Drawn for each joint on its own.
struct Friction {
  Spread coulomb = Spread::around(1, 0.15);
  Spread viscous = Spread::around(1, 0.15);
  Spread efficiency = Spread::around(1, 0.03);
  Spread back_efficiency = Spread::around(1, 0.03);
  // What the core does not know of at all.
  Spread breakaway = Spread::around(1.3, 0.2);  // greased screws: 1.1 to 1.5
  Spread one_way = Spread::around(0, 0.1);
  Spread pivot_m = Spread::around(0, 5e-5);  // bores and bolts of H7/g6 at 10 mm, and the survey of their places
};

struct Latency {
  Latency();  // those of hal::SimConfig
  double image_ms = 0;
  double panel_vision_ms = 0;
};

struct Sensors {
  std::int64_t seed = 0;
};

struct Safety {
  std::string limits = "safety/limits.yaml";
  std::string mission_limits;  // of the same form, none wider
};

// How the mission is to end, where that is not success: a scenario that makes a fault passes when the mission fails safely because of it.
struct Expect {
  static constexpr const char* nothing = "none";
  std::string failure = nothing;  // a fault's name
};

// The simulated motors' rating, for makes that count in current.
inline config::Drives simulated_drives() {
  config::Drives drives;
  drives.rated_current_a = 1.333;
  return drives;
}

struct Scenario {
  std::string name;  // of the file, without its ending
  std::string file;  // where it was read
  std::string description;
  double time_limit_s = 400;
  std::string machine;                       // a file of what the robot is; empty: as the keys of its groups say
  std::string scene;                         // a file of what else stands about; empty: nothing
  std::shared_ptr<const SceneFile> objects;  // what it says; null where there is none
  std::string panel_file;                    // what is on the panel; empty: as the next says
  config::DockedPanel docked_panel;
  PanelLayout panel;           // made of these; what the core is told
  config::PanelSurvey survey;  // of the panel
  Docking docking;
  Valve valve;
  Buttons buttons;
  Water water;
  Lamps lamps;
  Camera camera;
  Laser laser;
  Mounting mounting;
  Calibration calibration;
  config::Vehicle vehicle;
  Arm arm;
  arm::Arm told_arm = arm::arm5e();  // of arm.urdf, read with the file; what cannot be read is told with the job's problems
  JointNames joints;                 // of the same
  bool arm_told = false;             // as a machine has it
  Jaw jaw;
  Physics physics;
  Friction friction;
  Latency latency;
  Sensors sensors;
  Safety safety;
  config::Drives drives = simulated_drives();
  mission::MissionConfig mission;  // its speeds, distances and tries; layout, lamps and tasks are filled from the rest
  std::vector<Task> tasks{Task{}, Task{Task::Kind::press_buttons}};
  std::vector<Fault> faults;
  Expect expect;
};

// Reads a file, or a shipped scenario by its name, then applies `overrides` ("path.to.key=value", the value in YAML) in their order.
// Throws InputError with every problem, a line each, "file:line: ..." or "--set key=value: ...": a missing or malformed file, an unknown, misspelt or
// repeated key (with the nearest known one), a value of another type, out of its range or not a finite number, and values that do not go together.
Scenario load_scenario(const std::string& file_or_name, const std::vector<std::string>& overrides = {});

struct ShippedScenario {
  std::string name;
  std::string description;
  std::string file;
};

// Those in the share folder, by name.
std::vector<ShippedScenario> shipped_scenarios();

// What the valves are in simulation, as the panel's layout has them: of the docked mission's panel as the keys of `valve` say.
std::vector<config::ValveNature> valve_natures(const Scenario& scenario);

// What the checks of a panel and its tasks look at.
config::Machine work_of(const Scenario& scenario);

}  // namespace lf::scenario
