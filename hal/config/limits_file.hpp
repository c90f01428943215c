// The safety limits' own file: YAML with a checksum of its values, which the core computes again.
#pragma once

#include <string>

#include "firmware/safety/limits.hpp"
#include "shared/arm/joint_names.hpp"

namespace lf::config {

// Of an arm with these joints. Throws InputError with file and line: unreadable or malformed, a key missing, unknown or repeated, a value that is not a finite number, limits out of
// order or not positive, and a checksum that is not that of the values.
safety::Limits read_limits(const std::string& path, const JointNames& names);

}  // namespace lf::config
