#include "hal/config/panel_survey.hpp"

#include <algorithm>

#include "shared/geometry/pose.hpp"

namespace lf::config {

namespace {

// "at_m" of the docked mission's button is 'panel.buttons_m', of its marker 'panel.marker_centre_m'.
std::string docked_key(const std::string& group, const std::string& field) {
  if (group == "buttons" && field == "at_m") return "'panel.buttons_m'";
  if (group == "buttons") return "'panel.button_" + field + "'";
  if (group == "markers" && field == "at_m") return "'panel.marker_centre_m'";
  if (group == "markers") return "'panel.marker_" + field + "'";
  if (field.starts_with("stop_")) return "'valve." + field + "'";
  if (field.starts_with("pointer")) return "'panel." + field + "'";
  return "'panel.handle_" + field + "'";
}

std::string key_of(const PanelSurvey& survey, const char* group, const std::string& name, const std::string& field) {
  if (survey.file.empty()) return docked_key(group, field);
  return std::string("'") + group + "." + name + "." + field + "'";
}

std::optional<std::size_t> index_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

DockedPanel::DockedPanel() {
  const PanelLayout usual;
  nominal_x_m = usual.nominal_x_m;
  nominal_y_m = usual.nominal_y_m;
  nominal_z_m = usual.nominal_z_m;
  plate_min_m = usual.plate_min_m;
  plate_max_m = usual.plate_max_m;
  const PanelLayout::Valve& valve = usual.valves[0];
  handle_length_m = valve.handle_length_m;
  handle_thickness_m = valve.handle_thickness_m;
  handle_height_m = valve.handle_height_m;
  pointer = valve.pointer;
  pointer_length_m = valve.pointer_length_m;
  for (std::size_t i = 0; i < buttons_m.size(); ++i) buttons_m[i] = usual.buttons[i].at_m;
  button_width_m = usual.buttons[0].width_m;
  button_height_m = usual.buttons[0].height_m;
  button_stroke_m = usual.buttons[0].stroke_m;
  marker_id = usual.markers[0].id;
  marker_size_m = usual.markers[0].size_m;
  marker_plate_m = usual.markers[0].plate_m;
  marker_centre_m = usual.markers[0].centre_m;
}

PanelLayout layout_of(const DockedPanel& panel, const ValveStops& stops) {
  PanelLayout layout;
  layout.nominal_x_m = panel.nominal_x_m;
  layout.nominal_y_m = panel.nominal_y_m;
  layout.nominal_z_m = panel.nominal_z_m;
  layout.plate_min_m = panel.plate_min_m;
  layout.plate_max_m = panel.plate_max_m;
  PanelLayout::Valve& valve = layout.valves[0];
  valve.handle_length_m = panel.handle_length_m;
  valve.handle_thickness_m = panel.handle_thickness_m;
  valve.handle_height_m = panel.handle_height_m;
  valve.pointer = panel.pointer;
  valve.pointer_length_m = panel.pointer_length_m;
  valve.handle_min_rad = rad_from_deg(stops.stop_min_deg);
  valve.handle_max_rad = rad_from_deg(stops.stop_max_deg);
  for (std::size_t i = 0; i < panel.buttons_m.size(); ++i)
    layout.buttons[i] = {panel.buttons_m[i], panel.button_width_m, panel.button_height_m, panel.button_stroke_m};
  PanelLayout::Marker& marker = layout.markers[0];
  marker.id = panel.marker_id;
  marker.size_m = panel.marker_size_m;
  marker.plate_m = panel.marker_plate_m;
  marker.centre_m = panel.marker_centre_m;
  return layout;
}

std::string valve_key(const PanelSurvey& survey, std::size_t valve, const std::string& field) {
  return key_of(survey, "valves", survey.names.valves.at(valve), field);
}

std::string button_key(const PanelSurvey& survey, std::size_t button, const std::string& field) {
  return key_of(survey, "buttons", survey.names.buttons.at(button), field);
}

std::string marker_key(const PanelSurvey& survey, std::size_t marker, const std::string& field) {
  return key_of(survey, "markers", survey.names.markers.at(marker), field);
}

std::string plate_key(const PanelSurvey& survey, const std::string& field) {
  return survey.file.empty() ? "'panel.plate_" + field + "'" : "'plate." + field + "'";
}

std::optional<std::size_t> find_valve(const PanelNames& names, const std::string& name) {
  if (name.empty()) return names.valves.size() == 1 ? std::optional<std::size_t>(0) : std::nullopt;
  return index_of(names.valves, name);
}

std::optional<std::size_t> find_button(const PanelNames& names, const std::string& name) { return index_of(names.buttons, name); }

}  // namespace lf::config
