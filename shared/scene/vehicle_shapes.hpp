// The vehicle's shapes in the simulator: physics collides them, optics draws them. All in the arm's base frame. Hosted side only.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "shared/scene/scene.hpp"

namespace lf::scene {

// The default machine's: three torpedo hulls over a skid, as on the GIRONA500, behind and above the arm's workspace.
std::vector<Shape> default_vehicle();

// Of a machine that says its own: boxes as [x, y, z, dx, dy, dz], capsules as [x, y, z, x, y, z, radius]. A shape around one of `eyes_m`, where cameras and lamps sit,
// is their housing: it is met, and not drawn, since they look out of it.
std::vector<Shape> vehicle_of(std::span<const std::array<double, 6>> boxes_m, std::span<const std::array<double, 7>> capsules_m,
                              std::span<const Vec3> eyes_m);

}  // namespace lf::scene
