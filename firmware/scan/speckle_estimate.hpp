// How strongly the laser's light is speckled, as the pictures themselves tell: the median of what neighbouring columns' heights tell of it.
//
// Half of the columns may lie on patterned paint, on edges or on another stripe.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/scan/stripe_fit.hpp"

namespace lf::scan {

class SpeckleEstimate {
 public:
  // Of neighbours that were fitted with the present noise. The newest `kept` count.
  void add(const SpeckleVariances& variances);

  // Standard deviation of a pixel's laser light over its mean; `otherwise` before there are enough neighbours.
  float contrast_or(float otherwise) const;

 private:
  static constexpr std::uint32_t kept = 64;  // neighbours: the median of their variances errs by a fifth, the contrast by a tenth

  std::array<float, kept> variances_{};
  std::uint32_t seen_ = 0;
};

}  // namespace lf::scan
