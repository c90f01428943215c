// A box that something pushes against the arm: a cable, kelp with a stone in it. It floats: pushed to the right, it gives way to all sides and slides off what
// is oblique, so that it presses on what stands with no more than the push and its own momentum; what moves against it feels the water's drag, too. It does not turn. Internal to this folder.
#pragma once

#include "host_sim/world/multibody_part.hpp"
#include "shared/geometry/pose.hpp"

namespace lf::world {

class Obstacle {
 public:
  // Enters `world` 0.2 m to the left of `target_m` in the base frame, and is pushed to the right. `scene_body`: the body it counts as.
  Obstacle(btMultiBodyDynamicsWorld& world, const Vec3& target_m, int scene_body);
  ~Obstacle();
  Obstacle(const Obstacle&) = delete;
  Obstacle& operator=(const Obstacle&) = delete;

  void before_step();

 private:
  btMultiBodyDynamicsWorld& world_;
  MultibodyPart part_;
};

}  // namespace lf::world
