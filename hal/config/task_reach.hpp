// Where the tasks take the arm, and whether it reaches there at the panel's nominal place.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/arm/collision.hpp"
#include "firmware/arm/inverse_kinematics.hpp"
#include "hal/config/machine.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::config {

// Where a task takes the tool, or with `tip_m` the tips of the closed fingers, so far beyond it. In the panel's frame.
struct Place {
  std::string what;  // as "the valve"
  Vec3 in_panel_m = Vec3::Zero();
  double tip_m = 0;
  std::string key;  // that puts it there on the panel, quoted
};

// Of all tasks, each once; of what the panel does not have, none.
std::vector<Place> places_of_tasks(const Machine& machine);

// Whether the panel has every valve and button that the tasks name.
bool names_known(const std::vector<Task>& tasks, const PanelNames& names);
// Whether a task turns this valve.
bool turns(const Machine& machine, std::size_t valve);

Place place_of_valve(const Machine& machine, std::size_t valve);
Place place_of_button(const Machine& machine, std::size_t button);

// How aslant the tool may stand to the panel there, rad: nominally, and by what the panel may be turned about all three axes and shifted along two, from half a
// metre away. In the reach survey 2 degrees and 20 mm about each axis add up to 6.9 degrees; 6.7 by this. An arm that can point its tool points it at the panel as it was
// seen. Where the arm does not reach, it does not work: 0.
double steepest_rad(const Machine& machine, const Place& place);

// The pose there, found as a press finds it (firmware/mission/press_button.cpp), from the folded pose.
arm::IkResult pose_at(const Machine& machine, const Place& place);

// How aslant the tool comes to a place, and by which keys: a clause for the end of a message.
std::string aslant_text(const PanelLayout& panel, const arm::PanelDoubt& docking, double tilt_rad);

// The keys of the panel's place and their values, for the end of a message. A panel file has the same ones.
std::string place_text(const PanelLayout& panel);

// What stops an arm that does not reach, and by how much.
std::string excess_text(const arm::IkResult& ik);

}  // namespace lf::config
