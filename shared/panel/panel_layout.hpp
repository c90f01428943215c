// The panel as it was built and surveyed: a plate with valves, buttons and markers. Lengths in metres, in the panel frame: origin at the first valve's base on
// today's panel and wherever a panel file puts it, x to the robot's right, y up, z toward the robot.
//
// Valve and panel follow the observatories of the field (TRITON, PANDORA); no public source gives buttons: ours are our own.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "shared/geometry/pose.hpp"
#include "shared/messages/capacity.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf {

struct PanelLayout {
  // Of each kind. Names stay with whoever read the panel; here features are told by their places in these vectors.
  static constexpr std::size_t max_valves = capacity::valves, max_buttons = capacity::buttons, max_markers = capacity::markers;

  // The mark that tells one end of a bar from the other: without one a bar looks the same after half a turn. The end that points along the panel's y at
  // handle angle 0 is painted on all sides over `pointer_length_m`.
  enum class Pointer : std::uint8_t {
    none,
    light_end,  // white on a bar of a middle shade
    dark_end,   // black on a bar of a middle shade
  };

  // What carries a handle's bar.
  enum class Carried : std::uint8_t {
    by_stem,   // a T-bar, a fishtail or a paddle: in its middle
    by_posts,  // a D-handle: at its ends
  };

  // A bar on a stem or on posts. Its length and thickness: UWSim's handle mesh; its centre line stands 100 mm proud.
  struct Valve {
    Vec2 at_m{0, 0};  // its axis
    double handle_length_m = 0.0966;
    double handle_thickness_m = 0.0126;
    double handle_height_m = 0.100;
    Pointer pointer = Pointer::light_end;
    Carried carried = Carried::by_stem;
    float handle_depth_m = 0;         // along the valve's axis, of a flat bar; 0: as thick as it is
    double pointer_length_m = 0.030;  // a third of the bar: 8 px where the camera sees the bar foreshortened most
    // Between its stops the handle turns from `handle_min_rad`, clockwise, to `handle_max_rad`: +/-105 degrees, so that +/-90 is clear of them.
    double handle_min_rad = -1.8325957145940461;
    double handle_max_rad = 1.8325957145940461;
    double stem_radius_m = 0.004;  // thinner than the bar: pads that grip it 10 mm deep stay clear of the stem at 14 degrees of tilt

    double depth_m() const { return handle_depth_m > 0 ? static_cast<double>(handle_depth_m) : handle_thickness_m; }
    // Of the bar's front, and of the middle of a square bar with such a front: what a look takes for its height.
    double front_m() const { return handle_height_m + depth_m() / 2; }
    double seen_height_m() const { return handle_height_m + (depth_m() - handle_thickness_m) / 2; }
    bool has_pointer() const { return pointer != Pointer::none; }
    // From the axis to the farthest corner of the bar.
    double swept_radius_m() const { return std::hypot(handle_length_m, handle_thickness_m) / 2; }
    Vec3 handle_centre_m() const { return {at_m.x(), at_m.y(), handle_height_m}; }
  };

  struct Button {
    Vec2 at_m{0, 0};  // the cap's middle
    double width_m = 0.040;
    double height_m = 0.030;
    double stroke_m = 0.005;

    Vec3 face_m() const { return {at_m.x(), at_m.y(), height_m}; }  // its middle, at rest
  };

  // An AprilTag 36h11: a black square on a plate.
  struct Marker {
    std::int32_t id = 7;
    double size_m = 0.080;
    double plate_m = 0.100;
    double plate_thickness_m = 0.002;
    Vec2 centre_m{-0.170, 0.072};

    Pose panel_from_tag() const {
      Pose pose = Pose::Identity();
      pose.translation() = Vec3(centre_m.x(), centre_m.y(), plate_thickness_m);
      return pose;
    }
  };

  // Nominal place of the panel frame when docked: X 0.440, Z 0.592 in the base frame.
  double nominal_x_m = 0.440;
  double nominal_y_m = 0.0;
  double nominal_z_m = 0.592;

  // The plate, from its lower left to its upper right corner, as the robot sees it: Y +/-0.400 and Z 0.370..0.970 in the base frame.
  Vec2 plate_min_m{-0.400, -0.378};
  Vec2 plate_max_m{0.400, 0.222};
  double plate_thickness_m = 0.020;

  // The panel of the docked mission: a valve, three buttons (left, centre, right; base Z 0.451, 0.406, 0.451), and a marker beside the valve (base Y -0.170,
  // Z 0.520). At 64 and 137 mm the pressing tool came within 17.9 mm of the handle's tip at the worst of 10,000 docking errors; here it keeps 20.5 mm, at a
  // tilt of at most 18.4 degrees (`lanternfish reach`).
  StaticVector<Valve, max_valves> valves{Valve{}};
  StaticVector<Button, max_buttons> buttons{Button{.at_m{-0.067, 0.141}}, Button{.at_m{0.0, 0.186}}, Button{.at_m{0.067, 0.141}}};
  StaticVector<Marker, max_markers> markers{Marker{}};

  // base_from_panel when the vehicle is docked exactly.
  Pose nominal_base_from_panel() const {
    Pose base_from_panel = Pose::Identity();
    base_from_panel.linear().col(0) = Vec3(0, 1, 0);
    base_from_panel.linear().col(1) = Vec3(0, 0, -1);
    base_from_panel.linear().col(2) = Vec3(-1, 0, 0);
    base_from_panel.translation() = Vec3(nominal_x_m, nominal_y_m, nominal_z_m);
    return base_from_panel;
  }
};

}  // namespace lf
