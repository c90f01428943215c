// Seeded joint angles within the arm's limits.
#pragma once

#include <random>

#include "firmware/arm/kinematics.hpp"
#include "tests/arm5e.hpp"

namespace lf::arm {

class RandomJoints {
 public:
  explicit RandomJoints(std::uint64_t seed, double margin_rad = 0) : engine_(seed), limits_(test::arm5e.limits(margin_rad)) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  JointVector next() {
    JointVector q = JointVector::Zero();
    for (int i = 0; i < 4; ++i) q[i] = uniform(limits_.lower_rad[i], limits_.upper_rad[i]);
    return q;
  }

 private:
  std::mt19937_64 engine_;
  JointLimits limits_;
};

}  // namespace lf::arm
