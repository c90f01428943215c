// `lanternfish check machine FILE`: what the robot is, all that was assumed, and whether it does the default scenario's job. A shipped machine goes by its name.
#pragma once

#include <string>

namespace lf::app {

// `picture`: where it is drawn as PNG, before the default scenario's panel; empty: not at all. Returns the exit status: 0 also where the job is refused. Throws
// InputError with everything that is wrong with the file.
int check_machine(const std::string& name, const std::string& picture, bool json);

}  // namespace lf::app
