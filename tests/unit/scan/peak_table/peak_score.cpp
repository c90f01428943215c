#include "tests/unit/scan/peak_table/peak_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lf::test {

void PeakScore::add(double row, double truth, double false_beyond_px) {
  ++columns_;
  if (std::isnan(row)) return;
  const double error = row - truth;
  if (std::abs(error) > false_beyond_px) {
    ++false_;
  } else {
    errors_.push_back(error);
  }
}

double PeakScore::rms_px() const {
  double squares = 0;
  for (const double error : errors_) squares += error * error;
  return errors_.empty() ? 0 : std::sqrt(squares / static_cast<double>(errors_.size()));
}

double PeakScore::percentile_999_px() const {
  if (errors_.empty()) return 0;
  std::vector<double> sizes;
  for (const double error : errors_) sizes.push_back(std::abs(error));
  std::sort(sizes.begin(), sizes.end());
  return sizes[static_cast<std::size_t>(std::ceil(0.999 * static_cast<double>(sizes.size()))) - 1];
}

double PeakScore::recall() const { return columns_ == 0 ? 0 : static_cast<double>(errors_.size()) / columns_; }

double PeakScore::false_share() const { return columns_ == 0 ? 0 : static_cast<double>(false_) / columns_; }

std::string PeakScore::cell() const {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f / %.2f / %.1f / %.1f", rms_px(), percentile_999_px(), 100 * recall(), 100 * false_share());
  return text.data();
}

}  // namespace lf::test
