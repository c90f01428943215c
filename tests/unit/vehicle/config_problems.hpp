// What is wrong with a vehicle's file, a line each.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "hal/vehicle/vehicle_config.hpp"
#include "shared/input_error.hpp"

namespace lf::hal {

inline std::vector<std::string> problems_of(const std::string& file) {
  std::vector<std::string> lines;
  try {
    (void)load_vehicle_config(file);
  } catch (const InputError& error) {
    std::istringstream text(error.what());
    for (std::string line; std::getline(text, line);) lines.push_back(line);
  }
  return lines;
}

}  // namespace lf::hal
