// Reads what contacts did in a step and keeps the forces that sensors would show. Internal to this folder.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

#include <array>
#include <string>
#include <vector>

#include "host_sim/world/contact_force.hpp"
#include "host_sim/world/world.hpp"

namespace lf::world {

// The impulse of the last step on body `a` by body `b`, in B.
struct ContactImpulse {
  scene::BodyId a = 0, b = 0;
  Vec3 point_m = Vec3::Zero();
  Vec3 impulse_n_s = Vec3::Zero();
};

// All contacts that exchanged an impulse in the last step, in Bullet's order. Clears the impulses, which Bullet would keep for contacts that it does not
// solve again. Colliders whose user index is not a body of the scene are left out.
void take_contact_impulses(btDispatcher& dispatcher, std::vector<ContactImpulse>& impulses);

// Fingers may touch each other, handles and buttons; handles and buttons never touch the panel they are set in.
bool contact_is_intended(scene::Role a, scene::Role b);

class ContactSensor {
 public:
  // Wrenches are averaged over `window_s`, largest and peak forces over `judged_window_s`. Of `scene` the bodies' names and roles are kept.
  ContactSensor(double window_s, double judged_window_s, double step_s, const Vec3& vehicle_com_m, const scene::Scene& scene);

  // Takes the last step's impulses. `base_from_tool` is the tool as the step began.
  void take(const std::vector<ContactImpulse>& impulses, const Pose& base_from_tool, double time_s);
  ContactReport report() const;

 private:
  struct Unintended {
    UnintendedContact contact;
    ForceWindow force;
    Wrench step;
  };

  void add_to_unintended(const ContactImpulse& contact, double time_s);
  double largest_force_n() const;

  struct Touchable {
    std::string name;
    scene::Role role{};
  };
  scene::Role role(scene::BodyId body) const { return bodies_[body].role; }
  const std::string& name(scene::BodyId body) const { return bodies_[body].name; }

  double judged_window_s_, step_s_;
  Vec3 vehicle_com_m_;
  std::vector<Touchable> bodies_;
  scene::OwnBodies own_;
  ForceWindow tool_, base_, handle_;
  std::array<ForceWindow, 2> grip_;
  std::vector<ForceWindow> on_body_;  // by the robot, on each body that is not of it
  std::vector<Wrench> on_body_now_;   // in the step
  double peak_force_n_ = 0;
  std::vector<Unintended> unintended_;
};

}  // namespace lf::world
