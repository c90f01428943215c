// Plans how the arm moves the laser's stripe over the panel: from above to below, all joints at constant speed between run-up and run-out.
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
  double docking_shift_m = 0.020;           // either way on each axis: what `base_from_panel` may be wrong by
  double docking_turn_rad = 0.0349;         // either way about each axis
  double line_spacing_m = 0.0026;           // wanted between stripes, at `stripe_period`
  Duration stripe_period = Duration::from_ms(40);
};

enum class SweepOutcome : std::uint8_t {
  ok,
  top_unreachable,     // no pose inside the soft limits puts the stripe above the region
  bottom_unreachable,  // nor below it
  fan_too_narrow,      // the stripe is shorter than the region is wide
  bad_request,         // not a number, or an empty region
};

struct SweepPlan {
  SweepOutcome outcome = SweepOutcome::bad_request;
  std::array<double, arm_joint_count> start_rad{};
  std::array<double, arm_joint_count> end_rad{};
  std::array<double, arm_joint_count> speed_rad_s{};  // signed; 0 for joints at rest, else at or above the stiction
  Duration duration;                                  // start to end at that speed, without acceleration
};

// Soft limits are the URDF's joint limits less `soft_margin_rad`.
SweepPlan plan_sweep(const SweepRequest& request, const LaserCalibration& laser);

}  // namespace lf::scan
