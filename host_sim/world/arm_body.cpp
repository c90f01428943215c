#include "host_sim/world/arm_body.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "host_sim/world/bullet_types.hpp"

namespace lf::world {
namespace {

constexpr double finger_drag_share = 0.1;

// Of the arm's bodies; the base is Bullet's link -1.
std::size_t body_of(int link) { return std::size_t(link) + 1; }

}  // namespace

ArmBody::ArmBody(const ArmDescription& arm, const scene::Scene& scene, const Config& config)
    : arm_(arm),
      config_(config),
      part_(bullet_links(), Pose::Identity()),
      link_from_frame_(arm.links.size(), Pose::Identity()),
      principal_kg_m2_(arm.links.size(), Vec3::Ones()),
      drag_(arm.links.size()) {
  set_up_links();
  part_.finish_links();
  for (int link = -1; link < bullet_links(); ++link) {
    const auto body = body_of(link);
    part_.add_collider(link, make_collision_shape(scene[body], link_from_frame_[body]), int(body), Friction::free);
  }
  for (std::size_t i = 0; i < arm_.joints.size(); ++i) {
    const ArmJoint& joint = arm_.joints[i];
    joints_[i] = {i == jaw(), joint.lower_rad, joint.upper_rad, joint.backlash_rad, driven_links(i) * config.drive_stiffness_nm_rad[i]};
    rows_[i] = &part_.add_rows(int(i), i == jaw() ? finger_b() : -1);
  }
  start_at(config.start_rad);
}

void ArmBody::set_up_links() {
  // The base does not move: its mass does not matter.
  for (int link = 0; link < bullet_links(); ++link) {
    const auto index = body_of(link);
    const ArmLink& description = arm_.links[index];
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(description.inertia_kg_m2);
    Pose com_from_frame = Pose::Identity();
    com_from_frame.linear() = axes.eigenvectors();
    if (com_from_frame.linear().determinant() < 0) com_from_frame.linear().col(2) *= -1;
    link_from_frame_[index] = description.link_from_com * com_from_frame;
    principal_kg_m2_[index] = axes.eigenvalues();
    drag_[index] = LinkDrag(description.shapes, link_from_frame_[index].inverse());

    const ArmJoint& joint = joint_before(link);
    const int parent = parent_of(link);
    const Pose& frame = link_from_frame_[index];
    const Pose parent_frame_from_joint = link_from_frame_[body_of(parent)].inverse() * joint.parent_from_joint;
    const Mat3 frame_from_parent_frame = (parent_frame_from_joint.linear() * frame.linear()).transpose();
    const Mat3 frame_from_link = frame.linear().transpose();
    part_.body().setupRevolute(link, description.mass_kg, to_bullet(principal_kg_m2_[index]), parent, to_bullet(frame_from_parent_frame),
                               to_bullet(Vec3(frame_from_link * joint.axis.normalized())),
                               to_bullet(Vec3(parent_frame_from_joint.translation())),
                               to_bullet(Vec3(frame_from_link * frame.translation())), false);
  }
}

void ArmBody::start_at(const PerJoint<double>& start_rad) {
  for (int link = 0; link < bullet_links(); ++link) part_.body().setJointPos(link, start_rad[joint_of(link)]);
  part_.update_poses();
  motor_rad_ = start_rad;
  for (std::size_t i = 0; i < arm_.joints.size(); ++i) {
    readings_[i] = {start_rad[i], start_rad[i], 0, 0};
    drives_[i].released = true;
  }
}

void ArmBody::limit_jaw(double lower_rad, double upper_rad) {
  DrivenJoint& driven = joints_[jaw()];
  driven.lower_rad = lower_rad;
  driven.upper_rad = upper_rad;
}

double ArmBody::position_rad(std::size_t joint) const {
  const double position = part_.body().getJointPos(int(joint));
  return joint == jaw() ? 0.5 * (position + part_.body().getJointPos(finger_b())) : position;
}

double ArmBody::velocity_rad_s(std::size_t joint) const {
  const double velocity = part_.body().getJointVel(int(joint));
  return joint == jaw() ? 0.5 * (velocity + part_.body().getJointVel(finger_b())) : velocity;
}

void ArmBody::before_step() {
  btMultiBody& body = part_.body();
  for (std::size_t i = 0; i < arm_.joints.size(); ++i) {
    plan_[i] = plan_drive(drives_[i], arm_.joints[i].holding_torque_nm, joints_[i], motor_rad_[i], position_rad(i), config_.step_s);
    plan_[i].torque_up_nm *= driven_links(i);
    plan_[i].torque_down_nm *= driven_links(i);
    plan_[i].push_nm *= driven_links(i);
    rows_[i]->begin();
    stall_nm_[i] = set_drive_rows(*rows_[i], joints_[i], plan_[i], position_rad(i), config_.step_s);
    if (i == jaw()) set_coupling_row(*rows_[i], joints_[i], body.getJointPos(finger_b()) - body.getJointPos(int(jaw())), config_.step_s);
    set_water_row(*rows_[i], joints_[i], config_.joint_drag_nm_s * (i == jaw() ? finger_drag_share : 1.0), config_.step_s);
    rows_[i]->apply_start(config_.step_s);
  }
  for (int link = 0; link < bullet_links(); ++link) {
    const std::size_t joint = joint_of(link);
    body.addJointTorque(link, stall_nm_[joint] / driven_links(joint));
    body.addLinkForce(link, btVector3(0, 0, arm_.links[body_of(link)].wet_weight_n));
  }
  if (config_.drag_coefficient > 0) add_drag();
}

void ArmBody::add_drag() {
  const LinkMotions motions = link_motions();
  for (int link = 0; link < bullet_links(); ++link) {
    const auto index = body_of(link);
    const Mat3 turn = part_.base_from_link(link).linear();
    const LinkDrag::Wrench drag = drag_[index].at(turn.transpose() * motions.speed_m_s[index], turn.transpose() * motions.turn_rad_s[index],
                                                  config_.drag_coefficient);
    part_.body().addLinkForce(link, to_bullet(Vec3(turn * drag.force_n)));
    part_.body().addLinkTorque(link, to_bullet(Vec3(turn * drag.torque_nm)));
  }
}

void ArmBody::after_step() {
  for (std::size_t i = 0; i < arm_.joints.size(); ++i) {
    motor_rad_[i] = motor_after(plan_[i], joints_[i], position_rad(i));
    const double torque_nm = (drive_torque_nm(*rows_[i], config_.step_s) + stall_nm_[i]) / driven_links(i);
    readings_[i] = {position_rad(i), motor_rad_[i], velocity_rad_s(i), torque_nm};
  }
}

Pose ArmBody::base_from_link(std::size_t link) const {
  return link == 0 ? Pose::Identity() : Pose(part_.base_from_link(int(link) - 1) * link_from_frame_[link].inverse());
}

Pose ArmBody::base_from_tool() const { return base_from_link(arm_.arm_joints()) * arm_.wrist_from_tool; }

// Velocities of the links from the joints', outward along the chain.
ArmBody::LinkMotions ArmBody::link_motions() const {
  const btMultiBody& body = part_.body();
  LinkMotions motions{std::vector<Vec3>(arm_.links.size(), Vec3::Zero()), std::vector<Vec3>(arm_.links.size(), Vec3::Zero())};
  for (int link = 0; link < bullet_links(); ++link) {
    const auto index = body_of(link);
    const auto parent = body_of(parent_of(link));
    const Pose origin = base_from_link(index);
    const Vec3 axis = origin.linear() * joint_before(link).axis.normalized();
    const Vec3 turn = motions.turn_rad_s[parent] + axis * body.getJointVel(link);
    const Vec3 from_parent = origin.translation() - part_.base_from_link(parent_of(link)).translation();
    const Vec3 at_origin = motions.speed_m_s[parent] + motions.turn_rad_s[parent].cross(from_parent);
    motions.turn_rad_s[index] = turn;
    motions.speed_m_s[index] = at_origin + turn.cross(part_.base_from_link(link).translation() - origin.translation());
  }
  return motions;
}

double ArmBody::kinetic_energy_j() const {
  const LinkMotions motions = link_motions();
  double energy = 0;
  for (int link = 0; link < bullet_links(); ++link) {
    const auto index = body_of(link);
    const Vec3 in_frame = part_.base_from_link(link).linear().transpose() * motions.turn_rad_s[index];
    energy += 0.5 * arm_.links[index].mass_kg * motions.speed_m_s[index].squaredNorm() +
              0.5 * in_frame.dot(principal_kg_m2_[index].cwiseProduct(in_frame));
  }
  return energy;
}

}  // namespace lf::world
