// A Gaussian as a filter of whole pixels.
#pragma once

#include <array>

namespace lf::optics {

// Symmetric, of sum 1. Its variance is sigma^2 within 1e-4 for every sigma, sampling and cutting off made good for: variances of filters in a row then add up.
struct GaussianTaps {
  static constexpr int most = 16;           // of the radius
  static constexpr double widest_px = 4.5;  // of the sigma: 3.5 of it fit in
  int radius = 0;                           // 0: leaves a picture as it is
  std::array<float, most + 1> tap{};        // tap[k] for the pixels k away on both sides

  // `sigma_px` from 0 to `widest_px`, where it is held: a wider one belongs on a coarser picture.
  static GaussianTaps of(double sigma_px);
};

}  // namespace lf::optics
