// Arms that nobody builds, made at random by seed: slides among the joints, seven and eight joints, wrists whose axes do not meet.
#pragma once

#include <random>

#include "tests/unit/arm_chain/real_arms.hpp"

namespace lf::chain {

enum class Make : std::uint8_t {
  slides,        // three to eight joints, one to three of them slides
  seven,         // 7R
  eight,         // eight joints, every second time with a rail before them
  offset_wrist,  // 6R: joints 2 to 4 parallel, 5 and 6 pass each other by 20 to 80 mm
  crooked_six,   // 6R without any order
};
inline constexpr Make makes[] = {Make::slides, Make::seven, Make::eight, Make::offset_wrist, Make::crooked_six};
inline const char* name(Make make) {
  constexpr const char* names[] = {"Slides", "Seven", "Eight", "OffsetWrist", "CrookedSix"};
  return names[static_cast<int>(make)];
}
inline void PrintTo(Make make, std::ostream* out) { *out << name(make); }

class RandomArms {
 public:
  RandomArms(Make make, std::uint64_t seed) : make_(make), engine_(seed) {}

  RealArm next() {
    RealArm arm;
    arm.name = std::string(name(make_)) + " " + std::to_string(++count_);
    switch (make_) {
      case Make::slides: {
        const int joints = 3 + pick(6);
        for (int i = 0; i < joints; ++i) arm.joints.push_back(revolute());
        for (int i = 0; i <= pick(3); ++i) arm.joints[static_cast<std::size_t>(pick(joints))] = slide(0.1, 0.8);
        break;
      }
      case Make::seven:
        for (int i = 0; i < 7; ++i) arm.joints.push_back(revolute());
        break;
      case Make::eight:
        for (int i = 0; i < 8; ++i) arm.joints.push_back(revolute());
        if (count_ % 2 == 0) arm.joints.front() = slide(1, 4);
        break;
      case Make::offset_wrist: arm.joints = offset_wrist(); break;
      case Make::crooked_six:
        for (int i = 0; i < 6; ++i) arm.joints.push_back(revolute());
        break;
    }
    arm.joints.push_back({UrdfJoint::Kind::fixed, somewhere(0.1), turns()});
    return arm;
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  int pick(int count) { return static_cast<int>(uniform(0, count)); }
  Vec3 somewhere(double most_m) { return {uniform(-most_m, most_m), uniform(-most_m, most_m), uniform(-most_m, most_m)}; }
  // Mostly right angles, as drawings have them.
  Vec3 turns() {
    if (pick(4) == 0) return {uniform(-pi, pi), uniform(-1.5, 1.5), uniform(-pi, pi)};
    return Vec3(pick(4) - 1, pick(3) - 1, pick(4) - 1) * (pi / 2);
  }
  Vec3 axis() {
    if (pick(4) == 0) return (somewhere(1) + Vec3(0, 0, 2)).normalized();
    return (pick(2) == 0 ? 1 : -1) * Vec3::Unit(pick(3));
  }
  UrdfJoint revolute() {
    const double lower = uniform(-3, 0);
    const auto kind = pick(7) == 0 ? UrdfJoint::Kind::continuous : UrdfJoint::Kind::revolute;
    return {kind, somewhere(0.3), turns(), axis(), lower, lower + uniform(1, 2 * pi)};
  }
  UrdfJoint slide(double least_m, double most_m) {
    const double lower = uniform(-0.3, 0.1);
    return {UrdfJoint::Kind::prismatic, somewhere(0.3), turns(), axis(), lower, lower + uniform(least_m, most_m)};
  }
  std::vector<UrdfJoint> offset_wrist() {
    const double limit = uniform(pi, 2 * pi), apart_m = uniform(0.02, 0.08);
    const auto joint = [&](const Vec3& xyz, const Vec3& rpy) {
      return UrdfJoint{UrdfJoint::Kind::revolute, xyz, rpy, Vec3::UnitZ(), -limit, limit};
    };
    return {joint({0, 0, 0.1}, {0, 0, 0}),
            joint({0, 0, 0}, {pi / 2, 0, 0}),
            joint({-uniform(0.2, 0.5), 0, 0}, {0, 0, 0}),
            joint({-uniform(0.2, 0.5), 0, uniform(0.05, 0.15)}, {0, 0, 0}),
            joint({0, -uniform(0.05, 0.15), 0}, {pi / 2, 0, 0}),
            joint({apart_m, uniform(0.05, 0.15), 0}, {-pi / 2, 0, 0})};
  }

  Make make_;
  std::mt19937_64 engine_;
  int count_ = 0;
};

}  // namespace lf::chain
