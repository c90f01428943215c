// Builds the scene: the robot's bodies from its URDF, the panel and what stands on it from the layout. Hosted side only.
#pragma once

#include <span>

#include "shared/arm/arm_description.hpp"
#include "shared/panel/panel_layout.hpp"
#include "shared/scene/scene.hpp"
#include "shared/scene/vehicle_shapes.hpp"

namespace lf::scene {

// Frames of the bodies: arm links as in the URDF; vehicle: the base frame; panel: the panel frame; handles: the valve's axis on the panel's plane, axes as the
// panel's, turned by the handle's angle about z (its bar along y at 0); buttons: the centre of the cap on the panel's plane, axes as the panel's, moving along -z when
// pressed.
// `vehicle`: what is bolted to the arm's base, beside the base link's own shapes.
Scene make_scene(const ArmDescription& arm, const PanelLayout& layout, const PanelNames& names, std::span<const Shape> vehicle);
inline Scene make_scene(const ArmDescription& arm, const PanelLayout& layout, const PanelNames& names = {}) {
  return make_scene(arm, layout, names, default_vehicle());
}

}  // namespace lf::scene
