// Links and materials of a URDF. Inside this folder only.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "shared/urdf/element.hpp"

namespace lf::urdf {

using Colour = std::array<float, 4>;
// By name: the robot's own materials, and those that a visual defines. Nothing for one without a colour.
using Materials = std::map<std::string, std::optional<Colour>, std::less<>>;

Materials read_materials(const Element& robot);
Link read_link(const Element& element, const Materials& materials, const ReadOptions& options);

}  // namespace lf::urdf
