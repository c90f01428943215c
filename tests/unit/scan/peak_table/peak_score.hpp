// How well a method's rows match the truth, as a cell of the table.
#pragma once

#include <string>
#include <vector>

namespace lf::test {

class PeakScore {
 public:
  // A peak further from the truth than `false_beyond_px` is false, and out of rms and percentile. NaN: none was found.
  void add(double row, double truth, double false_beyond_px);

  double rms_px() const;
  double percentile_999_px() const;  // of the errors' size: of n errors the one at n * 0.999, rounded up
  double recall() const;             // right ones over all columns
  double false_share() const;        // the same of the false ones

  // "rms / 99.9th percentile / recall % / false %".
  std::string cell() const;

 private:
  std::vector<double> errors_;
  int columns_ = 0, false_ = 0;
};

}  // namespace lf::test
