// Where the tasks take the arm, and whether it reaches there at the panel's nominal place.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/arm/inverse_kinematics.hpp"
#include "hal/config/machine.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::config {

// Of "left", "centre" and "right".
std::uint8_t button_index(const std::string& name);

// Where a task takes the tool, or with `tip_m` the tips of the closed fingers, so far beyond it. In the panel's frame.
struct Place {
  std::string what;  // as "the valve"
  Vec3 in_panel_m = Vec3::Zero();
  double tip_m = 0;
};

// Of all tasks, each once.
std::vector<Place> places_of_tasks(const Machine& machine);

// The pose there, found as a press finds it (firmware/mission/press_button.cpp): the approach axis depends on the place itself.
arm::IkResult pose_at(const PanelLayout& panel, const Place& place);

// What stops an arm that does not reach, and by how much.
std::string excess_text(const arm::IkResult& ik);

}  // namespace lf::config
