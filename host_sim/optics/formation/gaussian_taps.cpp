#include "host_sim/optics/formation/gaussian_taps.hpp"

#include <algorithm>
#include <cmath>

namespace lf::optics {
namespace {

constexpr double reach = 3.5;  // standard deviations: 5e-4 of the light lies beyond

// The bell of spread t in whole pixels, and its variance.
double sample_bell(double t, int radius, std::array<double, GaussianTaps::most + 1>& tap) {
  double sum = 0, squares = 0;
  for (int k = 0; k <= radius; ++k) {
    tap[static_cast<std::size_t>(k)] = std::exp(-k * k / (2 * t));
    const double both = (k == 0 ? 1 : 2) * tap[static_cast<std::size_t>(k)];
    sum += both, squares += both * k * k;
  }
  for (int k = 0; k <= radius; ++k) tap[static_cast<std::size_t>(k)] /= sum;
  return squares / sum;
}

}  // namespace

GaussianTaps GaussianTaps::of(double sigma_px) {
  GaussianTaps taps;
  const double sigma = std::clamp(sigma_px, 0.0, widest_px);
  taps.tap[0] = 1;
  if (sigma < 1e-3) return taps;
  taps.radius = std::clamp(static_cast<int>(std::ceil(reach * sigma)), 1, most);
  std::array<double, most + 1> tap{};
  double low = 1e-3, high = 100;  // the spread whose samples have the wanted variance lies between
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (sample_bell(middle, taps.radius, tap) < sigma * sigma ? low : high) = middle;
  }
  std::transform(tap.begin(), tap.end(), taps.tap.begin(), [](double value) { return static_cast<float>(value); });
  return taps;
}

}  // namespace lf::optics
