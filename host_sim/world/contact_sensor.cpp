#include "host_sim/world/contact_sensor.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>

#include "host_sim/world/bullet_types.hpp"

namespace lf::world {
namespace {

using scene::BodyId, scene::Role;

bool is_beyond_wrist(Role body) { return body == Role::hand || body == Role::finger; }
bool is_robot(Role body) { return body == Role::vehicle || body == Role::link || is_beyond_wrist(body); }
bool is_handled(Role body) { return body == Role::handle || body == Role::button; }

void add(Wrench& sum, const Vec3& impulse, const Vec3& arm) {
  sum.force_n += impulse;
  sum.torque_nm += arm.cross(impulse);
}

ContactImpulse reversed(const ContactImpulse& contact) { return {contact.b, contact.a, contact.point_m, -contact.impulse_n_s}; }

}  // namespace

void take_contact_impulses(btDispatcher& dispatcher, std::vector<ContactImpulse>& impulses) {
  impulses.clear();
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const int a = manifold.getBody0()->getUserIndex();
    const int b = manifold.getBody1()->getUserIndex();
    if (a < 0 || b < 0) continue;
    for (int c = 0; c < manifold.getNumContacts(); ++c) {
      btManifoldPoint& point = manifold.getContactPoint(c);
      const btVector3 impulse = point.m_appliedImpulse * point.m_normalWorldOnB +
                                point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                                point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
      point.m_appliedImpulse = point.m_appliedImpulseLateral1 = point.m_appliedImpulseLateral2 = 0;
      if (impulse.isZero()) continue;
      const btVector3 middle = 0.5 * (point.getPositionWorldOnA() + point.getPositionWorldOnB());
      impulses.push_back({BodyId(a), BodyId(b), from_bullet(middle), from_bullet(impulse)});
    }
  }
}

bool contact_is_intended(Role a, Role b) {
  return (a == Role::finger && (b == Role::finger || is_handled(b))) || (b == Role::finger && is_handled(a));
}

ContactSensor::ContactSensor(double window_s, double judged_window_s, double step_s, const Vec3& vehicle_com_m, const scene::Scene& scene)
    : judged_window_s_(judged_window_s),
      step_s_(step_s),
      vehicle_com_m_(vehicle_com_m),
      own_(scene::own_bodies(scene)),
      tool_(window_s, step_s),
      base_(window_s, step_s),
      handle_(window_s, step_s),
      grip_{ForceWindow(window_s, step_s), ForceWindow(window_s, step_s)},
      on_body_(scene.size(), ForceWindow(judged_window_s, step_s)),
      on_body_now_(scene.size()) {
  for (const scene::Body& body : scene) bodies_.push_back({body.name, body.role});
}

void ContactSensor::take(const std::vector<ContactImpulse>& impulses, const Pose& base_from_tool, double time_s) {
  Wrench tool, base, handle;
  std::array<Wrench, 2> grip;
  std::fill(on_body_now_.begin(), on_body_now_.end(), Wrench{});
  const Mat3 tool_from_base = base_from_tool.linear().transpose();
  for (const ContactImpulse& seen : impulses) {
    for (const ContactImpulse& contact : {seen, reversed(seen)}) {
      const Role own = role(contact.a), other = role(contact.b);
      if (own == Role::handle) add(handle, contact.impulse_n_s, Vec3::Zero());
      if (!is_robot(own) || is_robot(other)) continue;
      add(base, contact.impulse_n_s, contact.point_m - vehicle_com_m_);
      add(on_body_now_[contact.b], -contact.impulse_n_s, Vec3::Zero());
      if (is_beyond_wrist(own)) {
        add(tool, tool_from_base * contact.impulse_n_s, tool_from_base * (contact.point_m - base_from_tool.translation()));
      }
      if (own == Role::finger && other == Role::handle) {
        add(grip[contact.a == own_.finger_a() ? 0 : 1], tool_from_base * contact.impulse_n_s, Vec3::Zero());
      }
    }
    if (!contact_is_intended(role(seen.a), role(seen.b))) add_to_unintended(seen, time_s);
  }
  tool_.add(tool);
  base_.add(base);
  handle_.add(handle);
  for (std::size_t i = 0; i < grip.size(); ++i) grip_[i].add(grip[i]);
  for (std::size_t i = 0; i < on_body_.size(); ++i) on_body_[i].add(on_body_now_[i]);
  for (Unintended& pair : unintended_) {
    pair.force.add(pair.step);
    pair.step = {};
    pair.contact.peak_force_n = std::max(pair.contact.peak_force_n, pair.force.mean().force_n.norm());
  }
  peak_force_n_ = std::max(peak_force_n_, largest_force_n());
}

// On one body, by all of the robot: two fingers that squeeze a bar load it with what is left of their forces. Pairs that should not have met, as the arm and
// its vehicle, are among them each by itself.
double ContactSensor::largest_force_n() const {
  double largest = 0;
  for (const ForceWindow& body : on_body_) largest = std::max(largest, body.mean().force_n.norm());
  for (const Unintended& pair : unintended_) largest = std::max(largest, pair.force.mean().force_n.norm());
  return largest;
}

void ContactSensor::add_to_unintended(const ContactImpulse& contact, double time_s) {
  const BodyId first = std::min(contact.a, contact.b);
  const BodyId second = std::max(contact.a, contact.b);
  auto found = std::find_if(unintended_.begin(), unintended_.end(),
                            [&](const Unintended& pair) { return pair.contact.a == first && pair.contact.b == second; });
  if (found == unintended_.end()) {
    unintended_.push_back({{first, second, time_s, 0, name(first), name(second)}, ForceWindow(judged_window_s_, step_s_), {}});
    found = unintended_.end() - 1;
  }
  const Vec3 on_first = contact.a == first ? contact.impulse_n_s : Vec3(-contact.impulse_n_s);
  add(found->step, on_first, Vec3::Zero());
}

ContactReport ContactSensor::report() const {
  ContactReport report;
  report.tool_wrench = tool_.mean();
  report.base_wrench = base_.mean();
  report.handle_force_n = handle_.mean().force_n;
  report.grip_force_n = 0.5 * (std::abs(grip_[0].mean().force_n.x()) + std::abs(grip_[1].mean().force_n.x()));
  report.largest_force_n = largest_force_n();
  report.peak_force_n = peak_force_n_;
  report.obstacle_force_n = on_body_[own_.obstacle()].mean().force_n.norm();
  for (const Unintended& pair : unintended_) report.unintended.push_back(pair.contact);
  return report;
}

}  // namespace lf::world
