#include "host_sim/optics/pattern.hpp"

#include <algorithm>
#include <cmath>

#include "shared/input_error.hpp"

namespace lf::optics {

PatternTable::PatternTable(const Pattern& pattern) : geometry_(pattern) {
  geometry_.lit.clear();
  const bool sized = pattern.width > 0 && pattern.height > 0 &&
                     pattern.lit.size() == static_cast<std::size_t>(pattern.width) * static_cast<std::size_t>(pattern.height);
  if (!sized) throw InputError("laser pattern: its pixels do not match its width and height");
  if (!(pattern.fx > 0) || !(pattern.fy > 0)) throw InputError("laser pattern: focal lengths must be positive");
  const std::size_t stride = static_cast<std::size_t>(pattern.width) + 1;
  sums_.assign(stride * (static_cast<std::size_t>(pattern.height) + 1), 0.0);
  for (std::size_t y = 0; y < static_cast<std::size_t>(pattern.height); ++y) {
    double row = 0;
    for (std::size_t x = 0; x + 1 < stride; ++x) {
      row += pattern.lit[y * (stride - 1) + x] != 0;
      sums_[(y + 1) * stride + x + 1] = sums_[y * stride + x + 1] + row;
    }
  }
}

double PatternTable::sum_to(double x, double y) const {
  x = std::clamp(x, 0.0, static_cast<double>(geometry_.width));
  y = std::clamp(y, 0.0, static_cast<double>(geometry_.height));
  const auto column = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(geometry_.width) - 1);
  const auto row = std::min(static_cast<std::size_t>(y), static_cast<std::size_t>(geometry_.height) - 1);
  const std::size_t stride = static_cast<std::size_t>(geometry_.width) + 1, i = row * stride + column;
  const double fx = x - static_cast<double>(column), fy = y - static_cast<double>(row);
  return (1 - fy) * ((1 - fx) * sums_[i] + fx * sums_[i + 1]) + fy * ((1 - fx) * sums_[i + stride] + fx * sums_[i + stride + 1]);
}

float PatternTable::lit_share(float u, float v, float extent_u, float extent_v) const {
  const double x = u + 0.5, y = v + 0.5;  // pixel edges at integers
  const double half_u = 0.5 * std::max(extent_u, 1e-3f), half_v = 0.5 * std::max(extent_v, 1e-3f);
  const double lit =
      sum_to(x + half_u, y + half_v) - sum_to(x - half_u, y + half_v) - sum_to(x + half_u, y - half_v) + sum_to(x - half_u, y - half_v);
  return static_cast<float>(lit / (4 * half_u * half_v));
}

}  // namespace lf::optics
