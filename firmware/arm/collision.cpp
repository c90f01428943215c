#include "firmware/arm/collision.hpp"

#include <algorithm>
#include <cmath>

namespace lf::arm {
namespace {

double distance_to_box(const Vec3& p, const Vec3& half) { return (p.cwiseAbs() - half).cwiseMax(0.0).norm(); }

double distance_to_cylinder(const Vec3& p, double radius_m, double half_height_m) {
  const double outward = std::max(0.0, p.head<2>().norm() - radius_m);
  const double upward = std::max(0.0, std::abs(p.z()) - half_height_m);
  return std::sqrt(outward * outward + upward * upward);
}

// Least distance of the segment from `a` by `way` to a box. Half the squared distance has a slope that rises along the segment, linearly between the
// places where it passes a face's plane: so its zero is found exactly.
double segment_to_box(const Vec3& a, const Vec3& way, const Vec3& half) {
  const auto slope = [&](double t) {
    const Vec3 p = a + t * way;
    return way.dot(p - p.cwiseMax(-half).cwiseMin(half));
  };
  double low = 0, high = 1;
  double slope_low = slope(low), slope_high = slope(high);
  if (slope_low >= 0) return distance_to_box(a, half);
  if (slope_high <= 0) return distance_to_box(a + way, half);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const double face : {-half[axis], half[axis]}) {
      const double t = (face - a[axis]) / way[axis];
      if (!(t > low && t < high)) continue;  // nor where the segment is parallel to the face
      const double slope_here = slope(t);
      (slope_here < 0 ? low : high) = t;
      (slope_here < 0 ? slope_low : slope_high) = slope_here;
    }
  }
  return distance_to_box(a + (low - slope_low * (high - low) / (slope_high - slope_low)) * way, half);
}

// The same slope's zero for a cylinder, by regula falsi with the Illinois rule; the way left to 1e-7 m.
double segment_to_cylinder(const Vec3& a, const Vec3& way, double radius_m, double half_height_m) {
  const auto slope = [&](double t) {
    const Vec3 p = a + t * way;
    const double axial = p.z() - std::clamp(p.z(), -half_height_m, half_height_m);
    const double radial = p.head<2>().norm();
    const double outward = radial > radius_m ? (1 - radius_m / radial) * way.head<2>().dot(p.head<2>()) : 0.0;
    return outward + axial * way.z();
  };
  const auto distance = [&](double t) { return distance_to_cylinder(a + t * way, radius_m, half_height_m); };
  double low = 0, high = 1;
  double slope_low = slope(low), slope_high = slope(high);
  if (slope_low >= 0) return distance(low);
  if (slope_high <= 0) return distance(high);
  const double resolution = 1e-7 / way.norm();
  double t = high;
  for (int i = 0, same = 0; i < 60 && high - low > resolution; ++i) {
    t = low - slope_low * (high - low) / (slope_high - slope_low);
    const double here = slope(t);
    if (here == 0) break;
    if (here < 0) {
      low = t;
      slope_low = here;
      same = same < 0 ? same - 1 : -1;
      if (same < -1) slope_high /= 2;
    } else {
      high = t;
      slope_high = here;
      same = same > 0 ? same + 1 : 1;
      if (same > 1) slope_low /= 2;
    }
  }
  return distance(t);
}

// Pairs that can meet, links as scene::BodyId counts them: not the same link, not neighbours, and not the fingers with each other or with the link that carries them.
// Nor with the one before that, where the hand rolls: they open sideways, ahead of it.
bool can_meet(std::size_t low, std::size_t high, const LinkCapsules& of) {
  const std::size_t hand = of.arm_joints();
  return low > 0 && high > low + 1 && (high <= hand || low + (of.rolls() ? 1 : 0) < hand);
}

}  // namespace

double clearance_to_plane(const Capsule& capsule, const Plane& plane) {
  return std::min(plane.signed_distance_m(capsule.a_m), plane.signed_distance_m(capsule.b_m)) - capsule.radius_m;
}

