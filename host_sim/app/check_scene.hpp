// `lanternfish check scene FILE`: what stands about, what was assumed of it, and a picture.
#pragma once

#include <string>

namespace lf::app {

// `picture`: where it is drawn as PNG, with the default scenario's robot and panel; empty: not at all. Returns the exit status. Throws InputError with
// everything that is wrong with the file, and where an object stands in the default robot.
int check_scene(const std::string& file, const std::string& picture, bool json);

}  // namespace lf::app
