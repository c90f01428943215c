// Tests of any arm: one that a URDF describes, its path in the sources the parameter, and numbers drawn with one seed.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <random>
#include <string>

#include "firmware/arm/kinematics.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"

namespace lf::arm {

class ArmOfFile : public testing::TestWithParam<const char*> {
 protected:
  static constexpr std::uint64_t seed = 20261128;

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 direction() { return Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized(); }

  // Well within the limits: up to this share of half of each stroke from its middle.
  JointVector draw(double share = 0.9) {
    JointVector q = JointVector::Zero();
    for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
      const double middle = (arm.joint(i).lower_rad + arm.joint(i).upper_rad) / 2,
                   half = (arm.joint(i).upper_rad - arm.joint(i).lower_rad) / 2;
      q[static_cast<Eigen::Index>(i)] = middle + uniform(-share, share) * half;
    }
    return q;
  }

  ArmDescription description = load_arm_urdf(std::string(LANTERNFISH_SOURCE_DIR "/") + GetParam());
  Arm arm{make_model(description)};

 private:
  std::mt19937_64 random_{seed};
};

}  // namespace lf::arm
