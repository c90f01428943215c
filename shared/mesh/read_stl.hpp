// STL, text and binary. Inside this folder only.
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/mesh/read_mesh.hpp"

namespace lf::mesh {

// Binary: a header of 80 bytes and a count, then for each triangle a normal and three corners as twelve little-endian floats, and two bytes of attributes.
inline constexpr std::size_t stl_header_bytes = 84, stl_triangle_bytes = 50;
// As the header states it; needs the whole header.
std::uint32_t stl_count(std::string_view bytes);

// Fills mesh and notes of `reading`, in the file's own unit.
void read_stl(std::string_view bytes, Reading& reading);

}  // namespace lf::mesh
