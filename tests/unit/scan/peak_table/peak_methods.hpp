// Five ways to a stripe's row in each column of a picture: the project's, which is told nothing of the stripe, and the field's, which are told its true width.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "tests/unit/scan/formed_stripe.hpp"

namespace lf::test {

inline constexpr std::array<const char*, 5> method_names{"detector + fit", "centre of mass", "LoG 2.83", "product", "Steger"};

// By column; NaN: no peak.
using Rows = std::vector<double>;

// Pixels as a camera gives them: whole grey levels up to the full scale. `has_off` false: `off` is not to be looked at.
struct Shot {
  FormedImage image;
  bool has_off = true;
  int full_scale = 255;
};

// Detector and refiner as `lanternfish peaks` has them. Remembers from picture to picture what the refiner has learned.
class DetectorAndFit {
 public:
  explicit DetectorAndFit(int full_scale);
  DetectorAndFit(DetectorAndFit&& from) noexcept;
  ~DetectorAndFit();
  Rows rows(const Shot& shot);
  // As the pictures have told.
  double width_px() const;
  double gain() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// The others, in the order of their names. They are told the stripe's sigma and the on picture's exposure over the off picture's. Without an off picture they subtract the column's
// median. Each takes its strongest answer in every column; centre of mass and product begin where the LoG responds most.
std::array<Rows, 4> rows_of_others(const Shot& shot, double stripe_sigma_px, double gain);

}  // namespace lf::test
