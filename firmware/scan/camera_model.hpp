// The camera: from pixels to rays and back, pinhole with Brown-Conrady distortion (Brown 1966; OpenCV's k1 k2 p1 p2 k3).
#pragma once

#include <optional>

#include "shared/calibration/calibration.hpp"

namespace lf::scan {

class CameraModel {
 public:
  explicit CameraModel(const CameraIntrinsics& intrinsics) : intrinsics_(intrinsics) {}

  // The unit ray of a pixel in the camera frame. Newton's method to 1e-12, at most 20 steps; nothing where it does not converge (a pixel that
  // no ray is imaged to) or where the pixel is not a number.
  std::optional<Vec3> ray(const Vec2& pixel) const;

  // The pixel of a point in the camera frame; nothing for points not in front of the camera. The pixel may lie outside of the image.
  std::optional<Vec2> project(const Vec3& point_m) const;

  // How much larger than without distortion an area about the ray (x, y, 1) is imaged: the determinant of the distortion's derivatives. Zero where the picture
  // folds over, negative beyond.
  double stretch(const Vec2& at) const;

  const CameraIntrinsics& intrinsics() const { return intrinsics_; }

 private:
  CameraIntrinsics intrinsics_;
};

}  // namespace lf::scan
