// How well the core saw, against the simulator's truth. Nothing of it goes back into the core.
#pragma once

#include <span>
#include <vector>

#include "firmware/arm/collision.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/panel/panel_layout.hpp"
#include "shared/scene/scene.hpp"

namespace lf::app {

// Angle between the normals, deg, whichever way they point.
double plane_normal_error_deg(const Plane& found, const Pose& true_base_from_panel);
// Distance of the true plate's centre from the found plane, mm.
// The panel's error along each of the base's axes, about its normal, and its tilt about each of the base's axes: the worst, over what is kept clear for it.
double panel_over_doubt(const Pose& found_base_from_panel, const Pose& true_base_from_panel, const arm::PanelDoubt& doubt);

double plane_offset_error_mm(const Plane& found, const Pose& true_base_from_panel, const PanelLayout& layout);
// Of a bar, which is the same after half a turn: -90 to 90 deg, absolute.
double handle_error_deg(double found_rad, double true_rad);

// Distance of a point from a shape's surface, both in the body's frame. A capsule is its cylinder and two half spheres; a mesh its triangles.
double distance_to_surface_m(const Vec3& point_m, const scene::Shape& shape);
// Distances of the points from the nearest surface of panel, handle, buttons and objects, mm.
std::vector<double> cloud_errors_mm(std::span<const CloudPoint> cloud, const scene::Scene& scene, const scene::BodyPoses& poses);

// Nearest-rank percentile, NaN without values.
double percentile(std::vector<double> values, double share);

}  // namespace lf::app
