#include "shared/arm/arm_description.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

#include "shared/arm/motor.hpp"
#include "shared/arm/urdf.hpp"
#include "shared/input_error.hpp"
#include "shared/urdf/read_urdf.hpp"

namespace lf {
namespace {

// Of the planar form.
constexpr std::array planar_links{"base", "slew", "upper_arm", "forearm", "wrist"};
constexpr std::array planar_joints{"slew", "shoulder", "elbow", "roll"};

scene::Shape read_geometry(const Urdf& urdf, const XMLElement* e) {
  scene::Shape shape;
  shape.body_from_shape = urdf.origin(e);
  const XMLElement* const geometry = urdf.child(e, "geometry");
  if (const XMLElement* const box = geometry->FirstChildElement("box")) {
    shape.kind = scene::ShapeKind::box;
    shape.size_m = urdf.numbers<3>(box, "size");
    if (shape.size_m.minCoeff() <= 0) urdf.fail(box, "<box>: size must be positive");
  } else if (const XMLElement* const cylinder = geometry->FirstChildElement("cylinder")) {
    shape.kind = scene::ShapeKind::cylinder;
    shape.size_m = Vec3(urdf.positive(cylinder, "radius"), 0, urdf.positive(cylinder, "length"));
  } else if (const XMLElement* const sphere = geometry->FirstChildElement("sphere")) {
    shape.kind = scene::ShapeKind::sphere;
    shape.size_m = Vec3(urdf.positive(sphere, "radius"), 0, 0);
  } else {
    urdf.fail(geometry, "<geometry> holds none of <box>, <cylinder>, <sphere>");
  }
  return shape;
}

scene::Shape read_visual(const Urdf& urdf, const XMLElement* visual) {
  scene::Shape shape = read_geometry(urdf, visual);
  shape.collides = false;
  const XMLElement* material = visual->FirstChildElement("material");
  if (material == nullptr) return shape;
  if (material->FirstChildElement("color") == nullptr) material = urdf.named("material", urdf.text(material, "name"));
  const XMLElement* const color = urdf.child(material, "color");
  const Eigen::Vector4d rgba = urdf.numbers<4>(color, "rgba");
  if (rgba.minCoeff() < 0 || rgba.maxCoeff() > 1) urdf.fail(color, "<color>: rgba must lie within 0 and 1");
  for (int i = 0; i < 3; ++i) shape.albedo[static_cast<std::size_t>(i)] = static_cast<float>(rgba[i]);
  return shape;
}

scene::Shape read_collision(const Urdf& urdf, const XMLElement* collision) {
  scene::Shape shape = read_geometry(urdf, collision);
  shape.visible = false;
  if (const XMLElement* const friction = collision->FirstChildElement("lanternfish:friction"))
    shape.friction = urdf.not_negative(friction, "coefficient");
  return shape;
}

Mat3 read_inertia(const Urdf& urdf, const XMLElement* inertial) {
  const XMLElement* const e = urdf.child(inertial, "inertia");
  const double xy = urdf.number(e, "ixy"), xz = urdf.number(e, "ixz"), yz = urdf.number(e, "iyz");
  Mat3 inertia;
  inertia << urdf.number(e, "ixx"), xy, xz, xy, urdf.number(e, "iyy"), yz, xz, yz, urdf.number(e, "izz");
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvalues();  // ascending
  if (principal[0] <= 0) urdf.fail(e, "<inertia> is not positive definite");
  if (principal[0] + principal[1] < principal[2] * (1 - 1e-9))
    urdf.fail(e, "<inertia> is of no real body: a principal moment exceeds the sum of the others");
  return inertia;
}

ArmLink read_link(const Urdf& urdf, const std::string& name) {
  const XMLElement* const e = urdf.named("link", name);
  const XMLElement* const inertial = urdf.child(e, "inertial");
  ArmLink link;
  link.name = name;
  link.mass_kg = urdf.positive(urdf.child(inertial, "mass"), "value");
  link.wet_weight_n = urdf.number(urdf.child(e, "lanternfish:wet_weight"), "n");
  link.link_from_com = urdf.origin(inertial);
  link.inertia_kg_m2 = read_inertia(urdf, inertial);
  for (const XMLElement* v = e->FirstChildElement("visual"); v != nullptr; v = v->NextSiblingElement("visual"))
    link.shapes.push_back(read_visual(urdf, v));
  for (const XMLElement* c = e->FirstChildElement("collision"); c != nullptr; c = c->NextSiblingElement("collision"))
    link.shapes.push_back(read_collision(urdf, c));
  return link;
}

const XMLElement* joint_between(const Urdf& urdf, const std::string& name, const char* type, const std::string& parent,
                                const std::string& child) {
  const XMLElement* const e = urdf.named("joint", name);
  if (urdf.text(e, "type") != type) urdf.fail(e, urdf.label(e) + " must be of type " + type);
  const auto expect = [&](const char* tag, const std::string& link) {
    const XMLElement* const end = urdf.child(e, tag);
    if (urdf.text(end, "link") != link) urdf.fail(end, urdf.label(e) + ": its " + tag + " must be link '" + link + "'");
  };
  expect("parent", parent);
  expect("child", child);
  return e;
}

// What every moving joint has: place, axis and limits.
ArmJoint read_joint(const Urdf& urdf, const std::string& name, const std::string& parent, const std::string& child) {
  const XMLElement* const e = joint_between(urdf, name, "revolute", parent, child);
  const XMLElement* const limit = urdf.child(e, "limit");
  ArmJoint joint;
  joint.name = name;
  joint.parent_from_joint = urdf.origin(e);
  joint.axis = urdf.numbers<3>(urdf.child(e, "axis"), "xyz");
  if (std::abs(joint.axis.norm() - 1) > 1e-9) urdf.fail(e, urdf.label(e) + ": its axis is not a unit vector");
  joint.lower_rad = urdf.number(limit, "lower");
  joint.upper_rad = urdf.number(limit, "upper");
  if (joint.lower_rad >= joint.upper_rad) urdf.fail(limit, urdf.label(e) + ": lower limit is not below the upper one");
  constexpr double turn_rad = 2 * pi + 1e-4;  // as many digits as files give it
  if (joint.lower_rad < -turn_rad || joint.upper_rad > turn_rad) urdf.fail(limit, urdf.label(e) + ": limits reach beyond a whole turn");
  joint.effort_nm = urdf.positive(limit, "effort");
  joint.velocity_rad_s = urdf.positive(limit, "velocity");
  return joint;
}

ArmActuator read_screw(const Urdf& urdf, const XMLElement* e, const ArmJoint& joint) {
  ArmActuator screw;
  screw.pivot_a_m = urdf.positive(e, "pivot_a_m");
  screw.pivot_b_m = urdf.positive(e, "pivot_b_m");
  screw.offset_rad = urdf.number(e, "offset_rad");
  screw.counts_per_m = urdf.positive(e, "counts_per_m");
  constexpr double widening_rad = 0.1;  // the core converts counts that far past the limits
  if (joint.lower_rad - widening_rad + screw.offset_rad <= 0 || joint.upper_rad + widening_rad + screw.offset_rad >= pi)
    urdf.fail(e, "joint '" + joint.name + "': its screw passes a dead centre within 0.1 rad of the limits");
  return screw;
}

void read_friction(const Urdf& urdf, const XMLElement* e, ArmFriction& friction) {
  friction.stated = true;
  friction.coulomb_share = urdf.not_negative(e, "coulomb_share");
  friction.viscous_share = urdf.not_negative(e, "viscous_share");
  friction.efficiency = urdf.positive(e, "efficiency");
  friction.back_efficiency = urdf.number(e, "back_efficiency");
  if (friction.coulomb_share + friction.viscous_share >= 1) urdf.fail(e, "friction takes the whole rated torque");
  if (friction.efficiency > 1 || friction.back_efficiency > 1) urdf.fail(e, "an efficiency is above 1");
}

void read_drive(const Urdf& urdf, ArmJoint& joint) {
  const XMLElement* const e = urdf.named("joint", joint.name);
  const XMLElement* const drive = urdf.child(e, "lanternfish:drive");
  joint.rated_torque_nm = urdf.positive(drive, "rated_torque_nm");
  joint.acceleration_rad_s2 = urdf.positive(drive, "acceleration_rad_s2");
  joint.stiction_rad_s = urdf.not_negative(drive, "stiction_rad_s");
  joint.backlash_rad = urdf.not_negative(drive, "backlash_rad");
  joint.holding_torque_nm = urdf.not_negative(drive, "holding_torque_nm");
  if (drive->Attribute("stiffness_nm_rad") != nullptr) {
    constexpr double least_nm_rad = 50;
    joint.stiffness_nm_rad = urdf.positive(drive, "stiffness_nm_rad");
    if (joint.stiffness_nm_rad < least_nm_rad) urdf.fail(drive, urdf.label(e) + ": stiffness_nm_rad is below 50: it is in N m/rad");
  }
  if (const XMLElement* const friction = e->FirstChildElement("lanternfish:friction")) read_friction(urdf, friction, joint.friction);
  if (joint.rated_torque_nm > joint.effort_nm) urdf.fail(drive, urdf.label(e) + ": rated torque exceeds the peak effort");
  if (joint.effort_nm > most_peak_of_rating * joint.rated_torque_nm)
    urdf.fail(drive, urdf.label(e) + ": the limit's effort, the peak torque, is more than 30 times rated_torque_nm");
  if (joint.stiction_rad_s >= joint.velocity_rad_s) urdf.fail(drive, urdf.label(e) + ": it can never move, stiction reaches its top speed");
  if (const XMLElement* const screw = e->FirstChildElement("lanternfish:screw"))
    joint.actuator = read_screw(urdf, screw, joint);
  else
    joint.actuator.counts_per_rad = 1 / urdf.positive(urdf.child(e, "lanternfish:gear"), "rad_per_count");
  constexpr double most_counts = 1e9, beyond_m = 1;  // 32 bits, and room for a zero that is elsewhere
  const double stroke_rad = std::max(std::abs(joint.lower_rad), std::abs(joint.upper_rad)) + 0.1;
  if (!(joint.actuator.counts_per_rad * stroke_rad < most_counts) || !(joint.actuator.counts_per_m * beyond_m < most_counts))
    urdf.fail(e, urdf.label(e) + ": over its stroke it has more counts than 32 bits hold");
  if (joint.actuator.counts_per_rad > 0 && joint.actuator.counts_per_rad * (joint.upper_rad - joint.lower_rad) < 10)
    urdf.fail(e, urdf.label(e) + ": its gear has fewer than ten counts over its stroke");
}

ArmJoint read_mimic(const Urdf& urdf, const ArmJoint& jaw, const std::string& hand) {
  ArmJoint finger_b = read_joint(urdf, "finger_b", hand, "finger_b");
  const XMLElement* const mimic = urdf.child(urdf.named("joint", "finger_b"), "mimic");
  if (urdf.text(mimic, "joint") != jaw.name || urdf.number(mimic, "multiplier") != 1 || urdf.number(mimic, "offset") != 0)
    urdf.fail(mimic, "joint 'finger_b' must mimic 'jaw' with multiplier 1 and offset 0");
  return finger_b;
}

// The box by which a finger holds, square to it.
scene::Shape read_pad(const Urdf& urdf, const char* finger) {
  const XMLElement* const link = urdf.named("link", finger);
  for (const XMLElement* c = link->FirstChildElement("collision"); c != nullptr; c = c->NextSiblingElement("collision")) {
    const char* const name = c->Attribute("name");
    if (name == nullptr || std::strcmp(name, "pad") != 0) continue;
    scene::Shape pad = read_collision(urdf, c);
    if (pad.kind != scene::ShapeKind::box || !pad.body_from_shape.linear().isIdentity(1e-9))
      urdf.fail(c, "the pad must be a box, not turned");
    return pad;
  }
  urdf.fail(link, urdf.label(link) + " has no <collision> named 'pad', the box by which it holds");
}

// What the arm is made of, base to tip: its links, "base" first, and the joints between them.
struct ArmParts {
  std::vector<std::string> links, joints;
  bool planar = false;
};

std::string link_of(const Urdf& urdf, const XMLElement* joint, const char* end) { return urdf.text(urdf.child(joint, end), "link"); }

// Files and messages have the joints by their names, beside others.
void check_name(const Urdf& urdf, const std::string& joint) {
  constexpr std::array taken{"io", "master", "outputs", "all", "profile", "counts_per_rev", "rated_current_a", "jaw"};
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-'; };
  const bool plain =
      !joint.empty() && std::isalpha(static_cast<unsigned char>(joint.front())) != 0 && std::all_of(joint.begin(), joint.end(), letter);
  if (plain && std::find(taken.begin(), taken.end(), joint) == taken.end()) return;
  urdf.fail(urdf.named("joint", joint), "joint '" + joint +
                                            "': a joint's name is a letter and then letters, digits, _ and -, and none that limits, drives "
                                            "or faults have for something else");
}

// An arm that calls its first joint 'slew' is of the form for which the core has closed forms, or is refused. Of any other it is the chain from the base to the
// link that carries the tool.
ArmParts parts_of(const Urdf& urdf) {
  ArmParts arm;
  std::vector<const XMLElement*> joints;
  urdf.each("joint", [&](const XMLElement* e) {
    joints.push_back(e);
    arm.planar = arm.planar || (urdf.text(e, "name") == planar_joints.front() && link_of(urdf, e, "parent") == planar_links.front());
  });
  if (arm.planar) {
    for (const char* joint : planar_joints)
      (void)urdf.named(
          "joint", joint,
          ": after a first joint of the name 'slew' come shoulder, elbow and roll. Call it otherwise where the arm has another form");
    arm.links.assign(planar_links.begin(), planar_links.end());
    arm.joints.assign(planar_joints.begin(), planar_joints.end());
    return arm;
  }
  arm.links.push_back(link_of(urdf, urdf.named("joint", "tool"), "parent"));
  while (arm.links.back() != "base") {
    const auto before =
        std::find_if(joints.begin(), joints.end(), [&](const XMLElement* e) { return link_of(urdf, e, "child") == arm.links.back(); });
    if (before == joints.end())
      urdf.fail(urdf.named("link", arm.links.back()), "link '" + arm.links.back() + "' hangs on no joint: an arm begins at link 'base'");
    arm.joints.push_back(urdf.text(*before, "name"));
    arm.links.push_back(link_of(urdf, *before, "parent"));
    if (arm.joints.size() > capacity::arm_joints)
      urdf.fail(*before, "the arm has more than " + std::to_string(capacity::arm_joints) +
                             " joints before its jaw, or hangs on itself; the core holds " + std::to_string(capacity::arm_joints));
  }
  if (arm.joints.size() < 2) urdf.fail(urdf.named("joint", "tool"), "the arm has fewer than two joints before its jaw");
  for (const std::string& joint : arm.joints) check_name(urdf, joint);
  std::reverse(arm.links.begin(), arm.links.end());
  std::reverse(arm.joints.begin(), arm.joints.end());
  return arm;
}

// A part that nobody reads would be in nobody's way: neither seen nor kept clear.
void check_parts(const Urdf& urdf, const ArmParts& arm) {
  std::vector<std::string> links = arm.links, joints = arm.joints;
  links.insert(links.end(), {"finger_a", "finger_b", "tool"});
  joints.insert(joints.end(), {"jaw", "finger_b", "tool"});
  const auto known = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::set<std::string> seen;
  urdf.each("joint", [&](const XMLElement* e) {
    const std::string name = urdf.text(e, "name");
    if (!seen.insert(name).second) urdf.fail(e, urdf.label(e) + " is there twice");
    if (!known(joints, name) && urdf.text(e, "type") != "fixed")
      urdf.fail(
          e, urdf.label(e) +
                 " can move, and is none of the arm's: the arm has the joints from link 'base' to the one that carries 'tool', 'jaw' and "
                 "'finger_b'. `lanternfish check arm FILE --tool LINK` reads any other");
  });
  seen.clear();
  urdf.each("link", [&](const XMLElement* e) {
    const std::string name = urdf.text(e, "name");
    if (!seen.insert(name).second) urdf.fail(e, urdf.label(e) + " is there twice");
    if ((name == "tool" || !known(links, name)) && e->FirstChildElement("collision") != nullptr)
      urdf.fail(e, urdf.label(e) + ": nobody keeps its collision shapes clear. Put them into the link that carries it");
  });
}

// Each gets a capsule in the core, but for those of the base.
void check_shapes(const Urdf& urdf, const ArmDescription& arm) {
  std::size_t shapes = 0;
  for (std::size_t link = 1; link < arm.links.size(); ++link) {
    const std::size_t before = shapes;
    for (const scene::Shape& shape : arm.links[link].shapes) shapes += shape.collides ? 1 : 0;
    if (shapes == before)
      urdf.fail(urdf.named("link", arm.links[link].name),
                "link '" + arm.links[link].name + "' has no <collision>: nothing of it would be kept clear of panel, vehicle and arm");
    if (shapes > capacity::arm_shapes)
      urdf.fail(urdf.named("link", arm.links[link].name), "with this link the arm has " + std::to_string(shapes) +
                                                              " collision shapes; the core holds " + std::to_string(capacity::arm_shapes) +
                                                              ". Leave out what lies within a larger one");
  }
}

// The fingers turn about the wrist's y, on its x axis or above it, and are each other's mirror image.
void check_jaw(const Urdf& urdf, const ArmDescription& arm) {
  constexpr double tolerance = 1e-9;
  const auto expect = [&](bool holds, const char* joint, const char* message) {
    if (!holds) urdf.fail(urdf.named("joint", joint), std::string("joint '") + joint + "' " + message);
  };
  const ArmJoint& a = arm.jaw();
  const auto square = [&](const ArmJoint& joint) {
    return joint.parent_from_joint.linear().isIdentity(tolerance) && std::abs(joint.parent_from_joint.translation().y()) < tolerance;
  };
  expect(square(a) && (a.axis + Vec3::UnitY()).norm() < tolerance, "jaw", "must turn about the wrist's -y, in its x-z plane");
  expect(a.lower_rad >= -pi && a.upper_rad <= pi, "jaw", "must stay within half a turn to either side of angle 0");
  const Vec3 mirrored = a.parent_from_joint.translation().cwiseProduct(Vec3(-1, 1, 1));
  expect(square(arm.finger_b) && (arm.finger_b.axis - Vec3::UnitY()).norm() < tolerance &&
             (arm.finger_b.parent_from_joint.translation() - mirrored).norm() < tolerance,
         "finger_b", "must be the mirror image of 'jaw': about the wrist's y, at -x");
  const auto half_gap_m = [&](double q) {
    const Vec3 face = arm.pad.body_from_shape.translation() + Vec3(arm.pad.size_m.x() / 2, 0, 0);
    return -(a.parent_from_joint.translation().x() + face.x() * std::cos(q) - face.z() * std::sin(q));
  };
  expect(arm.pad.body_from_shape.translation().z() > 0.001, "jaw", "must have its pads beyond their axis");
  expect(half_gap_m(a.lower_rad) > -tolerance, "jaw", "must not close so far that its pads overlap: raise its lower limit");
  constexpr int steps = 16;
  for (int i = 0; i < steps; ++i) {
    const double q = std::lerp(a.lower_rad, a.upper_rad, static_cast<double>(i) / steps);
    expect(half_gap_m(q + (a.upper_rad - a.lower_rad) / steps) > half_gap_m(q), "jaw", "must open over its whole range");
  }
  const scene::Shape other = read_pad(urdf, "finger_b");
  const Vec3 pad = arm.pad.body_from_shape.translation();
  if ((other.body_from_shape.translation() - pad.cwiseProduct(Vec3(-1, 1, 1))).norm() > tolerance ||
      (other.size_m - arm.pad.size_m).norm() > tolerance)
    urdf.fail(urdf.named("link", "finger_b"), "link 'finger_b': its pad must be the mirror image of finger_a's");
}

// How far a shape reaches from an axis through its link's origin, at most.
double out_from(const Vec3& axis, const scene::Shape& shape) {
  const Vec3 centre_m = shape.body_from_shape.translation(), along = shape.body_from_shape.linear().col(2);
  const double off_m = centre_m.cross(axis).norm();
  switch (shape.kind) {
    case scene::ShapeKind::box: return off_m + shape.size_m.norm() / 2;
    case scene::ShapeKind::cylinder: return off_m + shape.size_m.x() + shape.size_m.z() / 2 * along.cross(axis).norm();
    default: return off_m + shape.size_m.x();
  }
}

// What the core asks of an arm whose form has no closed forms of its own.
void check_any_chain(const Urdf& urdf, const ArmDescription& arm) {
  constexpr double tolerance = 1e-9;
  const ArmJoint& last = arm.last();
  if (!arm.rolls) {
    // In between it would turn the tool about its axis and swing it at once.
    constexpr double least_sine = 0.5;
    if (last.axis.head<2>().norm() < least_sine)
      urdf.fail(
          urdf.named("joint", last.name),
          "joint '" + last.name +
              "' must turn about its own z, and so roll the tool about its approach, or about an axis at 30 degrees or more from that");
    if (arm.arm_joints() > ArmModel::most_joints_without_roll)
      urdf.fail(urdf.named("joint", last.name), "with joint '" + last.name + "' the arm has " + std::to_string(arm.arm_joints()) +
                                                    " joints and none that rolls the tool: the core holds " +
                                                    std::to_string(ArmModel::most_joints_without_roll) + " of such an arm");
  }
  // The core does not hold it against the vehicle that it stands on. A turret's housing turns in its place; a boom would sweep over what stands beside the base.
  constexpr double turns_in_place_m = 0.15;
  const ArmJoint& first = arm.joints.front();
  for (const scene::Shape& shape : arm.links[1].shapes) {
    if (!shape.collides) continue;
    const double out_m = out_from(first.axis, shape);
    if (out_m > turns_in_place_m)
      urdf.fail(urdf.named("link", arm.links[1].name),
                "link '" + arm.links[1].name + "' comes " + std::to_string(std::lround(1e3 * out_m)) + " mm from the axis of '" +
                    first.name +
                    "': the first link is not kept clear of the vehicle that it stands on, and may "
                    "reach " +
                    std::to_string(std::lround(1e3 * turns_in_place_m)) + " mm. Give what is longer a link of its own");
  }
  const Pose& tool = arm.wrist_from_tool;
  if (!tool.linear().isIdentity(tolerance) || tool.translation().head<2>().norm() > tolerance)
    urdf.fail(urdf.named("joint", "tool"), "joint 'tool' must lie on the z axis of link '" + arm.links[arm.arm_joints()].name +
                                               "', unturned: along it the hand approaches");
}

// The closed forms of the core hold for one kind of chain only: slew axis through the base's origin, then shoulder and elbow parallel and square to it,
// the roll axis square to these, and everything in the one plane that the slew turns.
void check_chain(const Urdf& urdf, const ArmDescription& arm) {
  const auto expect = [&](bool holds, const char* joint, const char* message) {
    if (!holds) urdf.fail(urdf.named("joint", joint), std::string("joint '") + joint + "' " + message);
  };
  constexpr double tolerance = 1e-9;
  const auto same = [](const Vec3& a, const Vec3& b) { return (a - b).norm() < tolerance; };
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    expect(same(arm.joints[i].axis, Vec3::UnitZ()), planar_joints[i], "must turn about its own z");
    expect(arm.joints[i].lower_rad >= -pi && arm.joints[i].upper_rad <= pi, planar_joints[i],
           "must stay within half a turn to either side of angle 0: the closed form of this kind of arm knows no other turn");
  }
  const Pose slew = arm.joints[0].parent_from_joint;
  const Pose shoulder = slew * arm.joints[1].parent_from_joint;
  const Pose elbow = shoulder * arm.joints[2].parent_from_joint;
  const Pose roll = elbow * arm.joints[3].parent_from_joint;
  const Vec3 across = shoulder.linear().col(2);
  const auto in_plane = [&](const Pose& p) { return std::abs(across.dot(p.translation() - slew.translation())) < tolerance; };
  expect(slew.translation().norm() < tolerance, "slew", "must sit at the base's origin");
  expect(same(slew.linear().col(2), Vec3::UnitZ()), "slew", "must turn about the base's z");
  expect(
      same(across, -slew.linear().col(1)) && std::abs(arm.joints[1].parent_from_joint.translation().z()) < tolerance && in_plane(shoulder),
      "shoulder", "must turn about the slew's -y, on its x axis");
  expect(same(elbow.linear().col(2), across) && in_plane(elbow), "elbow", "must be parallel to the shoulder and in the arm's plane");
  expect(std::abs(roll.linear().col(2).dot(across)) < tolerance && in_plane(roll), "roll",
         "must be square to the elbow and in the arm's plane");
  expect(same(roll.linear().col(1), across), "roll", "must have its y along the elbow's axis at angle 0");
  constexpr double shortest_m = 0.01;
  expect((elbow.translation() - shoulder.translation()).norm() > shortest_m, "elbow", "must stand more than 10 mm from the shoulder");
  expect((roll * arm.wrist_from_tool.translation() - elbow.translation()).norm() > shortest_m, "tool",
         "must stand more than 10 mm from the elbow");
  const Pose& tool = arm.wrist_from_tool;
  expect(tool.linear().isIdentity(tolerance) && tool.translation().head<2>().norm() < tolerance, "tool",
         "must lie on the roll axis, unturned");
}

}  // namespace

