// How near the arm comes to the panel and to itself: capsules around its links against the panel's plate, marker plate, buttons and handle.
//
// A capsule contains its link's collision shape, so that the real clearance is never smaller than the one found here, if the panel is where it is said
// to be.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/arm/kinematics.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::arm {

// Distances between surfaces, m. Negative when they overlap; not below minus the capsule's radius, which means that its axis is inside of the solid.
double clearance_to_plane(const Capsule& capsule, const Plane& plane);
double clearance_between(const Capsule& a, const Capsule& b);
// A box of `size_m` full extents centred in `base_from_box`. To 1e-7 m.
double clearance_to_box(const Capsule& capsule, const Pose& base_from_box, const Vec3& size_m);
// A solid cylinder about z, centred in `base_from_cylinder`. To 1e-7 m.
double clearance_to_cylinder(const Capsule& capsule, const Pose& base_from_cylinder, double radius_m, double height_m);

enum class PanelPart : std::uint8_t { none, plate, marker_plate, button_left, button_centre, button_right, handle, stem };
const char* name(PanelPart part);

// What may touch: a bit (1 << part) for every part left out.
using PanelParts = std::uint32_t;
constexpr PanelParts bit(PanelPart part) { return 1u << static_cast<std::uint32_t>(part); }

struct Clearance {
  double distance_m = 0;             // the smallest
  std::size_t link = 0;              // of that capsule, a scene::BodyId
  PanelPart part = PanelPart::none;  // nearest to it
};

// The arm against the panel at `base_from_panel`. The handle counts at every angle: as the disc it sweeps.
Clearance clearance_to_panel(const LinkCapsules& capsules, const Pose& base_from_panel, const PanelLayout& layout, PanelParts ignored = 0);

// The smallest clearance between links that are not neighbours: forearm, wrist and fingers against the slew, fingers and wrist against the upper arm.
double clearance_to_itself(const LinkCapsules& capsules);

// The smallest clearance to the panel on the straight joint-space way from `from_rad` to `to_rad`, checked at steps of at most `step_rad` of any joint.
Clearance clearance_on_way(const JointVector& from_rad, const JointVector& to_rad, double jaw_rad, const Pose& base_from_panel,
                           const PanelLayout& layout, PanelParts ignored = 0, double step_rad = 0.05);

}  // namespace lf::arm
