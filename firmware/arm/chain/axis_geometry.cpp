#include "firmware/arm/chain/axis_geometry.hpp"

#include <cmath>
#include <optional>

namespace lf::chain {
namespace {

constexpr double same_rad = 1e-5;
constexpr double same_m = 1e-5;

bool parallel(const Vec3& a, const Vec3& b) { return a.cross(b).norm() < same_rad; }

double distance_m(const Vec3& axis, const Vec3& on_axis, const Vec3& point) { return axis.cross(point - on_axis).norm(); }

// Where axes i and k meet: the middle between their nearest points. Nothing where they pass each other or are parallel.
std::optional<Vec3> meeting(const AxisGeometry& g, std::size_t i, std::size_t k) {
  const Vec3& a = g.axis[i];
  const Vec3& b = g.axis[k];
  const Vec3 cross = a.cross(b);
  const double square = cross.squaredNorm();
  if (std::sqrt(square) < same_rad) return std::nullopt;
  const Vec3 between = g.point_m[k] - g.point_m[i];
  if (std::abs(between.dot(cross)) / std::sqrt(square) > same_m) return std::nullopt;
  const Vec3 on_a = g.point_m[i] + a * (between.cross(b).dot(cross) / square);
  const Vec3 on_b = g.point_m[k] + b * (between.cross(a).dot(cross) / square);
  return Vec3((on_a + on_b) / 2);
}

Family numeric(AxisGeometry& g, const char* reason) {
  g.reason = reason;
  return Family::numeric;
}

Family planar(AxisGeometry& g, std::size_t joints) {
  const std::size_t last = joints - 1;
  if (g.parallel == 3 && joints == 4) {
    g.reason = "joints 2, 3 and 4 are parallel";
    return Family::planar;
  }
  if ((g.parallel == 3 && joints == 5) || (g.parallel == 2 && joints == 4)) {
    if (parallel(g.axis[last], g.axis[1])) return numeric(g, "the last joint is parallel to the second");
    g.tool_on_last = distance_m(g.axis[last], g.point_m[last], g.tool_m) < same_m && parallel(g.axis[last], g.tool.col(2));
    g.reason = joints == 5 ? "joints 2, 3 and 4 are parallel, and the fifth is not" : "joints 2 and 3 are parallel, and the fourth is not";
    return Family::planar;
  }
  return numeric(g, "joints 2 and 3, or 2 to 4, are not all parallel");
}

Family six(AxisGeometry& g) {
  if (g.parallel == 3) {
    const std::optional<Vec3> centre = meeting(g, 4, 5);
    if (!centre) return numeric(g, "joints 2, 3 and 4 are parallel, but 5 and 6 do not meet");
    if (parallel(g.axis[4], g.axis[1])) return numeric(g, "joint 5 is parallel to joint 2");
    g.centre_m = *centre;
    g.reason = "joints 2, 3 and 4 are parallel, 5 and 6 meet";
    return Family::three_parallel;
  }
  if (g.parallel < 2) return numeric(g, "joints 2 and 3 are not parallel");
  const std::optional<Vec3> centre = meeting(g, 3, 4);
  if (!centre || distance_m(g.axis[5], g.point_m[5], *centre) > same_m)
    return numeric(g, "joints 2 and 3 are parallel, but 4, 5 and 6 do not meet in a point");
  if (parallel(g.axis[4], g.axis[5])) return numeric(g, "joints 5 and 6 are the same");
  g.centre_m = *centre;
  g.reason = "joints 2 and 3 are parallel, 4, 5 and 6 meet in a point";
  return Family::spherical_wrist;
}

Family family_of(const Chain& chain, AxisGeometry& g) {
  for (std::size_t i = 0; i < chain.size(); ++i)
    if (chain.joint(i).kind == JointKind::prismatic) return numeric(g, "a joint slides");
  if (chain.size() < 4) return numeric(g, "fewer than four joints");
  if (chain.size() > 6) return numeric(g, "more than six joints");
  if (parallel(g.axis[0], g.axis[1])) return numeric(g, "joints 1 and 2 are parallel");
  g.parallel = 1;
  while (g.parallel < 3 && parallel(g.axis[static_cast<std::size_t>(g.parallel) + 1], g.axis[1])) ++g.parallel;
  for (std::size_t i = 1; i < 1 + static_cast<std::size_t>(g.parallel); ++i) {
    g.sense[i] = g.axis[i].dot(g.axis[1]) < 0 ? -1 : 1;
    g.axis[i] = g.axis[1];
  }
  return chain.size() == 6 ? six(g) : planar(g, chain.size());
}

}  // namespace

const char* name(Family family) {
  switch (family) {
    case Family::numeric: return "numeric";
    case Family::planar: return "planar";
    case Family::spherical_wrist: return "spherical wrist";
    case Family::three_parallel: return "three parallel axes";
  }
  return "unknown";
}

AxisGeometry classify(const Chain& chain) {
  AxisGeometry g;
  g.axis.fill(Vec3::UnitZ());
  g.point_m.fill(Vec3::Zero());
  g.sense.fill(1);
  if (chain.size() == 0) {
    g.reason = "no joint";
    return g;
  }
  ChainState state;
  chain.evaluate(JointValues::Zero(), state);
  for (std::size_t i = 0; i < chain.size(); ++i) {
    g.axis[i] = state.axis[i];
    g.point_m[i] = state.point_m[i];
  }
  g.tool = state.tool;
  g.tool_m = state.tool_m;
  g.family = family_of(chain, g);
  return g;
}

}  // namespace lf::chain
