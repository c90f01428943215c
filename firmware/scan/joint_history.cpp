#include "firmware/scan/joint_history.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lf::scan {
namespace {

// Two missed SYNCs in a row are a lost frame or two; three leave 12 ms without a reading, and the drives' own watchdog trips.
constexpr Duration max_gap = can_map::sync_period * 3;

}  // namespace

const JointSample& JointHistory::sample(std::size_t age) const { return ring_[(next_ + capacity - size_ + age) % capacity]; }

bool JointHistory::add(const JointSample& sample_in) {
  if (!std::all_of(sample_in.q_rad.begin(), sample_in.q_rad.end(), [](double q) { return std::isfinite(q); })) return false;
  if (size_ > 0 && sample_in.t <= sample(size_ - 1).t) return false;
  ring_[next_] = sample_in;
  next_ = (next_ + 1) % capacity;
  size_ = std::min(size_ + 1, capacity);
  return true;
}

auto JointHistory::at(Time t, bool final, PerArmJoint<double>& q_rad) const -> Outcome {
  if (size_ == 0 || t > sample(size_ - 1).t) return final ? Outcome::gap : Outcome::wait;
  if (t < sample(0).t) return Outcome::too_old;
  // The first sample after t, by bisection; samples are in the order of their times.
  std::size_t low = 0, high = size_ - 1;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (sample(middle).t < t)
      low = middle + 1;
    else
      high = middle;
  }
  const std::size_t after = low;
  if (!final && size_ - after < static_cast<std::size_t>(half_window)) return Outcome::wait;
  if (after > 0 && sample(after).t - sample(after - 1).t > max_gap) return Outcome::gap;

  std::size_t first = after, last = after;
  while (first > 0 && after - first < static_cast<std::size_t>(half_window) && sample(first).t - sample(first - 1).t <= max_gap) --first;
  while (last + 1 < size_ && last + 1 - after < static_cast<std::size_t>(half_window) && sample(last + 1).t - sample(last).t <= max_gap)
    ++last;
  fit(first, last, t, q_rad);
  return Outcome::done;
}

// Least squares of 1, x, x^2 over the samples `first` to `last`, x their time from `t` in units of the half window: the joint at t is the first
// coefficient, a weighted mean of the samples. With fewer than five samples, or most on one side of t, a parabola would extrapolate noise: a
// straight line then.
void JointHistory::fit(std::size_t first, std::size_t last, Time t, PerArmJoint<double>& q_rad) const {
  const double unit_s = (can_map::sync_period * half_window).s();
  const auto place = [&](std::size_t i) { return (sample(i).t - t).s() / unit_s; };
  std::array<double, 5> moments{};  // sums of x^0 .. x^4
  for (std::size_t i = first; i <= last; ++i)
    for (double power = 1; double& moment : moments) {
      moment += power;
      power *= place(i);
    }
  const auto& [m0, m1, m2, m3, m4] = moments;
  Vec3 weights(1 / m0, 0, 0);  // of 1, x, x^2 in a sample's share
  if (m0 >= 5 && std::abs(m1) < 0.25 * m0) {
    Mat3 normal;
    normal << m0, m1, m2, m1, m2, m3, m2, m3, m4;
    weights = normal.inverse().col(0);
  } else if (m0 >= 2) {
    const double determinant = m0 * m2 - m1 * m1;
    weights = Vec3(m2, -m1, 0) / determinant;
  }
  q_rad = {};
  for (std::size_t i = first; i <= last; ++i) {
    const double x = place(i);
    const double share = weights.dot(Vec3(1, x, x * x));
    for (std::size_t j = 0; j < q_rad.size(); ++j) q_rad[j] += share * sample(i).q_rad[j];
  }
}

}  // namespace lf::scan
