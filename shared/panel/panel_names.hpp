// What people call the features of a panel, in the order of its layout. Hosted side only: the core has their indices.
#pragma once

#include <string>
#include <vector>

namespace lf {

struct PanelNames {
  std::vector<std::string> valves{"valve"};
  std::vector<std::string> buttons{"left", "centre", "right"};
  std::vector<std::string> markers{"marker"};
};

// "the left button"; "the valve", "valve V2"; "the marker", "marker 12".
inline std::string button_text(const PanelNames& names, std::size_t i) { return "the " + names.buttons.at(i) + " button"; }
inline std::string valve_text(const PanelNames& names, std::size_t i) {
  return names.valves.at(i) == "valve" ? "the valve" : "valve " + names.valves.at(i);
}

inline std::string marker_text(const PanelNames& names, std::size_t i) {
  return names.markers.at(i) == "marker" ? "the marker" : "marker " + names.markers.at(i);
}

}  // namespace lf
