// A picture of the robot at work for people: the mission's own scene, seen in colour by a diver's camera.
#pragma once

#include "host_sim/optics/optics.hpp"

namespace lf::optics {

struct OutsideView {
  Vec3 eye_m{-0.62, -1.25, -0.02};  // base frame: left of the robot and behind its arm
  Vec3 target_m{0.16, 0.0, 0.43};
  std::int32_t width = 1280, height = 720;
  double focal_px = 820;
  double sheet_gain =
      60;  // how much brighter the laser is than in the mission: its sheet must show in a picture that the stripe may overexpose

  // Of a panel whose origin is there (base frame): from farther off where that is farther than the default one.
  static OutsideView of_panel(const Vec3& panel_m);
};

// The mission's optics with one camera, that of the view (camera 0), in water that shows the laser's sheet and keeps some red. A picture, not a measurement.
OpticsConfig outside_view(const OpticsConfig& mission, const OutsideView& view);

}  // namespace lf::optics
