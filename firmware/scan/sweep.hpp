// Plans how the arm moves the laser's stripe over the panel: from above to below, all joints at constant speed between run-up and run-out.
//
// Candidates start and end at shoulder angles of a grid, each with the elbow that puts the stripe just beyond the region for the whole docking
// error; shoulder and elbow move together in proportion. Joints do not move below their stiction, so a sweep lasts no longer than its joints' ways
// allow, and of all sweeps the one with the wanted density, or else the densest, is taken. For this arm that is nearly always the elbow alone, at the
// shoulder angle the fan's width permits: with the shoulder going along, its shorter way has to be over sooner.
#pragma once

#include <array>
#include <cstdint>

#include "shared/calibration/calibration.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::scan {

struct SweepRequest {
  Pose base_from_panel = Pose::Identity();  // nominal, or as found by an earlier scan
  double top_m = 0.222;                     // panel y from which ...
  double bottom_m = -0.378;                 // ... down to which the stripe has to pass
  double left_m = -0.400, right_m = 0.400;  // panel x
  double margin_m = 0.025;                  // beyond all four
  // The stripe falls on the panel at up to 31 degrees: what stands proud is passed at another time. Where the region reaches the valve, the circle
  // of the turning handle is covered at its own height.
  double handle_radius_m = 0.055;
  double handle_height_m = 0.107;
  double docking_shift_m = 0.020;    // either way along each of the base's axes: what `base_from_panel` may be wrong by
  double docking_turn_rad = 0.0349;  // either way about each of them, at the panel's origin
  double line_spacing_m = 0.0026;    // wanted between stripes
  Duration stripe_period = Duration::from_ms(40);
};

enum class SweepOutcome : std::uint8_t {
  ok,
  top_unreachable,     // no pose inside the soft limits puts the stripe above the region
  bottom_unreachable,  // nor below it
  fan_too_narrow,      // the stripe is shorter than the region is wide
  no_way,              // between the ends the tool comes too near to the panel, or the stripe turns back
  bad_request,         // not a number, or an empty region
};

struct SweepPlan {
  SweepOutcome outcome = SweepOutcome::bad_request;
  std::array<double, arm_joint_count> start_rad{};
  std::array<double, arm_joint_count> end_rad{};
  std::array<double, arm_joint_count> speed_rad_s{};  // signed; 0 for joints at rest, else at or above 0.065 rad/s
  Duration duration;                                  // start to end at that speed; run-up and run-out come on top
  double widest_spacing_m = 0;                        // between stripes on the region at `stripe_period`
};

// Start and end stay 0.05 rad and the run-up inside the URDF's limits.
// Some 300 kinematics, 50 us.
SweepPlan plan_sweep(const SweepRequest& request, const LaserCalibration& laser);

}  // namespace lf::scan
