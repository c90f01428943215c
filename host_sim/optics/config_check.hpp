// Refuses an optical configuration that makes no sense, by name.
#pragma once

#include "host_sim/optics/optics.hpp"

namespace lf::optics {

// Throws InputError with the first thing that is wrong.
void check(const OpticsConfig& config);

}  // namespace lf::optics
