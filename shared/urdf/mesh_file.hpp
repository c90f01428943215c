// Where the file of a mesh is, and its unit. Inside this folder only.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lf::urdf {

struct MeshFile {
  std::optional<std::filesystem::path> file;
  std::string remark;    // how it was found, when that is not what the URDF says; "" otherwise
  std::string problem;   // what is wrong, and the remedy, when there is no `file`
  bool missing = false;  // the name is sound, but there is no such file
};

// `name` as a URDF has it, `folder` the URDF's own.
MeshFile find_mesh(const std::string& name, const std::filesystem::path& folder, const std::vector<std::filesystem::path>& package_folders);

struct MeshUnit {
  double metres_per_unit = 1;
  std::string remark;   // what a user has to know about it; "" otherwise
  std::string problem;  // "" when the unit is known
};
// Of a COLLADA file (*.dae), from its <asset>: <unit meter="0.01"/>, 1 when it has none. Of any other 1. Source: COLLADA 1.4.1, <asset>, <unit>, <up_axis>.
MeshUnit unit_of(const std::filesystem::path& file);

}  // namespace lf::urdf
