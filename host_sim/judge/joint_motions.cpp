#include "host_sim/judge/joint_motions.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/judge/report_deadline.hpp"

namespace lf::judge {

namespace {

// Bodies that press on each other quiver to and fro, by less than 0.4 mrad.
constexpr std::ptrdiff_t quiver_ms = 10;
// After its power went: 20 ms were seen.
constexpr std::ptrdiff_t settling_ms = 50;

std::size_t bit_of(std::size_t joint) { return std::size_t{1} << joint; }

}  // namespace

double JointMotions::time_s(const Moment& moment) const { return static_cast<double>(&moment - moments_.data()) * ms; }

double JointMotions::motor_speed_rad_s(std::size_t index, std::size_t joint) const {
  constexpr std::size_t over_ms = 10;
  if (index < over_ms) return 0;
  return std::abs(double(moments_[index].motor_rad[joint]) - double(moments_[index - over_ms].motor_rad[joint])) / (over_ms * ms);
}

bool JointMotions::moves(const Moment& moment, std::size_t joint, double unwound_s) const {
  if (motor_moves(moment, joint) && !settles_without_power(moment, joint) && !pushed_without_power(moment, joint)) return true;
  if (moment.speed_rad_s[joint] < figures_.standing_rad_s || pushed_at(moment) || !travels_in(moment, quiver_ms, &Moment::angle_rad, joint))
    return false;
  if (std::abs(moment.angle_rad[joint] - moment.motor_rad[joint]) > situation_.gear_gives_rad[joint]) return true;
  if (time_s(moment) <= unwound_s) return false;
  const double stood_rad = moments_[std::min(static_cast<std::size_t>(unwound_s / ms), moments_.size() - 1)].angle_rad[joint];
  return std::abs(moment.angle_rad[joint] - stood_rad) > figures_.quivers_rad;
}

bool JointMotions::gives_way(const Moment& moment, std::size_t joint, double unwound_s) const {
  // One that has power may drag the others.
  if (moment.power != 0 || moment.grip_n < figures_.touch_n || motor_moves(moment, joint)) return false;
  const double gives_rad = situation_.gear_gives_rad[joint];
  if (std::abs(moment.angle_rad[joint] - moment.motor_rad[joint]) > gives_rad) return false;
  const auto by_angle = [joint](const Moment& a, const Moment& b) { return a.angle_rad[joint] < b.angle_rad[joint]; };
  const auto from =
      std::min(moments_.begin() + static_cast<std::ptrdiff_t>(unwound_s / ms), moments_.begin() + (&moment - moments_.data()));
  const auto [low, high] = std::minmax_element(from, moments_.begin() + (&moment - moments_.data()) + 1, by_angle);
  return double(high->angle_rad[joint]) - double(low->angle_rad[joint]) <= gives_rad;
}

bool JointMotions::swings(const Moment& moment, JointBits joints) const {
  for (std::size_t joint = 0; joint < situation_.names.size(); ++joint) {
    const bool fast = (joints & bit_of(joint)) != 0 && moment.speed_rad_s[joint] >= figures_.standing_rad_s;
    if (fast && travels_in(moment, quiver_ms, &Moment::angle_rad, joint)) return true;
  }
  return false;
}

bool JointMotions::travels(std::size_t from) const {
  const double least_rad = figures_.standing_rad_s * static_cast<double>(moments_.size() - from) * ms;
  for (std::size_t joint = 0; joint < situation_.names.size(); ++joint) {
    const auto by_angle = [joint](const Moment& a, const Moment& b) { return a.angle_rad[joint] < b.angle_rad[joint]; };
    const auto [low, high] = std::minmax_element(moments_.begin() + std::ptrdiff_t(from), moments_.end(), by_angle);
    if (high->angle_rad[joint] - low->angle_rad[joint] > least_rad) return true;
  }
  return false;
}

bool JointMotions::travels_in(const Moment& moment, std::ptrdiff_t around_ms, const PerJoint<float> Moment::*rad, std::size_t joint) const {
  const std::ptrdiff_t index = &moment - moments_.data(), size = std::ssize(moments_);
  const auto by_angle = [&](const Moment& a, const Moment& b) { return (a.*rad)[joint] < (b.*rad)[joint]; };
  const auto [low, high] = std::minmax_element(moments_.begin() + std::max<std::ptrdiff_t>(0, index - around_ms),
                                               moments_.begin() + std::min(size, index + around_ms + 1), by_angle);
  return ((*high).*rad)[joint] - ((*low).*rad)[joint] >= figures_.standing_rad_s * 2 * static_cast<double>(around_ms) * ms;
}

bool JointMotions::motor_moves(const Moment& moment, std::size_t joint) const { return travels_in(moment, 1, &Moment::motor_rad, joint); }

bool JointMotions::settles_without_power(const Moment& moment, std::size_t joint) const {
  constexpr std::ptrdiff_t seen_before_ms = 10;
  const std::ptrdiff_t index = &moment - moments_.data(), size = std::ssize(moments_);
  for (auto t = std::max<std::ptrdiff_t>(1, index - settling_ms); t < std::min(size, index + seen_before_ms + 1); ++t) {
    const Moment &before = moments_[t - 1], &after = moments_[t];
    if ((before.power & bit_of(joint)) == 0 || (after.power & bit_of(joint)) != 0) continue;
    return stood_before(before, joint) && std::abs(moment.motor_rad[joint] - before.motor_rad[joint]) <= situation_.slips_rad[joint];
  }
  return false;
}

bool JointMotions::pushed_without_power(const Moment& moment, std::size_t joint) const {
  if ((moment.power & bit_of(joint)) != 0 || !pushed_at(moment)) return false;
  const Moment* off = &moment;
  while (off != moments_.data() && ((off - 1)->power & bit_of(joint)) == 0) --off;
  const Moment* settled = off + std::min<std::ptrdiff_t>(settling_ms, &moment - off);
  return stood_before(*off, joint) && std::abs(moment.motor_rad[joint] - settled->motor_rad[joint]) <= figures_.quivers_rad;
}

bool JointMotions::stood_before(const Moment& moment, std::size_t joint) const {
  constexpr std::ptrdiff_t stood_ms = 20;
  const Moment& earlier = moments_[static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, &moment - moments_.data() - stood_ms))];
  return std::abs(moment.motor_rad[joint] - earlier.motor_rad[joint]) < figures_.standing_rad_s * stood_ms * ms;
}

bool JointMotions::pushed_at(const Moment& moment) const {
  if (moment.push_n <= 0) return false;
  for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
    if (situation_.causes[i].rule->kind == "obstacle" && situation_.begins_s[i] <= time_s(moment)) return true;
  }
  return false;
}

}  // namespace lf::judge
