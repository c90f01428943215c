#include "firmware/scan/camera_model.hpp"

#include <Eigen/LU>
#include <cmath>

namespace lf::scan {
namespace {

struct Distorted {
  Vec2 point;
  Eigen::Matrix2d jacobian;  // of `point` by the undistorted one
};

// Brown-Conrady at the undistorted, normalised image point (x, y).
Distorted distort(const std::array<double, 5>& d, const Vec2& p) {
  const auto& [k1, k2, p1, p2, k3] = d;
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3));  // d radial / d x = slope x
  Distorted out;
  out.point.x() = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  out.point.y() = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  out.jacobian(0, 0) = radial + slope * x * x + 2 * p1 * y + 6 * p2 * x;
  out.jacobian(0, 1) = slope * x * y + 2 * p1 * x + 2 * p2 * y;
  out.jacobian(1, 0) = out.jacobian(0, 1);
  out.jacobian(1, 1) = radial + slope * y * y + 6 * p1 * y + 2 * p2 * x;
  return out;
}

}  // namespace

std::optional<Vec3> CameraModel::ray(const Vec2& pixel) const {
  const CameraIntrinsics& c = intrinsics_;
  const Vec2 target((pixel.x() - c.cx) / c.fx, (pixel.y() - c.cy) / c.fy);
  if (!target.allFinite()) return std::nullopt;
  Vec2 p = target;
  for (int step = 0; step < 20; ++step) {
    const Distorted at = distort(c.distortion, p);
    const Vec2 error = target - at.point;
    if (error.squaredNorm() < 1e-24) return Vec3(p.x(), p.y(), 1).normalized();
    const double determinant = at.jacobian.determinant();
    // Past the circle where the distortion folds the image over, no ray or two belong to a pixel.
    if (!(determinant > 1e-6)) return std::nullopt;
    p += at.jacobian.inverse() * error;
    if (!p.allFinite() || p.squaredNorm() > 1e4) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<Vec2> CameraModel::project(const Vec3& point_m) const {
  if (!point_m.allFinite() || !(point_m.z() > 0)) return std::nullopt;
  const CameraIntrinsics& c = intrinsics_;
  const Vec2 p = distort(c.distortion, Vec2(point_m.x() / point_m.z(), point_m.y() / point_m.z())).point;
  return Vec2(c.fx * p.x() + c.cx, c.fy * p.y() + c.cy);
}

double CameraModel::stretch(const Vec2& at) const { return distort(intrinsics_.distortion, at).jacobian.determinant(); }

}  // namespace lf::scan
