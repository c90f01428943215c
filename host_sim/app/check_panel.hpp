// `lanternfish check panel FILE`: what is on it, which of it the default robot can work, and why not.
#pragma once

#include <string>

namespace lf::app {

// `picture`: where it is drawn as PNG, with the default scenario's robot; empty: not at all. Returns the exit status: 0 also where the robot can work none of it. Throws
// InputError with everything that is wrong with the file.
int check_panel(const std::string& file, const std::string& picture, bool json);

}  // namespace lf::app
