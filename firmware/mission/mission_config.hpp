// What the mission is to do, and how fast: one plain struct, filled and checked by the hosted side.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/arm/collision.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::mission {

struct Task {
  enum class Kind : std::uint8_t { turn_valve, press_button };
  Kind kind = Kind::turn_valve;
  double to_rad = 0;        // turn_valve: the handle angle to reach, shared/geometry/pose.hpp's convention
  std::uint8_t button = 0;  // press_button: which of the layout's
  std::uint8_t valve = 0;   // turn_valve: which of the layout's
};

struct MissionConfig {
  static constexpr std::size_t max_tasks = 16;
  StaticVector<Task, max_tasks> tasks;

  PanelLayout layout;  // as surveyed; where it stands is for the core to find
  // What it may stand off its nominal place, until it was looked at; after that the look says how well it is known.
  arm::PanelDoubt docking{.shift_m = 0.020, .turn_rad = 0.0349};
  arm::VehicleShape vehicle;  // what the arm must not touch

  arm::JointVector park_rad = arm::planar_joints(0.0, 0.60, 1.90, 0.0);  // folded, clear of the panel at every docking error
  bool use_lamps = true;                                                 // for stills; sweeps are dark but for the laser
  bool camera_always_on = false;  // a frame every camera period even when nobody needs it, for the record

  // The camera: every tenth SYNC is 25 Hz. Of five frames one is taken without the laser, the background of the other four.
  std::uint32_t camera_syncs = 10;
  std::uint32_t frames_per_background = 5;
  // From the start of an exposure until its image has surely been received: exposure, readout and transfer take 30 to 60 ms.
  Duration image_due = Duration::from_ms(100);
  double sweep_speed_rad_s = 0.065;  // of the slowest joint that moves in a sweep: above the real joints' stiction of 0.06 rad/s
  double verify_band_m = 0.055;      // half height of the verification's sweep around the valve; never less than the handle needs

  double move_speed_fraction = 0.6;    // of the joints' own speed limits, in free motion
  double approach_distance_m = 0.080;  // pre-grasp and pre-press stand this far off along the panel's normal
  double approach_speed_m_s = 0.040;   // straight guarded motions
  double press_speed_m_s = 0.025;
  double press_overtravel_m = 0.006;   // beyond the button's nominal bottom before a press counts as missed
  double press_torque_nm = 7.0;        // rise of an arm joint's torque that says the button has bottomed: about 12 N at the cap
  double turn_speed_rad_s = 0.35;      // of the handle; above the wrist's stiction of 0.2 rad/s
  double valve_tolerance_rad = 0.035;  // 2 degrees: what the second look accepts without turning again
  std::uint32_t tries = 3;             // of a step whose row allows a retry, per task
};

}  // namespace lf::mission
