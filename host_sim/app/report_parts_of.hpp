// The world's bodies as the report's 3D view has them: a chain of parts, each moved by one coordinate.
#pragma once

#include <vector>

#include "host_sim/record/report.hpp"
#include "host_sim/world/world.hpp"

namespace lf::app {

// In the order of scene::BodyId. Coordinates 0 to 4 are the joints' angles (rad), 5 is the valve's (rad), 6 to 8 are the buttons' depths (m).
std::vector<record::ReportPart> report_parts_of(const world::WorldConfig& config);

}  // namespace lf::app
