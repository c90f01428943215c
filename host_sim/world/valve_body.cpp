#include "host_sim/world/valve_body.hpp"

#include <cmath>

#include "host_sim/world/bullet_types.hpp"

namespace lf::world {
namespace {

enum Slot : std::size_t { friction = 0, lower_stop = 1, upper_stop = 2, viscous = 3 };

constexpr double stop_impulse_n_m_s = 1e6;
constexpr double stop_reach_rad_s = 20;  // a stop's row is set when the handle could meet it within the step
constexpr double rest_speed_rad_s = 1e-9;

}  // namespace

ValveBody::ValveBody(const ValveConfig& config, const Pose& base_from_valve, const scene::Body& handle, int body, double step_s)
    : config_(config), step_s_(step_s), part_(1, base_from_valve) {
  // Only the inertia about the shaft moves; the mass is carried by the panel.
  const double inertia = config.inertia_kg_m2;
  part_.body().setupRevolute(0, 0.5, btVector3(inertia, inertia, inertia), -1, btQuaternion::getIdentity(), btVector3(0, 0, 1),
                             btVector3(0, 0, 0), btVector3(0, 0, 0), false);
  part_.finish_links();
  part_.add_collider(-1, make_collision_shape({}, Pose::Identity()), no_body, Friction::free);
  part_.add_collider(0, make_collision_shape(handle, Pose::Identity()), body, Friction::free);
  rows_ = &part_.add_rows(0);
  part_.body().setJointPos(0, config.start_rad);
  part_.update_poses();
}

double ValveBody::detent_nm() const {
  double torque = 0;
  for (const double detent : config_.detents_rad) {
    const double away = angle_rad() - detent;
    if (std::abs(away) < config_.detent_width_rad) torque -= config_.detent_nm * std::sin(pi * away / config_.detent_width_rad);
  }
  return torque;
}

void ValveBody::before_step() {
  rows_->begin();
  rows_->set(friction, {0, -config_.friction_nm * step_s_, config_.friction_nm * step_s_});
  const double angle = angle_rad();
  const double reach = stop_reach_rad_s * step_s_;
  if (angle - reach < config_.stop_min_rad) rows_->set(lower_stop, {(config_.stop_min_rad - angle) / step_s_, 0, stop_impulse_n_m_s});
  if (angle + reach > config_.stop_max_rad) rows_->set(upper_stop, {(config_.stop_max_rad - angle) / step_s_, -stop_impulse_n_m_s, 0});
  if (config_.viscous_nm_s > 0) rows_->set(viscous, JointRows::damper(config_.viscous_nm_s, step_s_));
  rows_->apply_start(step_s_);
  part_.body().addJointTorque(0, detent_nm());
}

bool ValveBody::at_rest() const { return std::abs(speed_rad_s()) < rest_speed_rad_s && std::abs(detent_nm()) <= config_.friction_nm; }

}  // namespace lf::world
