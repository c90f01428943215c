// A mean over the newest points: one counts about exp(-a) times as much as the newest, where `a` is the points since over `over_points`. Right from the first point on.
#pragma once

namespace lf::scan {

class LateMean {
 public:
  explicit constexpr LateMean(double over_points) : over_points_(over_points) {}

  // `points` more that share a value.
  constexpr void add(double value, double points) {
    const double kept = over_points_ / (points + over_points_);
    sum_ = kept * sum_ + (1 - kept) * value;
    weight_ = kept * weight_ + (1 - kept);
  }
  // 0 before the first point.
  constexpr double mean() const { return weight_ > 0 ? sum_ / weight_ : 0; }

 private:
  double over_points_;
  double sum_ = 0, weight_ = 0;
};

}  // namespace lf::scan