double clearance_between(const Capsule& a, const Capsule& b) {
  // Nearest points of two segments (Ericson, Real-Time Collision Detection, 2005, 5.1.9).
  const Vec3 u = a.b_m - a.a_m, v = b.b_m - b.a_m, w = a.a_m - b.a_m;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double determinant = uu * vv - uv * uv;
  const auto along = [](double numerator, double denominator) {
    return denominator > 0 ? std::clamp(numerator / denominator, 0.0, 1.0) : 0.0;
  };
  double s = along(uv * vw - uw * vv, determinant);
  const double t = along(uv * s + vw, vv);
  s = along(uv * t - uw, uu);
  return (w + s * u - t * v).norm() - a.radius_m - b.radius_m;
}

double clearance_to_box(const Capsule& capsule, const Pose& base_from_box, const Vec3& size_m) {
  const Pose box_from_base = base_from_box.inverse(Eigen::Isometry);
  const Vec3 way = box_from_base.linear() * (capsule.b_m - capsule.a_m);
  return segment_to_box(box_from_base * capsule.a_m, way, size_m / 2) - capsule.radius_m;
}

double clearance_to_cylinder(const Capsule& capsule, const Pose& base_from_cylinder, double radius_m, double height_m) {
  const Pose cylinder_from_base = base_from_cylinder.inverse(Eigen::Isometry);
  const Vec3 way = cylinder_from_base.linear() * (capsule.b_m - capsule.a_m);
  return segment_to_cylinder(cylinder_from_base * capsule.a_m, way, radius_m, height_m / 2) - capsule.radius_m;
}

PanelShape::Solid PanelShape::box(PanelPart part, const Vec2& centre_m, double foot_m, const Vec3& size_m) {
  return {part, Vec3(centre_m.x(), centre_m.y(), foot_m + size_m.z() / 2), size_m / 2, 0};
}

PanelShape::Solid PanelShape::cylinder(PanelPart part, const Vec3& centre_m, double radius_m, double height_m) {
  return {part, centre_m, Vec3(radius_m, radius_m, height_m / 2), radius_m};
}

PanelShape::PanelShape(const PanelLayout& layout) {
  const auto add = [&](const Solid& solid) { (void)solids_.push_back(solid); };  // the layout's capacities are the shape's
  const auto index = [](std::size_t i) { return static_cast<std::uint8_t>(i); };
  const Vec2 plate_centre = (layout.plate_min_m + layout.plate_max_m) / 2;
  const Vec2 plate_size = layout.plate_max_m - layout.plate_min_m;
  add(box(PanelPart::plate(), plate_centre, -layout.plate_thickness_m, Vec3(plate_size.x(), plate_size.y(), layout.plate_thickness_m)));
  for (std::size_t i = 0; i < layout.markers.size(); ++i) {
    const PanelLayout::Marker& marker = layout.markers[i];
    add(box({PanelPart::Kind::marker_plate, index(i)}, marker.centre_m, 0, Vec3(marker.plate_m, marker.plate_m, marker.plate_thickness_m)));
  }
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) {
    const PanelLayout::Button& button = layout.buttons[i];
    add(box(PanelPart::button(i), button.at_m, 0, Vec3(button.width_m, button.width_m, button.height_m)));
  }
  for (std::size_t i = 0; i < layout.valves.size(); ++i) {
    const PanelLayout::Valve& valve = layout.valves[i];
    add(cylinder(PanelPart::valve(i), valve.handle_centre_m(), valve.swept_radius_m(), valve.depth_m()));
    const bool posts = valve.carried == PanelLayout::Carried::by_posts;  // which sweep as much as the bar
    add(cylinder(PanelPart::valve(i), Vec3(valve.at_m.x(), valve.at_m.y(), valve.handle_height_m / 2),
                 posts ? valve.swept_radius_m() : valve.stem_radius_m, valve.handle_height_m));
  }
}

