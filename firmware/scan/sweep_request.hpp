// What is asked of a sweep of the laser over the panel, and the plan that answers.
#pragma once

#include <cstdint>

#include "shared/geometry/pose.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::scan {

struct SweepRequest {
  Pose base_from_panel = Pose::Identity();  // nominal, or as found by an earlier scan
  double top_m = 0.222;                     // panel y from which ...
  double bottom_m = -0.378;                 // ... down to which the stripe has to pass
  double left_m = -0.400, right_m = 0.400;  // panel x
  double margin_m = 0.025;                  // beyond all four
  // The stripe falls on the panel at up to 31 degrees: what stands proud is passed at another time. Where the region reaches a valve, the circle
  // of its turning handle is covered at its own height.
  struct Handle {
    Vec2 at_m{0, 0};
    double radius_m = 0.055;
    double height_m = 0.107;
  };
  StaticVector<Handle, PanelLayout::max_valves> handles;
  double proud_m = 0.107;            // what the panel carries stands up to this high: the hand keeps beyond it
  double docking_shift_m = 0.020;    // either way along each of the base's axes: what `base_from_panel` may be wrong by
  double docking_turn_rad = 0.0349;  // either way about each of them, at the panel's origin
  double line_spacing_m = 0.0026;    // wanted between stripes
  Duration stripe_period = Duration::from_ms(40);
  Vec3 camera_m{0, 0, 0};        // that watches the stripe, base frame: an arm that points keeps out of its view
  double slowest_rad_s = 0.065;  // of a joint that moves: below 0.06 rad/s the arm's real joints stick (ARM 5E, UJI's drivers)
};

enum class SweepOutcome : std::uint8_t {
  ok,
  top_unreachable,     // no pose inside the soft limits puts the stripe above the region
  bottom_unreachable,  // nor below it
  fan_too_narrow,      // the stripe is shorter than the region is wide
  no_way,              // between the ends the tool comes too near to the panel, or the stripe turns back
  bad_request,         // not a number, an empty region, or an arm that jobs are not planned for
};

struct SweepPlan {
  SweepOutcome outcome = SweepOutcome::bad_request;
  PerArmJoint<double> start_rad{};
  PerArmJoint<double> end_rad{};
  PerArmJoint<double> speed_rad_s{};  // signed; 0 for joints at rest, else at or above `slowest_rad_s`
  Duration duration;                  // start to end at that speed; run-up and run-out come on top
  double widest_spacing_m = 0;        // between stripes on the region at `stripe_period`
};

}  // namespace lf::scan
