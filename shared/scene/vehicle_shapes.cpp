#include "shared/scene/vehicle_shapes.hpp"

#include <algorithm>

#include "shared/scene/shapes.hpp"

namespace lf::scene {
namespace {

constexpr Albedo vehicle_yellow{0.80f, 0.58f, 0.06f};
constexpr Albedo skid_grey{0.18f, 0.19f, 0.20f};

Shape box_of(const std::array<double, 6>& box_m) {
  const auto& [x, y, z, dx, dy, dz] = box_m;
  return shape(ShapeKind::box, Vec3(dx, dy, dz), at(x, y, z), skid_grey);
}

Shape capsule_of(const std::array<double, 7>& capsule_m) {
  const auto& [ax, ay, az, bx, by, bz, radius] = capsule_m;
  const Vec3 a(ax, ay, az), b(bx, by, bz);
  if (a == b) return shape(ShapeKind::sphere, Vec3(radius, 0, 0), at(ax, ay, az), vehicle_yellow);
  return shape(ShapeKind::capsule, Vec3(radius, 0, (b - a).norm()), along(0.5 * (a + b), b - a), vehicle_yellow);
}

bool is_within(const Vec3& place_m, const Shape& shape) {
  const Vec3 here = shape.body_from_shape.inverse(Eigen::Isometry) * place_m;
  if (shape.kind == ShapeKind::box) return (here.cwiseAbs().array() <= 0.5 * shape.size_m.array()).all();
  const double half_m = 0.5 * shape.size_m.z();
  const Vec3 on_axis(0, 0, std::clamp(here.z(), -half_m, half_m));
  return (here - on_axis).norm() <= shape.size_m.x();
}

}  // namespace

std::vector<Shape> default_vehicle() {
  const Vec3 forward = Vec3::UnitX();
  const Vec3 hull_size(0.16, 0, 0.95);
  std::vector<Shape> shapes;
  shapes.push_back(shape(ShapeKind::capsule, hull_size, along(Vec3(-0.55, -0.35, -0.85), forward), vehicle_yellow));
  shapes.push_back(shape(ShapeKind::capsule, hull_size, along(Vec3(-0.55, 0.35, -0.85), forward), vehicle_yellow));
  shapes.push_back(shape(ShapeKind::capsule, Vec3(0.15, 0, 0.85), along(Vec3(-0.60, 0, -0.30), forward), vehicle_yellow));
  shapes.push_back(shape(ShapeKind::box, Vec3(0.70, 0.60, 0.02), at(-0.37, 0, -0.115), skid_grey));
  for (const double y : {-0.30, 0.30}) {
    shapes.push_back(shape(ShapeKind::cylinder, Vec3(0.02, 0, 0.70), along(Vec3(-0.37, y, -0.115), forward), skid_grey));
    shapes.push_back(shape(ShapeKind::box, Vec3(0.03, 0.03, 0.75), at(-0.30, y, -0.46), skid_grey));
  }
  return shapes;
}

std::vector<Shape> vehicle_of(std::span<const std::array<double, 6>> boxes_m, std::span<const std::array<double, 7>> capsules_m,
                              std::span<const Vec3> eyes_m) {
  std::vector<Shape> shapes;
  for (const auto& box_m : boxes_m) shapes.push_back(box_of(box_m));
  for (const auto& capsule_m : capsules_m) shapes.push_back(capsule_of(capsule_m));
  for (Shape& shape : shapes)
    shape.visible = std::none_of(eyes_m.begin(), eyes_m.end(), [&](const Vec3& eye_m) { return is_within(eye_m, shape); });
  return shapes;
}

}  // namespace lf::scene
