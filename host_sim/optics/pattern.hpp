// A projector's black and white image, box-filtered to any footprint by a summed-area table.
#pragma once

#include <vector>

#include "host_sim/optics/optics.hpp"

namespace lf::optics {

class PatternTable {
 public:
  // Throws InputError for a pattern whose pixels do not match its size.
  explicit PatternTable(const Pattern& pattern);

  // The lit share (0..1) of the rectangle about image point (u, v) with the given full extents in pixels; outside the image is dark.
  float lit_share(float u, float v, float extent_u, float extent_v) const;

  const Pattern& geometry() const { return geometry_; }
  double unit_plane_area() const { return geometry_.width / geometry_.fx * geometry_.height / geometry_.fy; }

 private:
  double sum_to(double x, double y) const;  // over the image left of x and above y, in pixel-edge coordinates, bilinear

  Pattern geometry_;  // without its pixels
  std::vector<double> sums_;
};

}  // namespace lf::optics
