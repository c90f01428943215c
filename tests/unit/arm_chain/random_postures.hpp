// Seeded postures of any chain.
#pragma once

#include <random>

#include "firmware/arm/chain/chain.hpp"

namespace lf::chain {

// Seeded postures within a chain's limits.
class RandomPostures {
 public:
  RandomPostures(const Chain& chain, std::uint64_t seed) : chain_(chain), engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  JointValues next() {
    JointValues q = JointValues::Zero();
    for (std::size_t i = 0; i < chain_.size(); ++i)
      q[i] = chain_.joint(i).limited ? uniform(chain_.joint(i).lower, chain_.joint(i).upper) : uniform(-pi, pi);
    return q;
  }
  // Within `width` of `q` on each joint, and within the limits.
  JointValues near(const JointValues& q, double width) {
    JointValues out = q;
    for (std::size_t i = 0; i < chain_.size(); ++i) {
      out[i] += uniform(-width, width);
      out[i] -= chain_.excess(i, out[i]);
    }
    return out;
  }

 private:
  Chain chain_;
  std::mt19937_64 engine_;
};

inline bool within_limits(const Chain& chain, const JointValues& q) {
  for (std::size_t i = 0; i < chain.size(); ++i)
    if (chain.excess(i, q[i]) != 0) return false;
  return q.tail(static_cast<Eigen::Index>(max_joints - chain.size())).isZero(0);
}

}  // namespace lf::chain
