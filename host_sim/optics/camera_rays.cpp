#include "host_sim/optics/camera_rays.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shared/input_error.hpp"

namespace lf::optics {
namespace {

struct Distorted {
  Vec2 point;
  Eigen::Matrix2d jacobian;
};

Distorted distort(const std::array<double, 5>& k, const Vec2& p) {
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double radial_slope = k[0] + r2 * (2 * k[1] + 3 * r2 * k[4]);  // d radial / d r2
  Distorted d;
  d.point = {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x), y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
  const double cross = 2 * x * y * radial_slope + 2 * k[2] * x + 2 * k[3] * y;
  d.jacobian << radial + 2 * x * x * radial_slope + 2 * k[2] * y + 6 * k[3] * x, cross, cross,
      radial + 2 * y * y * radial_slope + 6 * k[2] * y + 2 * k[3] * x;
  return d;
}

// Snell's law at a face square to z, for a unit direction with positive z; nullopt for total reflection.
std::optional<Vec3> refract(const Vec3& unit, double index_ratio) {
  const double x = unit.x() * index_ratio, y = unit.y() * index_ratio;
  const double z2 = 1 - x * x - y * y;
  if (!(z2 > 0)) return std::nullopt;
  return Vec3(x, y, std::sqrt(z2));
}

}  // namespace

std::optional<Vec2> undistort(const CameraIntrinsics& intrinsics, const Vec2& distorted) {
  Vec2 p = distorted;
  for (int i = 0; i < 30; ++i) {
    const Distorted d = distort(intrinsics.distortion, p);
    if (!(d.jacobian.determinant() > 0.01)) return std::nullopt;  // at 0 the image folds over
    const Vec2 step = d.jacobian.inverse() * (distorted - d.point);
    p += step;
    if (step.norm() < 1e-13) return p;
  }
  return std::nullopt;
}

std::optional<CameraRay> camera_ray(const CameraIntrinsics& intrinsics, const std::optional<FlatPort>& port, double u, double v) {
  const auto point = undistort(intrinsics, {(u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy});
  if (!point) return std::nullopt;
  CameraRay ray;
  ray.direction = Vec3(point->x(), point->y(), 1);
  if (!port) return ray;
  const auto in_glass = refract(ray.direction.normalized(), 1 / port->glass_index);
  if (!in_glass) return std::nullopt;
  const auto in_water = refract(*in_glass, port->glass_index / port->water_index);
  if (!in_water) return std::nullopt;
  ray.origin = ray.direction * port->distance_m + *in_glass * (port->thickness_m / in_glass->z());
  ray.direction = *in_water / in_water->z();
  return ray;
}

CameraRays::CameraRays(const CameraIntrinsics& intrinsics, const std::optional<FlatPort>& port)
    : width_(intrinsics.width),
      height_(intrinsics.height),
      fx_(intrinsics.fx),
      fy_(intrinsics.fy),
      cx_(intrinsics.cx),
      cy_(intrinsics.cy),
      port_(port.has_value()) {
  const int padded_width = (intrinsics.width + lane_count - 1) / lane_count * lane_count;
  stride_ = static_cast<std::size_t>(padded_width) + 2;
  const std::size_t count = stride_ * static_cast<std::size_t>(intrinsics.height + 2);
  for (auto* values : {&node_.direction_x, &node_.direction_y, &node_.origin_x, &node_.origin_y}) values->assign(count, 0.f);
  origin_z_ = port ? static_cast<float>(port->distance_m + port->thickness_m) : 0.f;
  for (int v = -1; v <= intrinsics.height; ++v) {
    CameraRay ray;
    for (int u = -1; u <= padded_width; ++u) {
      if (const auto found = camera_ray(intrinsics, port, u, v)) {
        ray = *found;
      } else if (u >= -1 && u <= intrinsics.width) {
        throw InputError("camera: the distortion folds over or the port reflects inside the image, at pixel " + std::to_string(u) + ", " +
                         std::to_string(v));
      }
      const std::size_t i = index(u, v);
      node_.direction_x[i] = static_cast<float>(ray.direction.x());
      node_.direction_y[i] = static_cast<float>(ray.direction.y());
      node_.origin_x[i] = static_cast<float>(ray.origin.x());
      node_.origin_y[i] = static_cast<float>(ray.origin.y());
    }
  }
}

// slopes: d/du and d/dv of direction x, y, then of origin x, y.
RayPacket CameraRays::to_base(const CameraPlace& place, const Lanes3& origin, const Lanes3& direction,
                              const std::array<Lanes, 8>& slopes) const {
  const Rotation& rotation = place.rotation;
  RayPacket rays;
  rays.origin = place.position;
  rays.direction = rotation * direction;
  rays.direction_du = rotation.column_x * slopes[0] + rotation.column_y * slopes[1];
  rays.direction_dv = rotation.column_x * slopes[2] + rotation.column_y * slopes[3];
  if (port_) {
    rays.origin = rays.origin + rotation * origin;
    rays.origin_du = rotation.column_x * slopes[4] + rotation.column_y * slopes[5];
    rays.origin_dv = rotation.column_x * slopes[6] + rotation.column_y * slopes[7];
  }
  return rays;
}

RayPacket CameraRays::row(const CameraPlace& place, int u, int v) const {
  const std::size_t i = index(u, v);
  const auto at = [](const std::vector<float>& values, std::size_t k) { return load_lanes(values.data() + k); };
  const auto slope_u = [&](const std::vector<float>& values) { return 0.5f * (at(values, i + 1) - at(values, i - 1)); };
  const auto slope_v = [&](const std::vector<float>& values) { return 0.5f * (at(values, i + stride_) - at(values, i - stride_)); };
  std::array<Lanes, 8> slopes{slope_u(node_.direction_x), slope_u(node_.direction_y), slope_v(node_.direction_x),
                              slope_v(node_.direction_y)};
  Lanes3 origin;
  if (port_) {
    slopes[4] = slope_u(node_.origin_x), slopes[5] = slope_u(node_.origin_y);
    slopes[6] = slope_v(node_.origin_x), slopes[7] = slope_v(node_.origin_y);
    origin = {at(node_.origin_x, i), at(node_.origin_y, i), all_lanes(origin_z_)};
  }
  return to_base(place, origin, {at(node_.direction_x, i), at(node_.direction_y, i), all_lanes(1.f)}, slopes);
}

RayLines CameraRays::lines(const CameraPlace& place, int u, int v) const {
  const std::size_t i = index(u, v);
  const auto at = [i](const std::vector<float>& values) { return load_lanes(values.data() + i); };
  RayLines rays{place.position, place.rotation * Lanes3{at(node_.direction_x), at(node_.direction_y), all_lanes(1.f)}};
  if (port_) rays.origin = rays.origin + place.rotation * Lanes3{at(node_.origin_x), at(node_.origin_y), all_lanes(origin_z_)};
  return rays;
}

RayPacket CameraRays::shifted_row(const CameraPlace& place, int u, int v, Lanes offset_v) const {
  const std::size_t i = index(u, v);
  const auto values = [](const std::vector<float>& f, std::size_t k) { return load_lanes(f.data() + k); };
  const auto at = [&](const std::vector<float>& f) {
    const Lanes above = values(f, i - stride_), here = values(f, i), below = values(f, i + stride_);
    return here + offset_v * (0.5f * (below - above) + (0.5f * (below + above) - here) * offset_v);
  };
  RayPacket rays = row(place, u, v);
  const Rotation& rotation = place.rotation;
  rays.direction = rotation * Lanes3{at(node_.direction_x), at(node_.direction_y), all_lanes(1.f)};
  if (port_) rays.origin = place.position + rotation * Lanes3{at(node_.origin_x), at(node_.origin_y), all_lanes(origin_z_)};
  return rays;
}

RayPacket CameraRays::around(const CameraPlace& place, int u, int v, Lanes offset_u, Lanes offset_v) const {
  const std::size_t i = index(u, v);
  // Second order along each axis: a distorted ray's third-order rest over half a pixel is below 1e-8.
  const auto at = [&](const std::vector<float>& f) {
    const float curve_u = 0.5f * (f[i + 1] + f[i - 1]) - f[i], curve_v = 0.5f * (f[i + stride_] + f[i - stride_]) - f[i];
    return f[i] + offset_u * (0.5f * (f[i + 1] - f[i - 1]) + curve_u * offset_u) +
           offset_v * (0.5f * (f[i + stride_] - f[i - stride_]) + curve_v * offset_v);
  };
  const auto slope_u = [&](const std::vector<float>& f) { return all_lanes(0.5f * (f[i + 1] - f[i - 1])); };
  const auto slope_v = [&](const std::vector<float>& f) { return all_lanes(0.5f * (f[i + stride_] - f[i - stride_])); };
  std::array<Lanes, 8> slopes{slope_u(node_.direction_x), slope_u(node_.direction_y), slope_v(node_.direction_x),
                              slope_v(node_.direction_y)};
  Lanes3 origin;
  if (port_) {
    slopes[4] = slope_u(node_.origin_x), slopes[5] = slope_u(node_.origin_y);
    slopes[6] = slope_v(node_.origin_x), slopes[7] = slope_v(node_.origin_y);
    origin = {at(node_.origin_x), at(node_.origin_y), all_lanes(origin_z_)};
  }
  return to_base(place, origin, {at(node_.direction_x), at(node_.direction_y), all_lanes(1.f)}, slopes);
}

// Newton's method on the table of rays: it has distortion and port in it.
std::optional<Vec2> CameraRays::project(const Vec3& point_m) const {
  const double z = point_m.z() - static_cast<double>(origin_z_);
  if (z < 1e-3) return std::nullopt;
  // From the pinhole's image on.
  double u = std::clamp(fx_ * point_m.x() / point_m.z() + cx_, 0.0, width_ - 1.0),
         v = std::clamp(fy_ * point_m.y() / point_m.z() + cy_, 0.0, height_ - 1.0);
  int column = -1, row = -1;
  for (int i = 0; i < 6; ++i) {
    const int last_column = std::exchange(column, std::clamp(static_cast<int>(std::lround(u)), 0, width_ - 1)),
              last_row = std::exchange(row, std::clamp(static_cast<int>(std::lround(v)), 0, height_ - 1));
    if (column == last_column && row == last_row) break;  // the next step is this one
    const std::size_t at = index(column, row);
    // Where the pixel's ray is at that depth, and how far that is from one pixel to the next.
    const auto reached = [&](const std::vector<float>& direction, const std::vector<float>& origin, std::size_t k) {
      return static_cast<double>(origin[k]) + z * static_cast<double>(direction[k]);
    };
    const double x = reached(node_.direction_x, node_.origin_x, at), y = reached(node_.direction_y, node_.origin_y, at);
    const double x_u = 0.5 * (reached(node_.direction_x, node_.origin_x, at + 1) - reached(node_.direction_x, node_.origin_x, at - 1));
    const double y_v =
        0.5 * (reached(node_.direction_y, node_.origin_y, at + stride_) - reached(node_.direction_y, node_.origin_y, at - stride_));
    u = column + (point_m.x() - x) / x_u, v = row + (point_m.y() - y) / y_v;
    if (std::abs(u) > 3 * width_ || std::abs(v) > 3 * height_) return std::nullopt;
  }
  const double margin = 16;  // of what reaches into the image
  if (u < -margin || v < -margin || u > width_ - 1 + margin || v > height_ - 1 + margin) return std::nullopt;
  return Vec2(u, v);
}

}  // namespace lf::optics
