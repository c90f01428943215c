#include "firmware/scan/speckle_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace lf::scan {
namespace {

constexpr std::uint32_t enough = 14;  // two blocks of eight columns
// Grains wider than a pixel, as small apertures make them, set the heights of columns apart by more than the contrast of their pixels: 0.6 where it is 0.33.
// Beyond 0.5 the weights hardly change.
constexpr float least = 0.01f, most = 0.5f;

}  // namespace

void SpeckleEstimate::add(const SpeckleVariances& variances) {
  for (const float variance : variances) variances_[seen_++ % kept] = variance;
}

float SpeckleEstimate::contrast_or(float otherwise) const {
  if (seen_ < enough) return otherwise;
  std::array<float, kept> sorted = variances_;
  const auto end = sorted.begin() + std::min(seen_, kept), middle = sorted.begin() + std::min(seen_, kept) / 2;
  std::nth_element(sorted.begin(), middle, end);
  return std::sqrt(std::clamp(*middle, least * least, most * most));
}

}  // namespace lf::scan
