// The panel as a user writes it down: the docked mission's one, key by key, or a file of its own (panel_file.hpp); and how a message names what stands there.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/config/spread.hpp"
#include "shared/panel/panel_layout.hpp"
#include "shared/panel/panel_names.hpp"

namespace lf::config {

// Where the valve's handle can be.
struct ValveStops {
  double stop_min_deg = -105;  // +/-90 is clear of the stops
  double stop_max_deg = 105;
};

// The docked mission's panel: one valve at the panel's origin, three buttons that are alike, one marker. Defaults are those of PanelLayout.
struct DockedPanel {
  DockedPanel();
  double nominal_x_m = 0, nominal_y_m = 0, nominal_z_m = 0;
  Vec2 plate_min_m{0, 0}, plate_max_m{0, 0};
  double handle_length_m = 0, handle_thickness_m = 0, handle_height_m = 0;
  PanelLayout::Pointer pointer{};
  double pointer_length_m = 0;
  std::array<Vec2, 3> buttons_m{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
  double button_width_m = 0, button_height_m = 0, button_stroke_m = 0;
  std::int32_t marker_id = 0;
  double marker_size_m = 0, marker_plate_m = 0;
  Vec2 marker_centre_m{0, 0};
};

PanelLayout layout_of(const DockedPanel& panel, const ValveStops& stops);

// What a valve of a panel file is besides its place: what it takes to turn it, and how it stands and feels in simulation.
struct ValveNature {
  double torque_nm = 3;  // most that it takes, as its maker says
  Spread friction_nm{0.5, 3};
  Spread start_deg{-40, 40};
  std::vector<double> detents_deg{-90, 0, 90};
  double detent_nm = 0.3;
  double viscous_nm_s = 0.05;
};

struct PanelSurvey {
  std::string file;  // empty: the docked mission's panel
  PanelNames names;
  std::vector<ValveNature> valves;  // of a file's panel, as its layout's
};

// How a message names a key of one feature: "'panel.handle_length_m'" of the docked mission's panel, "'valves.V1.length_m'" of a file's. Fields are those of the file:
// length_m, thickness_m, height_m, pointer, pointer_length_m, stop_min_deg, stop_max_deg; at_m, width_m, height_m, stroke_m; at_m, size_m, plate_m; min_m, max_m.
std::string valve_key(const PanelSurvey& survey, std::size_t valve, const std::string& field);
std::string button_key(const PanelSurvey& survey, std::size_t button, const std::string& field);
std::string marker_key(const PanelSurvey& survey, std::size_t marker, const std::string& field);
std::string plate_key(const PanelSurvey& survey, const std::string& field);
// By name; of the valves "" is the only one. Nothing: the panel has none of that name.
std::optional<std::size_t> find_valve(const PanelNames& names, const std::string& name);
std::optional<std::size_t> find_button(const PanelNames& names, const std::string& name);

}  // namespace lf::config
