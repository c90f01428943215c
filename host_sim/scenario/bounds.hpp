// What a scenario's other keys leave of a key's range: a depth ends at the stroke, an angle at the valve's stops.
#pragma once

#include <string>

#include "hal/config/key.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::scenario {

// By which a stated rating of a motor may be off what its drive says: the boot refuses more (firmware/canopen/boot_sequence.cpp).
inline constexpr double rating_apart_share = 0.1;

struct Bounds {
  double min = 0, max = 0;
};

// Force with which a press ends, N: what a button may take at half of its stroke.
double pressed_force_n(const Scenario& scenario);
// With which a clicked cap still returns at its release depth, N: less than this may be lost by the click.
double returning_force_n(const Scenario& scenario);

// Up to which an image and the panel vision's answer come in time, and the file of limits that says so.
struct LongestLatencies {
  double image_ms = 0, panel_vision_ms = 0;
  std::string limits_file;
};
// Throws InputError when the file cannot be read.
LongestLatencies longest_latencies(const Scenario& scenario);

// The key's own range where no other key bounds it. Only keys that hold numbers have one.
Bounds bounds_of(const config::Key& key, const Scenario& scenario, const ArmDescription& arm);

}  // namespace lf::scenario
