// Wavefront OBJ. Inside this folder only.
#pragma once

#include "shared/mesh/read_mesh.hpp"

namespace lf::mesh {

// Fills mesh and notes of `reading`, in the file's own unit.
void read_obj(std::string_view text, Reading& reading);

}  // namespace lf::mesh
