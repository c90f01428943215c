#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/record/report_parts.hpp"

namespace lf::record {
namespace {

constexpr std::size_t most_triangles = 4000;  // of one mesh; a larger one is shown as its box: 200 kB of page

Solid box_of(const Vec3& low, const Vec3& high) {
  Solid solid;
  for (int corner = 0; corner < 8; ++corner) {
    solid.vertices_m.emplace_back((corner & 1) != 0 ? high.x() : low.x(), (corner & 2) != 0 ? high.y() : low.y(),
                                  (corner & 4) != 0 ? high.z() : low.z());
  }
  solid.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return solid;
}

struct Ring {
  double radius_m = 0, z_m = 0;
};

// A surface of revolution about z through the rings, from the lowest to the highest; it ends in a point on the axis at both.
Solid turned(const std::vector<Ring>& rings, double bottom_m, double top_m, std::uint32_t segments) {
  Solid solid;
  for (const Ring& ring : rings) {
    for (std::uint32_t k = 0; k < segments; ++k) {
      const double angle = 2 * pi * k / segments;
      solid.vertices_m.emplace_back(ring.radius_m * std::cos(angle), ring.radius_m * std::sin(angle), ring.z_m);
    }
  }
  const auto low = static_cast<std::uint32_t>(solid.vertices_m.size()), high = low + 1;
  solid.vertices_m.emplace_back(0, 0, bottom_m);
  solid.vertices_m.emplace_back(0, 0, top_m);
  const auto last = static_cast<std::uint32_t>(rings.size() - 1) * segments;
  for (std::uint32_t k = 0; k < segments; ++k) {
    const std::uint32_t next = (k + 1) % segments;
    solid.triangles.push_back({low, next, k});
    for (std::uint32_t base = 0; base < last; base += segments) {
      solid.triangles.push_back({base + k, base + next, base + segments + next});
      solid.triangles.push_back({base + k, base + segments + next, base + segments + k});
    }
    solid.triangles.push_back({high, last + k, last + next});
  }
  return solid;
}

// Rings of two half spheres whose middles are `height_m` apart.
std::vector<Ring> capsule_rings(double radius_m, double height_m, std::uint32_t segments) {
  const std::uint32_t steps = std::max(2U, segments / 4);
  std::vector<Ring> rings;
  for (const double half : {-1.0, 1.0}) {
    for (std::uint32_t i = 0; i < steps; ++i) {
      const double latitude = half < 0 ? -pi / 2 * (steps - 1 - i) / steps : pi / 2 * i / steps;
      rings.push_back({radius_m * std::cos(latitude), half * height_m / 2 + radius_m * std::sin(latitude)});
    }
  }
  return rings;
}

Solid mesh_of(const scene::Shape& shape) {
  if (shape.triangles.size() <= most_triangles) return {shape.vertices_m, shape.triangles};
  constexpr double far = std::numeric_limits<double>::infinity();
  Vec3 low = Vec3::Constant(far), high = Vec3::Constant(-far);
  for (const Vec3& vertex : shape.vertices_m) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  return box_of(low, high);
}

Solid in_own_frame(const scene::Shape& shape, std::uint32_t segments) {
  const Vec3& size = shape.size_m;
  switch (shape.kind) {
    case scene::ShapeKind::box: return box_of(-0.5 * size, 0.5 * size);
    case scene::ShapeKind::cylinder: {
      const double half = 0.5 * size.z();
      return turned({{size.x(), -half}, {size.x(), half}}, -half, half, segments);
    }
    case scene::ShapeKind::capsule: {
      const double end = 0.5 * size.z() + size.x();
      return turned(capsule_rings(size.x(), size.z(), segments), -end, end, segments);
    }
    case scene::ShapeKind::sphere: {
      std::vector<Ring> rings = capsule_rings(size.x(), 0, segments);
      rings.erase(rings.begin() + static_cast<std::ptrdiff_t>(rings.size() / 2));  // the equator stands there twice
      return turned(rings, -size.x(), size.x(), segments);
    }
    case scene::ShapeKind::mesh: return mesh_of(shape);
  }
  return {};
}

}  // namespace

Solid solid_of(const scene::Shape& shape, std::uint32_t segments) {
  Solid solid = in_own_frame(shape, segments);
  for (Vec3& vertex : solid.vertices_m) vertex = shape.body_from_shape * vertex;
  return solid;
}

}  // namespace lf::record