// To first order in the turn a point p moves by turn x p, of which the part along an axis is linear in p: its largest is at a corner. The second order,
// which turns one after the other add, is bounded by half the square of their sum.
PanelShape PanelShape::grown(const Pose& base_from_panel, const PanelDoubt& doubt) const {
  constexpr int corners = 8;
  const Mat3& axes = base_from_panel.linear();
  const double turned_rad = 3 * doubt.turn_rad + doubt.spin_rad, second_order = turned_rad * turned_rad / 2;
  PanelShape shape = *this;
  for (Solid& solid : shape.solids_) {
    Vec3 grow = Vec3::Zero();
    const bool round = solid.radius_m > 0;  // what spins moves a cylinder's axis, and nothing about it
    for (int i = 0; i < corners; ++i) {
      const Vec3 corner =
          solid.centre_m + solid.half_m.cwiseProduct(Vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
      for (Eigen::Index k = 0; k < 3; ++k) {
        const Vec3 axis = Vec3::Unit(k);
        const double by_shift = doubt.shift_m * (axes * axis).lpNorm<1>();
        const Vec3 lever = corner.cross(axis);
        const Vec3 spun = round ? solid.centre_m.cross(axis) : lever;
        const double by_turn = doubt.turn_rad * (axes * lever).lpNorm<1>() + doubt.spin_rad * std::abs(spun.z());
        grow[k] = std::max(grow[k], by_shift + by_turn + second_order * corner.norm());
      }
    }
    solid.half_m += grow;
    if (solid.radius_m > 0) {
      solid.radius_m += grow.head<2>().norm();
      solid.half_m.head<2>().setConstant(solid.radius_m);
    }
  }
  return shape;
}

Clearance PanelShape::clearance(const LinkCapsules& capsules, const Pose& base_from_panel, PanelParts ignored,
                                PanelParts ignored_by_fingers) const {
  const Pose panel_from_base = base_from_panel.inverse(Eigen::Isometry);
  Clearance least{HUGE_VAL, 0, {}};
  // From the fingers up: what is near first, so that the rest need not be looked at closely.
  for (std::size_t i = capsules.size(); i-- > 0;) {
    const Capsule& capsule = capsules[i];
    const Vec3 a = panel_from_base * capsule.a_m;
    const Vec3 b = panel_from_base * capsule.b_m;
    const Vec3 low = a.cwiseMin(b), high = a.cwiseMax(b);
    const PanelParts left_out = capsule.link > capsules.arm_joints() ? ignored | ignored_by_fingers : ignored;
    for (const Solid& solid : solids_) {
      if ((left_out & bit(solid.part)) != 0) continue;
      const Vec3 gap = (low - solid.centre_m).cwiseMax(solid.centre_m - high) - solid.half_m;
      if (gap.cwiseMax(0.0).norm() - capsule.radius_m >= least.distance_m) continue;
      const Vec3 from_centre = a - solid.centre_m;
      const double distance = solid.radius_m > 0 ? segment_to_cylinder(from_centre, b - a, solid.radius_m, solid.half_m.z())
                                                 : segment_to_box(from_centre, b - a, solid.half_m);
      if (distance - capsule.radius_m < least.distance_m) least = {distance - capsule.radius_m, capsule.link, solid.part};
    }
  }
  return least;
}

double clearance_to_vehicle(const LinkCapsules& capsules, const VehicleShape& vehicle) {
  double least = HUGE_VAL;
  for (const Capsule& capsule : capsules) {
    if (capsule.link < 2) continue;  // the first link turns in its place
    const Vec3 low = capsule.a_m.cwiseMin(capsule.b_m), high = capsule.a_m.cwiseMax(capsule.b_m);
    const auto could_be_nearer = [&](const Vec3& low_m, const Vec3& high_m, double radius_m) {
      return (low - high_m).cwiseMax(low_m - high).cwiseMax(0.0).norm() - radius_m - capsule.radius_m < least;
    };
    for (const VehicleShape::Box& box : vehicle.boxes) {
      const Vec3 half = box.size_m / 2;
      if (!could_be_nearer(box.centre_m - half, box.centre_m + half, 0)) continue;
      least = std::min(least, segment_to_box(capsule.a_m - box.centre_m, capsule.b_m - capsule.a_m, half) - capsule.radius_m);
    }
    for (const VehicleShape::Rod& rod : vehicle.rods) {
      if (!could_be_nearer(rod.a_m.cwiseMin(rod.b_m), rod.a_m.cwiseMax(rod.b_m), rod.radius_m)) continue;
      least = std::min(least, clearance_between(capsule, {0, rod.a_m, rod.b_m, rod.radius_m}));
    }
  }
  return least;
}

double clearance_to_itself(const LinkCapsules& capsules) {
  double least = HUGE_VAL;
  for (const Capsule& a : capsules)
    for (const Capsule& b : capsules)
      if (can_meet(a.link, b.link, capsules)) least = std::min(least, clearance_between(a, b));
  return least;
}

}  // namespace lf::arm
