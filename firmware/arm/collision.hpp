// How near the arm comes to the panel, to the vehicle and to itself: capsules around its links against the panel's plate, marker plate, buttons and handle,
// against boxes and capsules around what is bolted to the vehicle, and against each other.
//
// A capsule contains its link's collision shape, so that the real clearance is never smaller than the one found here, if the panel is where it is said
// to be, or within the doubt by which it was grown.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "firmware/arm/kinematics.hpp"
#include "shared/messages/capacity.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::arm {

// Distances between surfaces, m. Negative when they overlap; not below minus the capsule's radius, which means that its axis is inside of the solid.
double clearance_to_plane(const Capsule& capsule, const Plane& plane);
double clearance_between(const Capsule& a, const Capsule& b);
// A box of `size_m` full extents centred in `base_from_box`. To 1e-7 m.
double clearance_to_box(const Capsule& capsule, const Pose& base_from_box, const Vec3& size_m);
// A solid cylinder about z, centred in `base_from_cylinder`. To 1e-7 m.
double clearance_to_cylinder(const Capsule& capsule, const Pose& base_from_cylinder, double radius_m, double height_m);

// A part of the panel: what it is, and which of its kind in the layout.
struct PanelPart {
  enum class Kind : std::uint8_t { none, plate, marker_plate, button, valve };  // valve: handle and stem
  Kind kind = Kind::none;
  std::uint8_t index = 0;

  static constexpr PanelPart plate() { return {Kind::plate, 0}; }
  static constexpr PanelPart button(std::size_t index) { return {Kind::button, static_cast<std::uint8_t>(index)}; }
  static constexpr PanelPart valve(std::size_t index) { return {Kind::valve, static_cast<std::uint8_t>(index)}; }
  friend bool operator==(const PanelPart&, const PanelPart&) = default;
};

// What may touch: a bit for every part left out.
using PanelParts = std::uint64_t;
static_assert(std::max({PanelLayout::max_markers, PanelLayout::max_buttons, PanelLayout::max_valves}) <= 16,
              "16 bits for each kind of part");
constexpr PanelParts bit(PanelPart part) { return PanelParts{1} << (16 * (static_cast<unsigned>(part.kind) - 1) + part.index); }

struct Clearance {
  double distance_m = 0;  // the smallest
  std::size_t link = 0;   // of that capsule, a scene::BodyId
  PanelPart part;         // nearest to it
};

// By how much a panel may be off the place where it is believed to be: either way along each of the base's axes, about each of them at the panel's
// origin, and besides about its own normal, which only the marker's edges tell.
struct PanelDoubt {
  double shift_m = 0;
  double turn_rad = 0;
  double spin_rad = 0;
};

// The panel's solids, worked out once for all the questions to come. A handle counts at every angle: as the disc it sweeps.
class PanelShape {
 public:
  explicit PanelShape(const PanelLayout& layout);

  // Each solid so much larger that it contains itself wherever a panel at `base_from_panel` may really be.
  PanelShape grown(const Pose& base_from_panel, const PanelDoubt& doubt) const;

  // The arm against the panel at `base_from_panel`, without the parts `ignored`, which its fingers and all other links may touch, and without those
  // that only the fingers may. 0.5 us on a desktop: most pairs are told apart by their bounding boxes.
  Clearance clearance(const LinkCapsules& capsules, const Pose& base_from_panel, PanelParts ignored = 0,
                      PanelParts ignored_by_fingers = 0) const;

 private:
  // In the panel frame: a box, or, where there is a radius, a cylinder about z within the box.
  struct Solid {
    PanelPart part;
    Vec3 centre_m = Vec3::Zero();
    Vec3 half_m = Vec3::Zero();
    double radius_m = 0;
  };
  static Solid box(PanelPart part, const Vec2& centre_m, double foot_m, const Vec3& size_m);
  static Solid cylinder(PanelPart part, const Vec3& centre_m, double radius_m, double height_m);

  StaticVector<Solid, 1 + PanelLayout::max_markers + PanelLayout::max_buttons + 2 * PanelLayout::max_valves> solids_;
};

// What of the vehicle the arm could reach and must not touch: hull, camera, lamps. Fixed in the base frame.
struct VehicleShape {
  static constexpr std::size_t capacity = lf::capacity::vehicle_shapes;  // of each kind
  struct Box {
    Vec3 centre_m = Vec3::Zero(), size_m = Vec3::Zero();  // full extents along the base's axes
  };
  struct Rod {
    Vec3 a_m = Vec3::Zero(), b_m = Vec3::Zero();
    double radius_m = 0;
  };
  StaticVector<Box, capacity> boxes;
  StaticVector<Rod, capacity> rods;
};

// Of all links to the vehicle but the first, which stands on it. Infinite where there is nothing of it. 0.5 us on a desktop.
double clearance_to_vehicle(const LinkCapsules& capsules, const VehicleShape& vehicle);

// The smallest clearance between links that are not neighbours; the fingers are not held against the two last links, which they open ahead of.
// 0.5 us on a desktop.
double clearance_to_itself(const LinkCapsules& capsules);

}  // namespace lf::arm
