// Pictures of a handle that no renderer of this project made: polygons drawn with OpenCV, shaded, blurred and made noisy by rules of their own.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/vision/pointer.hpp"

namespace lf::vision::test {

struct DrawnHandle {
  PanelLayout::Valve valve;
  CameraCalibration camera;
  Pose base_from_panel = PanelLayout{}.nominal_base_from_panel();
  double angle_rad = 0;
  bool painted = true;
  double bar_grey = 90, paint_grey = 150, background_grey = 110;
  double side_over_front = 1.5;  // how much brighter the bar's flanks are than its front
  double fall_off = 0.3;         // of the light from one end of the bar to the other
  double veil_grey = 20;         // the water's own light
  double blur_px = 1.5;
  double gamma = 1;  // of the sensor: grey = 255 (light / 255)^gamma
  double noise_grey = 2;
  // The bar is in the shade from here toward its unmarked end, this dark; 1 is no shade.
  double shade_edge_m = 0, shade = 1;
  std::uint32_t seed = 1;
};

struct GreyPicture {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  ImageView view() const { return {pixels.data(), width, height, width}; }
};

GreyPicture draw_handle(const DrawnHandle& scene);

// Points of the laser on the bar's top, in stripes 2.6 mm apart, brighter on the paint by `paint_over_bar`.
std::vector<CloudPoint> draw_bar_points(const DrawnHandle& scene, double paint_over_bar);

}  // namespace lf::vision::test
