// The panel as it was built and surveyed. Lengths in metres, in the panel frame: origin at the valve's base, z toward the robot.
//
// Valve and panel follow the observatories of the field (TRITON, PANDORA); no public source gives buttons: ours are our own.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/geometry/pose.hpp"

namespace lf {

struct PanelLayout {
  static constexpr std::size_t button_count = 3;

  // Nominal place of the panel frame when docked: X 0.440, Z 0.592 in the base frame.
  double nominal_x_m = 0.440;
  double nominal_y_m = 0.0;
  double nominal_z_m = 0.592;

  // The plate, from its lower left to its upper right corner, as the robot sees it: Y +/-0.400 and Z 0.370..0.970 in the base frame.
  Vec2 plate_min_m{-0.400, -0.378};
  Vec2 plate_max_m{0.400, 0.222};
  double plate_thickness_m = 0.020;

  // The T-bar: length and thickness of UWSim's handle mesh; its centre line stands 100 mm proud on a stem.
  double handle_length_m = 0.0966;
  double handle_thickness_m = 0.0126;
  double handle_height_m = 0.100;
  // The mark that tells one end of the bar from the other: without one a bar looks the same after half a turn. The end that points along the panel's y at
  // handle angle 0 is painted on all sides over `pointer_length_m`.
  enum class Pointer : std::uint8_t {
    none,
    light_end,  // white on a bar of a middle shade
    dark_end,   // black on a bar of a middle shade
  };
  Pointer pointer = Pointer::light_end;
  double pointer_length_m = 0.030;  // a third of the bar: 8 px where the camera sees the bar foreshortened most
  // Between its stops the handle turns from `handle_min_rad`, clockwise, to `handle_max_rad`: +/-105 degrees, so that +/-90 is clear of them.
  double handle_min_rad = -1.8325957145940461;
  double handle_max_rad = 1.8325957145940461;
  double stem_radius_m = 0.004;  // thinner than the bar: pads that grip it 10 mm deep stay clear of the stem at 14 degrees of tilt

  // Left, centre, right; centres of the caps in panel x and y (base Z 0.451, 0.406, 0.451). At 64 and 137 mm the pressing tool came within 17.9 mm of
  // the handle's tip at the worst of 10,000 docking errors; here it keeps 20.5 mm, at a tilt of at most 18.4 degrees (`lanternfish reach`).
  std::array<Vec2, button_count> buttons_m{Vec2{-0.067, 0.141}, Vec2{0.0, 0.186}, Vec2{0.067, 0.141}};
  double button_width_m = 0.040;
  double button_height_m = 0.030;
  double button_stroke_m = 0.005;

  // 36h11 beside the valve: 80 mm black square on a 100 mm plate (base Y -0.170, Z 0.520).
  std::int32_t marker_id = 7;
  double marker_size_m = 0.080;
  double marker_plate_m = 0.100;
  double marker_plate_thickness_m = 0.002;
  Vec2 marker_centre_m{-0.170, 0.072};

  // base_from_panel when the vehicle is docked exactly.
  Pose nominal_base_from_panel() const {
    Pose base_from_panel = Pose::Identity();
    base_from_panel.linear().col(0) = Vec3(0, 1, 0);
    base_from_panel.linear().col(1) = Vec3(0, 0, -1);
    base_from_panel.linear().col(2) = Vec3(-1, 0, 0);
    base_from_panel.translation() = Vec3(nominal_x_m, nominal_y_m, nominal_z_m);
    return base_from_panel;
  }

  Pose panel_from_tag() const {
    Pose panel_from_tag = Pose::Identity();
    panel_from_tag.translation() = Vec3(marker_centre_m.x(), marker_centre_m.y(), marker_plate_thickness_m);
    return panel_from_tag;
  }
};

}  // namespace lf
