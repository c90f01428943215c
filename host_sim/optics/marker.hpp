// AprilTag 36h11 as a texture: black square, code cells, white quiet zone, generated from OpenCV's dictionary.
#pragma once

#include <array>
#include <cstdint>

#include "shared/geometry/pose.hpp"

namespace lf::optics {

class Marker {
 public:
  static constexpr int cells = 8;  // across the black square: 6 of code and the border on each side

  // Throws InputError for an id that 36h11 does not have (0..586).
  Marker(std::int32_t id, double size_m);

  // The white share, 0..1, of the parallelogram with the sides du and dv (m) about p, in the marker's frame: x right, y up, origin its centre.
  float white_share(const Vec2& p, const Vec2& du, const Vec2& dv) const;

 private:
  bool white(double x_m, double y_m) const;

  std::array<std::array<bool, cells>, cells> white_{};  // row 0 on top
  double size_m_;
};

}  // namespace lf::optics
