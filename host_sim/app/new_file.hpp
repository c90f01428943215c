// What `lanternfish new` writes: THIS_FILE stands for the file, as a shell reads it.
#pragma once

#include <string>

namespace lf::app {

// Flies as it stands. Every other key stands in it with its default, commented out.
std::string new_scenario();
std::string new_scene();

}  // namespace lf::app
