// PLY 1.0, text and binary. Inside this folder only.
#pragma once

#include "shared/mesh/read_mesh.hpp"

namespace lf::mesh {

// Fills mesh and notes of `reading`, in the file's own unit.
void read_ply(std::string_view bytes, Reading& reading);

}  // namespace lf::mesh
