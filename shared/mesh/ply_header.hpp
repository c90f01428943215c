// The header of a PLY file: which elements follow, and of what each consists. Inside this folder only.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lf::mesh {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
std::size_t size_of(PlyType type);
inline bool is_whole(PlyType type) { return type < PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;  // of a list: of its members
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  // of a list: whole
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  int line = 0;
  std::vector<PlyProperty> properties;  // none only where count is 0
};

enum class PlyEncoding { text, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  std::string_view body;
  int lines = 0;  // the header's
};

// Throws InputError for what is not well-formed, and when `body` is too short for what the elements count.
PlyHeader read_ply_header(std::string_view bytes, const std::string& file);

}  // namespace lf::mesh