JointNames ArmDescription::names() const {
  std::vector<std::string> names;
  for (const ArmJoint& joint : joints) names.push_back(joint.name);
  return JointNames(names);
}

ArmDescription load_arm_urdf(const std::string& path) {
  const Urdf urdf(path);
  const ArmParts parts = parts_of(urdf);
  const std::string& hand = parts.links.back();
  ArmDescription arm;
  arm.form = parts.planar ? ArmModel::Form::planar : ArmModel::Form::chain;
  for (const std::string& link : parts.links) arm.links.push_back(read_link(urdf, link));
  for (const char* finger : {"finger_a", "finger_b"}) arm.links.push_back(read_link(urdf, finger));
  for (std::size_t i = 0; i < parts.joints.size(); ++i) {
    arm.joints.push_back(read_joint(urdf, parts.joints[i], parts.links[i], parts.links[i + 1]));
    read_drive(urdf, arm.joints.back());
  }
  arm.joints.push_back(read_joint(urdf, "jaw", hand, "finger_a"));
  read_drive(urdf, arm.joints.back());
  arm.finger_b = read_mimic(urdf, arm.jaw(), hand);
  arm.wrist_from_tool = urdf.origin(joint_between(urdf, "tool", "fixed", hand, "tool"));
  arm.rolls = (arm.last().axis - Vec3::UnitZ()).norm() < 1e-9;
  check_parts(urdf, parts);
  check_shapes(urdf, arm);
  parts.planar ? check_chain(urdf, arm) : check_any_chain(urdf, arm);
  if (arm.rolls && (arm.last().lower_rad > 0 || arm.last().upper_rad < 0)) {
    urdf.fail(urdf.named("joint", arm.last().name),
              "joint '" + arm.last().name +
                  "' rolls the tool, and its range leaves out angle 0: buttons are pressed there. Choose its zero in its range");
  }
  arm.pad = read_pad(urdf, "finger_a");
  check_jaw(urdf, arm);
  // What is wrong with the file beyond the arm, and what is there twice. That the tool has no mass is as it should be.
  const urdf::Reading reading = urdf::read_urdf(path);
  for (const urdf::Note& note : reading.notes) {
    if (note.text.find("link 'tool' has no inertial") == std::string::npos) arm.notes.push_back(reading.told(note));
  }
  return arm;
}

}  // namespace lf
