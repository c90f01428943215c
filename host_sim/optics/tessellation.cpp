#include "host_sim/optics/tessellation.hpp"

#include <algorithm>
#include <cmath>

#include "shared/input_error.hpp"

namespace lf::optics {
namespace {

constexpr double tolerance_m = 20e-6;  // 1/100 of a pixel on the panel
constexpr int most_sides = 64;         // slivers slow the rays down; only what is thicker than 66 mm becomes coarser

// Sides of a polygon that stays within the tolerance of its circle when it lies half inside, half outside.
int circle_sides(double radius_m) {
  const double sides = pi / std::sqrt(4 * tolerance_m / radius_m);
  return std::clamp(static_cast<int>(std::ceil(sides / 4)) * 4, 16, most_sides);
}

// The polygon's corner radius that puts it half outside: the sagitta is shared between corner and side.
double corner_radius(double radius_m, int sides) { return radius_m * 2 / (1 + std::cos(pi / sides)); }

struct Builder {
  explicit Builder(const Pose& body_from_shape) : pose(body_from_shape) {}

  std::uint32_t add(const Vec3& p) {
    const Vec3 q = pose * p;
    mesh.vertices_m.push_back({static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())});
    return static_cast<std::uint32_t>(mesh.vertices_m.size() - 1);
  }
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }

  Pose pose;
  TriangleMesh mesh;
};

void add_box(Builder& out, const Vec3& size) {
  std::array<std::uint32_t, 8> corner{};
  for (unsigned i = 0; i < 8; ++i) {
    corner[i] = out.add({(i & 1 ? 0.5 : -0.5) * size.x(), (i & 2 ? 0.5 : -0.5) * size.y(), (i & 4 ? 0.5 : -0.5) * size.z()});
  }
  constexpr unsigned faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces) out.quad(corner[f[0]], corner[f[1]], corner[f[2]], corner[f[3]]);
}

struct Ring {
  double radius_m, z_m;
};

// A solid of revolution about z: rings from bottom to top, closed at both ends by a point on the axis.
void add_revolved(Builder& out, const std::vector<Ring>& rings, int sides) {
  std::vector<std::uint32_t> first;
  for (const Ring& ring : rings) {
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * pi * i / sides;
      const auto index = out.add({ring.radius_m * std::cos(angle), ring.radius_m * std::sin(angle), ring.z_m});
      if (i == 0) first.push_back(index);
    }
  }
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t next = (i + 1) % n;
      out.quad(first[r] + i, first[r] + next, first[r + 1] + next, first[r + 1] + i);
    }
  }
  const std::uint32_t bottom = out.add({0, 0, rings.front().z_m}), top = out.add({0, 0, rings.back().z_m});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    out.mesh.triangles.push_back({bottom, first.front() + next, first.front() + i});
    out.mesh.triangles.push_back({top, first.back() + i, first.back() + next});
  }
}

// A sphere cut at its equator with a cylinder of `height_m` between the halves.
void add_capsule(Builder& out, double radius_m, double height_m) {
  const int sides = circle_sides(radius_m);
  const double radius = corner_radius(radius_m, sides);
  std::vector<Ring> rings;
  for (int half = 0; half < 2; ++half) {
    const double middle = (half == 0 ? -0.5 : 0.5) * height_m;
    for (int i = 0; i <= sides / 4; ++i) {
      const double latitude = 2 * pi * (half == 0 ? i - sides / 4 : i) / sides;
      rings.push_back({radius * std::cos(latitude), middle + radius * std::sin(latitude)});
    }
  }
  add_revolved(out, rings, sides);
}

void add_mesh(Builder& out, const scene::Shape& shape) {
  for (const Vec3& v : shape.vertices_m) {
    if (!v.allFinite()) throw InputError("mesh: a vertex is not finite");
    out.add(v);
  }
  for (const auto& triangle : shape.triangles) {
    for (const std::uint32_t i : triangle) {
      if (i >= shape.vertices_m.size()) throw InputError("mesh: triangle index " + std::to_string(i) + " points past the vertices");
    }
    out.mesh.triangles.push_back(triangle);
  }
}

void check_size(const scene::Shape& shape) {
  const Vec3& s = shape.size_m;
  const bool x_ok = std::isfinite(s.x()) && s.x() > 0, y_ok = std::isfinite(s.y()) && s.y() > 0, z_ok = std::isfinite(s.z()) && s.z() > 0;
  const bool ok = shape.kind == scene::ShapeKind::box        ? x_ok && y_ok && z_ok
                  : shape.kind == scene::ShapeKind::cylinder ? x_ok && z_ok
                  : shape.kind == scene::ShapeKind::capsule  ? x_ok && std::isfinite(s.z()) && s.z() >= 0
                  : shape.kind == scene::ShapeKind::sphere   ? x_ok
                                                             : true;
  if (!ok) throw InputError("scene: a shape's size must be positive");
  if (!shape.body_from_shape.matrix().allFinite()) throw InputError("scene: a shape's pose is not finite");
}

}  // namespace

TriangleMesh tessellate(const scene::Shape& shape) {
  check_size(shape);
  Builder out(shape.body_from_shape);
  switch (shape.kind) {
    case scene::ShapeKind::box: add_box(out, shape.size_m); break;
    case scene::ShapeKind::cylinder: {
      const int sides = circle_sides(shape.size_m.x());
      const double radius = corner_radius(shape.size_m.x(), sides);
      add_revolved(out, {{radius, -0.5 * shape.size_m.z()}, {radius, 0.5 * shape.size_m.z()}}, sides);
      break;
    }
    case scene::ShapeKind::capsule: add_capsule(out, shape.size_m.x(), shape.size_m.z()); break;
    case scene::ShapeKind::sphere: add_capsule(out, shape.size_m.x(), 0); break;
    case scene::ShapeKind::mesh: add_mesh(out, shape); break;
  }
  return std::move(out.mesh);
}

}  // namespace lf::optics
