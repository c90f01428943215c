// A button: a sprung cap that slides into the panel and clicks. Internal to this folder.
#pragma once

#include "host_sim/world/multibody_part.hpp"
#include "host_sim/world/world.hpp"

namespace lf::world {

class ButtonBody {
 public:
  // `base_from_button`: on the panel's plane at the cap's centre, z out of the panel.
  ButtonBody(const ButtonConfig& config, const Pose& base_from_button, const scene::Body& cap, int scene_body, double step_s);

  void before_step();
  void after_step();
  const ButtonState& state() const { return state_; }
  // All the way out, and still.
  bool at_rest() const;
  Pose base_from_cap() const { return part_.base_from_link(0); }
  MultibodyPart& part() { return part_; }
  const MultibodyPart& part() const { return part_; }

 private:
  ButtonConfig config_;
  double step_s_;
  MultibodyPart part_;
  JointRows* rows_ = nullptr;
  ButtonState state_;
};

}  // namespace lf::world
