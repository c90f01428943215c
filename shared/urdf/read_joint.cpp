#include "shared/urdf/read_joint.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace lf::urdf {
namespace {

constexpr double most_strength = 1e9;  // N m or N; the largest slewing drives have 1e7
constexpr double most_speed = 1e6;     // rad/s or m/s

// The name of the link at one end.
std::string end_of(const Element& joint, const char* which) {
  const auto end = joint.needed_child(which, "name the link");
  if (!end) return "";
  end->check({.attributes = {"link"}});
  return end->needed_name("link");
}

void read_type(const Element& e, Joint& joint) {
  const std::string_view type = e.needed_text("type", "write revolute, continuous, prismatic or fixed");
  if (type == "revolute")
    joint.type = JointType::revolute;
  else if (type == "continuous")
    joint.type = JointType::continuous;
  else if (type == "prismatic")
    joint.type = JointType::prismatic;
  else if (type == "fixed")
    joint.type = JointType::fixed;
  else if (type == "floating")
    e.problem("is floating: a base that moves is placed by what uses the mechanism. Make the joint fixed, or remove it with its parent");
  else if (type == "planar")
    e.problem("is planar: write two prismatic joints and a revolute one, with a link between each two");
  else if (!type.empty())
    e.problem("has an unknown type " + shown(type) + ": write revolute, continuous, prismatic or fixed");
}

void read_axis(const Element& e, Joint& joint) {
  const auto axis = e.child("axis");
  if (!axis) {
    if (joint.moves()) e.note("has no axis: it is 1 0 0");
    return;
  }
  axis->check({.attributes = {"xyz"}});
  if (!joint.moves()) {
    axis->note("is not used: the joint is fixed");
    return;
  }
  Vec3 given = Vec3::UnitX();
  if (!axis->numbers("xyz", std::span(given.data(), 3), {-1e6, 1e6, "write a unit vector"})) return;
  const double length = given.norm();
  if (length < 1e-6) {
    axis->problem("has length 0: write the direction about which the joint turns or along which it slides");
    return;
  }
  joint.axis = given / length;
  if (std::abs(length - 1) > 1e-9) axis->note("is no unit vector: its length is " + std::to_string(length) + ". Its direction is used");
}

// Nothing where the file has what stands for "not known".
std::optional<double> rating(const Element& limit, const char* what, double most) {
  const auto value = limit.needed_number(what, {0, most, "write 0 where it is not known"});
  if (!value) return std::nullopt;
  if (*value > 0 && *value != 1000) return value;
  limit.note("has " + std::string(what) + " " + (*value > 0 ? "1000" : "0") +
             ", which stands for \"not known\" in many files: it is taken as not known");
  return std::nullopt;
}

void read_range(const Element& limit, NamedJoint& named) {
  Joint& joint = named.joint;
  const bool slides = joint.type == JointType::prismatic;
  if (!limit.has("lower") && !limit.has("upper")) {
    limit.problem(slides ? "has neither lower nor upper: give them in metres"
                         : "has neither lower nor upper: give them in radians, or make the joint continuous");
    return;
  }
  for (const char* const end : {"lower", "upper"})
    if (!limit.has(end)) limit.note("has no " + std::string(end) + ": it is 0");
  const Bounds bounds = slides ? a_length : Bounds{-most_angle_rad, most_angle_rad, "make a joint without ends continuous"};
  const std::size_t before = limit.report().problems();
  const Range range{limit.number("lower", 0, bounds), limit.number("upper", 0, bounds)};
  if (limit.report().problems() != before) return;
  if (range.lower > range.upper) {
    limit.problem("has lower above upper: exchange them");
    return;
  }
  joint.range = range;
  constexpr double rounding_rad = 0.01;  // many files write a whole turn as 6.28 or 6.2832
  if (!slides && std::max(-range.lower, range.upper) > 2 * pi + rounding_rad)
    limit.note("goes beyond a whole turn. It is taken in radians; were degrees meant?");
  if (range.lower == range.upper) {
    limit.note("has lower = upper: the joint is taken as fixed there");
    joint.parent_from_joint = joint.parent_from_child(range.lower);
    joint.type = JointType::fixed;
    joint.range.reset();
    named.as_fixed = true;
  } else if (!range.holds(0)) {
    limit.note("does not hold 0: the joint cannot stand there");
  }
}

void read_limit(const Element& e, NamedJoint& named) {
  Joint& joint = named.joint;
  const auto limit = e.child("limit");
  if (!limit) {
    if (joint.type == JointType::revolute) e.problem("has no limit: give one, or make the joint continuous");
    if (joint.type == JointType::prismatic) e.problem("has no limit: give one with lower, upper, effort and velocity");
    return;
  }
  limit->check({.attributes = {"lower", "upper", "effort", "velocity"}, .unused_attributes = {"acceleration", "deceleration", "jerk"}});
  if (!joint.moves()) {
    limit->note("is not used: the joint is fixed");
    return;
  }
  if (joint.type != JointType::continuous) {
    read_range(*limit, named);
  } else if (limit->has("lower") || limit->has("upper")) {
    for (const char* const end : {"lower", "upper"}) limit->number(end, 0, any_number);
    limit->note("has lower or upper, which are not used: the joint is continuous. Make it revolute if they are meant");
  }
  if (named.as_fixed) {
    for (const char* const what : {"effort", "velocity"}) limit->needed_number(what, not_negative);
    return;
  }
  joint.effort = rating(*limit, "effort", most_strength);
  joint.velocity = rating(*limit, "velocity", most_speed);
}

// The tighter of hard and soft limits, as MoveIt and TRAC-IK have it. The specification's 0 for a soft limit that is not given would hold the joint still.
void read_soft_limits(const Element& e, Joint& joint) {
  const auto safety = e.child("safety_controller");
  if (!safety) return;
  safety->check({.attributes = {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"}});
  for (const char* const gain : {"k_position", "k_velocity"}) safety->number(gain, 0, any_number);
  const std::size_t before = safety->report().problems();
  const double lower = safety->number("soft_lower_limit", -1e15, any_number), upper = safety->number("soft_upper_limit", 1e15, any_number);
  if (safety->report().problems() != before) return;
  if (!joint.moves() || joint.type == JointType::continuous) {
    safety->note(std::string("is not used: the joint is ") + (joint.moves() ? "continuous" : "fixed"));
    return;
  }
  if (!joint.range) return;  // refused already
  const Range soft{std::max(lower, joint.range->lower), std::min(upper, joint.range->upper)};
  if (soft.lower >= soft.upper) {
    safety->problem("leaves no range between its soft limits and those of <limit>: correct them");
  } else if (soft.lower == joint.range->lower && soft.upper == joint.range->upper) {
    safety->note("is not used: it has no soft limit within those of <limit>");
  } else {
    safety->note("has soft limits that are used: the range is from " + std::to_string(soft.lower) + " to " + std::to_string(soft.upper) +
                 ", that of <limit> from " + std::to_string(joint.range->lower) + " to " + std::to_string(joint.range->upper));
    if (joint.range->holds(0) && !soft.holds(0)) safety->note("does not hold 0: the joint cannot stand there");
    joint.range = soft;
  }
}

void read_dynamics(const Element& e, Joint& joint) {
  const auto dynamics = e.child("dynamics");
  if (!dynamics) return;
  dynamics->check({.attributes = {"damping", "friction"}});
  joint.dynamics.damping = dynamics->number("damping", 0, not_negative);
  joint.dynamics.friction = dynamics->number("friction", 0, not_negative);
  if (!joint.moves()) dynamics->note("is not used: the joint is fixed");
}

void read_mimic(const Element& e, NamedJoint& named) {
  const auto mimic = e.child("mimic");
  if (!mimic) return;
  mimic->check({.attributes = {"joint", "multiplier", "offset"}});
  Mimic read;
  read.multiplier = mimic->number("multiplier", 1, {-1e6, 1e6, "correct it"});
  read.offset = mimic->number("offset", 0, a_length);
  const std::string mimicked = mimic->needed_name("joint");
  if (!named.joint.moves()) {
    mimic->note("is not used: the joint is fixed");
    return;
  }
  if (std::abs(read.multiplier) < 1e-9) {
    mimic->problem("has a multiplier of 0: such a joint does not move, make it fixed");
    return;
  }
  named.mimicked = mimicked;
  named.mimic_line = mimic->line();
  if (!mimicked.empty()) named.joint.mimic = read;
}

// Whether the mimics that begin at `first` come back to it.
bool mimics_itself(const std::vector<NamedJoint>& joints, std::size_t first) {
  std::size_t at = first;
  for (std::size_t steps = 0; steps <= joints.size(); ++steps) {
    const auto& mimic = joints[at].joint.mimic;
    if (!mimic) return false;
    at = mimic->joint;
    if (at == first) return true;
  }
  return false;  // a ring that does not hold `first`: told at one of its own
}

// Whether a joint's own range holds all that the joint at the end of its mimics can ask of it.
void compare_ranges(const std::vector<NamedJoint>& joints, const NamedJoint& named, Report& report) {
  Mimic driver{0, 1, 0};
  const NamedJoint* at = &named;
  for (std::size_t steps = 0; at->joint.mimic && steps <= joints.size(); ++steps) {
    driver.offset += driver.multiplier * at->joint.mimic->offset;
    driver.multiplier *= at->joint.mimic->multiplier;
    at = &joints[at->joint.mimic->joint];
  }
  const auto &own = named.joint.range, &other = at->joint.range;
  if (at->joint.mimic || !own || !other) return;  // a ring is refused
  const double a = driver.multiplier * other->lower + driver.offset, b = driver.multiplier * other->upper + driver.offset;
  const double slack = 1e-6 * (1 + std::abs(a) + std::abs(b));  // of numbers with seven digits
  if (std::min(a, b) >= own->lower - slack && std::max(a, b) <= own->upper + slack) return;
  report.note(named.mimic_line, named.element.label() + " is moved by " + shown(at->joint.name) +
                                    ", whose whole range would take it from " + std::to_string(std::min(a, b)) + " to " +
                                    std::to_string(std::max(a, b)) + ", beyond its own limits");
}

}  // namespace

NamedJoint read_joint(const Element& element) {
  element.check({.attributes = {"name", "type"},
                 .once = {"parent", "child", "origin", "axis", "limit", "safety_controller", "dynamics", "mimic"},
                 .unused = {"calibration", "hardwareInterface"},
                 .ours = {"drive", "friction", "screw", "gear"}});
  NamedJoint named{element, {}, {}, {}, {}, 0, false};
  Joint& joint = named.joint;
  joint.line = element.line();
  joint.name = element.needed_name();
  read_type(element, joint);
  named.parent = end_of(element, "parent");
  named.child = end_of(element, "child");
  joint.parent_from_joint = element.origin();
  read_axis(element, joint);
  read_dynamics(element, joint);
  read_limit(element, named);
  read_soft_limits(element, joint);
  read_mimic(element, named);
  joint.extensions = element.extensions();
  return named;
}

void join_mimics(std::vector<NamedJoint>& joints, Report& report) {
  std::map<std::string_view, std::size_t> by_name;
  for (std::size_t i = 0; i < joints.size(); ++i) by_name.emplace(joints[i].joint.name, i);
  for (NamedJoint& named : joints) {
    if (!named.joint.mimic) continue;
    const auto found = by_name.find(named.mimicked);
    const std::string said = named.element.label() + " mimics " + shown(named.mimicked);
    if (found == by_name.end()) {
      report.problem(named.mimic_line, said + ", which is not there: name a joint of this file");
    } else if (!joints[found->second].joint.moves()) {
      const bool as_fixed = joints[found->second].as_fixed;
      report.problem(named.mimic_line,
                     said + (as_fixed ? ", whose range has no width" : ", which is fixed") + ": make this joint fixed, too");
    } else {
      named.joint.mimic->joint = found->second;
      continue;
    }
    named.joint.mimic.reset();
  }
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (mimics_itself(joints, i))
      report.problem(joints[i].mimic_line, joints[i].element.label() + " mimics itself" +
                                               (joints[i].joint.mimic->joint == i ? "" : " through others") + ": remove one <mimic>");
  for (const NamedJoint& named : joints)
    if (named.joint.mimic) compare_ranges(joints, named, report);
}

}  // namespace lf::urdf
