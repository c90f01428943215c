// Clouds of a panel as a laser sweep gives them, with a known truth.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/messages/panel_vision.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::vision::test {

struct PanelCloudScene {
  PanelLayout layout;
  Pose base_from_panel = PanelLayout{}.nominal_base_from_panel();
  double handle_angle_rad = 0.3;
  double noise_m = 0.0006;         // of each point along its ray
  double stripe_noise_m = 0.0002;  // shared by a stripe's points: the joints' error
  int stray_points = 60;           // anywhere above the plate
  std::uint32_t seed = 1;
};

// Stripes 2.6 mm apart across the panel, points about 2 mm apart along them, on plate, handle (top, and the flank toward the camera at the
// left), stem and buttons. Base frame.
std::vector<CloudPoint> panel_cloud(const PanelCloudScene& scene);

PlaneFit true_fit(const PanelCloudScene& scene);

}  // namespace lf::vision::test
