// The valve: a shaft with Coulomb and viscous friction, end stops and detents. Internal to this folder.
#pragma once

#include "host_sim/world/multibody_part.hpp"
#include "host_sim/world/world.hpp"

namespace lf::world {

class ValveBody {
 public:
  // `base_from_valve`: its axis on the panel's plane, axes as the panel's; `body`: the handle's index in the scene.
  ValveBody(const ValveConfig& config, const Pose& base_from_valve, const scene::Body& handle, int body, double step_s);

  void before_step();
  double angle_rad() const { return part_.body().getJointPos(0); }
  double speed_rad_s() const { return part_.body().getJointVel(0); }
  // Stands still and would stay so if nothing touched it.
  bool at_rest() const;
  Pose base_from_handle() const { return part_.base_from_link(0); }
  MultibodyPart& part() { return part_; }
  const MultibodyPart& part() const { return part_; }

 private:
  double detent_nm() const;

  ValveConfig config_;
  double step_s_;
  MultibodyPart part_;
  JointRows* rows_ = nullptr;
};

}  // namespace lf::world
