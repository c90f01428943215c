#include "shared/urdf/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "shared/input_error.hpp"

namespace lf::urdf {
namespace {

template <class Named>
std::optional<std::size_t> find(const std::vector<Named>& all, std::string_view name) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return i;
  return std::nullopt;
}

template <class Named>
std::size_t find_or_refuse(const Mechanism& mechanism, const std::vector<Named>& all, const char* what, std::string_view name) {
  if (const auto found = find(all, name)) return *found;
  constexpr std::size_t most = 16;  // names fit one screen
  std::string message = std::string("has no ") + what + " '" + std::string(name) + "'";
  for (std::size_t i = 0; i < std::min(all.size(), most); ++i) message.append(i == 0 ? "; it has " : ", ").append(all[i].name);
  if (all.size() > most) message += " and " + std::to_string(all.size() - most) + " more";
  throw InputError(mechanism.file, 0, message);
}

Vec3 signed_axis(std::string_view word) {
  const bool negative = !word.empty() && word.front() == '-';
  const std::string_view letter = negative ? word.substr(1) : word;
  const std::size_t axis = letter.size() == 1 ? std::string_view("xyz").find(letter) : std::string_view::npos;
  if (axis == std::string_view::npos) throw InputError("'" + std::string(word) + "' is no axis: write x, y, z, -x, -y or -z");
  return (negative ? -1 : 1) * Vec3::Unit(static_cast<Eigen::Index>(axis));
}

}  // namespace

std::optional<double> Extension::number(std::string_view key) const {
  for (const auto& [name, value] : numbers)
    if (name == key) return value;
  return std::nullopt;
}

Pose Joint::parent_from_child(double q) const {
  Pose pose = parent_from_joint;
  if (type == JointType::prismatic)
    pose.translate(q * axis);
  else if (type != JointType::fixed)
    pose.rotate(Eigen::AngleAxisd(q, axis));
  return pose;
}

std::optional<std::size_t> Mechanism::find_link(std::string_view wanted) const { return find(links, wanted); }
std::optional<std::size_t> Mechanism::find_joint(std::string_view wanted) const { return find(joints, wanted); }
std::size_t Mechanism::link(std::string_view wanted) const { return find_or_refuse(*this, links, "link", wanted); }
std::size_t Mechanism::joint(std::string_view wanted) const { return find_or_refuse(*this, joints, "joint", wanted); }

std::optional<std::size_t> Mechanism::joint_of(std::size_t link) const {
  if (link == root) return std::nullopt;
  return link - 1;
}

std::vector<Step> Mechanism::path(std::size_t from, std::size_t to) const {
  std::vector<Step> inward, outward;
  // A parent's index is below its child's: the higher of the two cannot be an ancestor of the other, so it is the one to leave.
  while (from != to) {
    const std::size_t joint = std::max(from, to) - 1;
    if (from > to) {
      inward.push_back({joint, false});
      from = joints[joint].parent;
    } else {
      outward.push_back({joint, true});
      to = joints[joint].parent;
    }
  }
  inward.insert(inward.end(), outward.rbegin(), outward.rend());
  return inward;
}

std::vector<std::size_t> Mechanism::free_joints(const std::vector<Step>& path) const {
  std::vector<std::size_t> result;
  for (const Step& step : path)
    if (joints[step.joint].moves() && !joints[step.joint].mimic) result.push_back(step.joint);
  return result;
}

Mimic Mechanism::driver(std::size_t joint) const {
  Mimic result{joint, 1, 0};
  while (const auto& mimic = joints[result.joint].mimic) {
    result.offset += result.multiplier * mimic->offset;
    result.multiplier *= mimic->multiplier;
    result.joint = mimic->joint;
  }
  return result;
}

Mat3 tool_axes(std::string_view approach, std::string_view opening) {
  const Vec3 z = signed_axis(approach), x = signed_axis(opening);
  if (std::abs(z.dot(x)) > 0.5)
    throw InputError("approach '" + std::string(approach) + "' and opening '" + std::string(opening) +
                     "' lie on one line: they have to be square to each other");
  Mat3 link_from_tool;
  link_from_tool << x, z.cross(x), z;
  return link_from_tool;
}

}  // namespace lf::urdf
