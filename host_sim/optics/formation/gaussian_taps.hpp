// A Gaussian as a filter of whole pixels.
#pragma once

#include <array>

namespace lf::optics {

// Symmetric, sum 1, and its variance is sigma^2 to the last digits whatever sigma: filters add their variances, so widths can be reckoned with.
struct GaussianTaps {
  static constexpr int most = 16;
  int radius = 0;                     // 0: leaves a picture as it is
  std::array<float, most + 1> tap{};  // tap[k] for the pixels k away on both sides

  // `sigma_px` from 0 to 4.5; wider ones belong on a coarser picture, and are held at 4.5.
  static GaussianTaps of(double sigma_px);
};

}  // namespace lf::optics
