#include "firmware/arm/collision.hpp"

#include <algorithm>
#include <cmath>

namespace lf::arm {
namespace {

// Smallest value over t in [0, 1] of a convex function: golden section, `length` (its greatest possible slope) to 1e-7.
template <class Function>
double smallest(double length, const Function& f) {
  constexpr double ratio = 0.6180339887498949;
  double low = 0, high = 1;
  double x1 = 1 - ratio, x2 = ratio;
  double f1 = f(x1), f2 = f(x2);
  // 40 steps shrink 1 to 4e-9; a segment is shorter than a metre.
  for (int i = 0; i < 40 && (high - low) * length > 1e-7; ++i) {
    if (f1 < f2) {
      high = x2;
      x2 = x1;
      f2 = f1;
      x1 = high - ratio * (high - low);
      f1 = f(x1);
    } else {
      low = x1;
      x1 = x2;
      f1 = f2;
      x2 = low + ratio * (high - low);
      f2 = f(x2);
    }
  }
  return std::min({f1, f2, f(0.0), f(1.0)});
}

double distance_to_box(const Vec3& p, const Vec3& half) { return (p.cwiseAbs() - half).cwiseMax(0.0).norm(); }

double distance_to_cylinder(const Vec3& p, double radius_m, double half_height_m) {
  return std::hypot(std::max(0.0, p.head<2>().norm() - radius_m), std::max(0.0, std::abs(p.z()) - half_height_m));
}

// Distance of a capsule's surface from a convex solid, given the distance of a point in the solid's frame.
template <class Distance>
double clearance(const Capsule& capsule, const Pose& base_from_solid, const Distance& distance) {
  const Pose solid_from_base = base_from_solid.inverse(Eigen::Isometry);
  const Vec3 a = solid_from_base * capsule.a_m;
  const Vec3 way = solid_from_base.linear() * (capsule.b_m - capsule.a_m);
  return smallest(way.norm(), [&](double t) { return distance(Vec3(a + t * way)); }) - capsule.radius_m;
}

// A solid of the panel: a box, or a cylinder about z when `size_m.y()` is 0 (radius in x, height in z).
struct Solid {
  PanelPart part;
  Vec3 centre_m;  // panel frame
  Vec3 size_m;

  double distance(const Vec3& p) const {
    return size_m.y() > 0 ? distance_to_box(p, size_m / 2) : distance_to_cylinder(p, size_m.x(), size_m.z() / 2);
  }
};

constexpr std::size_t solid_count = 4 + PanelLayout::button_count;

std::array<Solid, solid_count> solids_of(const PanelLayout& layout) {
  const Vec2 plate_centre = (layout.plate_min_m + layout.plate_max_m) / 2;
  const Vec2 plate_size = layout.plate_max_m - layout.plate_min_m;
  const auto box = [](PanelPart part, const Vec2& centre, double foot, const Vec3& size) {
    return Solid{part, Vec3(centre.x(), centre.y(), foot + size.z() / 2), size};
  };
  const auto button = [&](PanelPart part, std::size_t i) {
    return box(part, layout.buttons_m[i], 0, Vec3(layout.button_width_m, layout.button_width_m, layout.button_height_m));
  };
  const double sweep_radius = std::hypot(layout.handle_length_m, layout.handle_thickness_m) / 2;
  return {box(PanelPart::plate, plate_centre, -layout.plate_thickness_m, Vec3(plate_size.x(), plate_size.y(), layout.plate_thickness_m)),
          box(PanelPart::marker_plate, layout.marker_centre_m, 0,
              Vec3(layout.marker_plate_m, layout.marker_plate_m, layout.marker_plate_thickness_m)),
          button(PanelPart::button_left, 0),
          button(PanelPart::button_centre, 1),
          button(PanelPart::button_right, 2),
          Solid{PanelPart::handle, Vec3(0, 0, layout.handle_height_m), Vec3(sweep_radius, 0, layout.handle_thickness_m)},
          Solid{PanelPart::stem, Vec3(0, 0, layout.handle_height_m / 2), Vec3(layout.stem_radius_m, 0, layout.handle_height_m)}};
}

// Links as scene::BodyId counts them.
constexpr std::size_t slew = 1, upper_arm = 2, forearm = 3;

// Pairs that can meet: not the same link, not neighbours, and not the two fingers, which are meant to.
bool can_meet(std::size_t low, std::size_t high) { return (low == slew && high >= forearm) || (low == upper_arm && high > forearm); }

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
  return clearance(capsule, base_from_box, [half = Vec3(size_m / 2)](const Vec3& p) { return distance_to_box(p, half); });
}

double clearance_to_cylinder(const Capsule& capsule, const Pose& base_from_cylinder, double radius_m, double height_m) {
  return clearance(capsule, base_from_cylinder, [=](const Vec3& p) { return distance_to_cylinder(p, radius_m, height_m / 2); });
}

const char* name(PanelPart part) {
  constexpr std::array<const char*, 8> names{"none",          "plate",        "marker plate", "left button",
                                             "centre button", "right button", "handle",       "stem"};
  return names[static_cast<std::size_t>(part)];
}

Clearance clearance_to_panel(const LinkCapsules& capsules, const Pose& base_from_panel, const PanelLayout& layout, PanelParts ignored) {
  const Pose panel_from_base = base_from_panel.inverse(Eigen::Isometry);
  Clearance least{HUGE_VAL, 0, PanelPart::none};
  for (const Solid& solid : solids_of(layout)) {
    if ((ignored & bit(solid.part)) != 0) continue;
    for (const Capsule& capsule : capsules) {
      const Vec3 a = panel_from_base * capsule.a_m - solid.centre_m;
      const Vec3 way = panel_from_base.linear() * (capsule.b_m - capsule.a_m);
      const double length = way.norm();
      // No point of the capsule is nearer than its middle less half its length.
      if (solid.distance(a + way / 2) - length / 2 - capsule.radius_m >= least.distance_m) continue;
      const double distance = smallest(length, [&](double t) { return solid.distance(a + t * way); }) - capsule.radius_m;
      if (distance < least.distance_m) least = {distance, capsule.link, solid.part};
    }
  }
  return least;
}

double clearance_to_itself(const LinkCapsules& capsules) {
  double least = HUGE_VAL;
  for (const Capsule& a : capsules)
    for (const Capsule& b : capsules)
      if (can_meet(a.link, b.link)) least = std::min(least, clearance_between(a, b));
  return least;
}

Clearance clearance_on_way(const JointVector& from_rad, const JointVector& to_rad, double jaw_rad, const Pose& base_from_panel,
                           const PanelLayout& layout, PanelParts ignored, double step_rad) {
  constexpr int max_steps = 128;  // half a turn of the wrist at 0.05 rad, and a bound on the time
  const JointVector way = to_rad - from_rad;
  const double longest = way.cwiseAbs().maxCoeff();
  const int steps = std::clamp(static_cast<int>(std::ceil(longest / step_rad)), 1, max_steps);
  Clearance least{HUGE_VAL, 0, PanelPart::none};
  for (int i = 0; i <= steps; ++i) {
    const LinkCapsules capsules = link_capsules(from_rad + way * (static_cast<double>(i) / steps), jaw_rad);
    const Clearance here = clearance_to_panel(capsules, base_from_panel, layout, ignored);
    if (here.distance_m < least.distance_m) least = here;
  }
  return least;
}

}  // namespace lf::arm
