// What a user should know of an arm's description that is accepted all the same.
#pragma once

#include <string>
#include <vector>

namespace lf::config {

// A sentence each, said once at start. Throws InputError when the description cannot be read.
std::vector<std::string> arm_notes(const std::string& urdf_file);

}  // namespace lf::config
