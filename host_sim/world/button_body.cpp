#include "host_sim/world/button_body.hpp"

#include <cmath>

#include "host_sim/world/bullet_types.hpp"

namespace lf::world {
namespace {

enum Slot : std::size_t { out_stop = 0, in_stop = 1 };

constexpr double stop_impulse_n_s = 1e6;
constexpr double stop_reach_m_s = 2;  // a stop's row is set when the cap could meet it within the step
constexpr double rest_speed_m_s = 1e-9;
constexpr double rest_depth_m = 1e-9;

}  // namespace

ButtonBody::ButtonBody(const ButtonConfig& config, const Pose& base_from_button, const scene::Body& cap, int scene_body, double step_s)
    : config_(config), step_s_(step_s), part_(1, base_from_button) {
  const btVector3 inertia(1e-4, 1e-4, 1e-4);  // of no effect: it does not turn
  part_.body().setupPrismatic(0, config.mass_kg, inertia, -1, btQuaternion::getIdentity(), btVector3(0, 0, -1), btVector3(0, 0, 0),
                              btVector3(0, 0, 0), false);
  part_.finish_links();
  part_.add_collider(-1, make_collision_shape({}, Pose::Identity()), no_body, Friction::anchored);
  part_.add_collider(0, make_collision_shape(cap, Pose::Identity()), scene_body, Friction::anchored);
  rows_ = &part_.add_rows(0);
  part_.update_poses();
}

void ButtonBody::before_step() {
  const double depth = part_.body().getJointPos(0);
  const double spring_n = config_.preload_n + config_.spring_n_m * depth - (state_.pressed ? config_.click_drop_n : 0);
  const double stroke_m = config_.stuck ? 0 : config_.stroke_m;
  rows_->begin();
  if (depth - stop_reach_m_s * step_s_ < 0) rows_->set(out_stop, {-depth / step_s_, 0, stop_impulse_n_s});
  if (depth + stop_reach_m_s * step_s_ > stroke_m) {
    rows_->set(in_stop, {(stroke_m - depth) / step_s_, -stop_impulse_n_s, 0});
  }
  rows_->apply_start(step_s_);
  part_.body().addJointTorque(0, -spring_n - config_.damping_n_s_m * part_.body().getJointVel(0));
}

void ButtonBody::after_step() {
  state_.depth_m = part_.body().getJointPos(0);
  if (!state_.pressed && state_.depth_m >= config_.click_depth_m) {
    state_.pressed = true;
    ++state_.presses;
  } else if (state_.pressed && state_.depth_m <= config_.release_depth_m) {
    state_.pressed = false;
  }
}

bool ButtonBody::at_rest() const {
  return std::abs(part_.body().getJointVel(0)) < rest_speed_m_s && std::abs(state_.depth_m) < rest_depth_m;
}

}  // namespace lf::world
