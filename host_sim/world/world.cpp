#include "host_sim/world/world.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>
#include <string>

#include "host_sim/world/arm_body.hpp"
#include "host_sim/world/bullet_types.hpp"
#include "host_sim/world/bullet_world.hpp"
#include "host_sim/world/button_body.hpp"
#include "host_sim/world/config_check.hpp"
#include "host_sim/world/contact_sensor.hpp"
#include "host_sim/world/fixed_object.hpp"
#include "host_sim/world/obstacle.hpp"
#include "host_sim/world/start_clash.hpp"
#include "host_sim/world/valve_body.hpp"
#include "shared/input_error.hpp"

namespace lf::world {
namespace {

// The valve and the buttons join the simulation when the arm comes this near, and leave it once they rest and it is gone: at rest they change nothing. The arm
// moves by less than 2 mm a step.
constexpr double near_m = 0.02;

// Objects may touch the robot, the handle and the buttons as a run begins, no more.
constexpr double start_gap_m = 0.001;

const WorldConfig& checked(const WorldConfig& config) {
  check(config);
  return config;
}

Pose base_from_place(const WorldConfig& config, const Vec2& at_m) {
  return config.base_from_panel * Eigen::Translation3d(at_m.x(), at_m.y(), 0);
}

struct Box {
  btVector3 min_m, max_m;
};

Box box_of(const MultibodyPart& part) {
  const btCollisionObject& collider = *part.colliders().back();
  Box box;
  collider.getCollisionShape()->getAabb(collider.getWorldTransform(), box.min_m, box.max_m);
  box.min_m -= btVector3(near_m, near_m, near_m);
  box.max_m += btVector3(near_m, near_m, near_m);
  return box;
}

class Digest {
 public:
  void add(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int byte = 0; byte < 8; ++byte) hash_ = (hash_ ^ ((bits >> (8 * byte)) & 0xFF)) * 0x100000001b3ULL;
  }
  void add(const Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;  // FNV-1a offset and prime, 64 bits
};

}  // namespace

struct World::Impl {
  WorldConfig config;
  scene::OwnBodies own;
  BulletWorld bullet;
  ArmBody arm;
  CollisionShape panel_shape;
  std::unique_ptr<btRigidBody> panel;
  // Deques: what is in them cannot be moved.
  std::deque<ValveBody> valves;
  std::deque<ButtonBody> buttons;
  std::size_t own_bodies;
  std::vector<std::unique_ptr<FixedObject>> objects;
  ContactSensor sensor;
  std::vector<ContactImpulse> impulses;
  std::unique_ptr<Obstacle> obstacle;
  std::vector<bool> handle_is_there;
  std::int64_t steps = 0;

  explicit Impl(const WorldConfig& from)
      : config(checked(from)),
        own(scene::own_bodies(config.scene)),
        bullet(config.solver_iterations, config.restitution, config.scene, config.arm.rolls),
        arm(config.arm, config.scene,
            {config.start_rad, config.joint_drag_nm_s, config.drive_stiffness_nm_rad, config.step_s, config.drag_coefficient}),
        panel_shape(make_collision_shape(config.scene[own.panel()], Pose::Identity())),
        own_bodies(scene::own_body_count(config.scene)),
        sensor(config.force_window_s, config.judged_window_s, config.step_s, config.vehicle_com_m, config.scene),
        handle_is_there(config.valves.size(), true) {
    add_valves_and_buttons();
    arm.part().enter(bullet.get());
    panel = std::make_unique<btRigidBody>(0, nullptr, panel_shape.compound.get());
    panel->setWorldTransform(to_bullet(config.base_from_panel));
    panel->setUserIndex(int(own.panel()));
    bullet.get().addCollisionObject(panel.get());
    for (std::size_t i = own_bodies; i < config.scene.size(); ++i)
      objects.push_back(std::make_unique<FixedObject>(bullet.get(), config.scene[i], config.scene[i].base_from_body, int(i)));
  }

  // What an object may not stand in as the world begins: all but the panel, in which it may be set, and what a fault brings later.
  std::vector<const btCollisionObject*> not_to_stand_in() const {
    std::vector<const btCollisionObject*> all;
    const auto add = [&](const MultibodyPart& part) {
      for (const auto& collider : part.colliders()) {
        if (collider->getUserIndex() >= 0) all.push_back(collider.get());
      }
    };
    add(arm.part());
    for (const ValveBody& valve : valves) add(valve.part());
    for (const ButtonBody& button : buttons) add(button.part());
    return all;
  }

  void refuse_clashes(const scene::BodyPoses& base_from_body) {
    std::string problems;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const scene::Body& object = config.scene[own_bodies + i];
      for (const btCollisionObject* other : not_to_stand_in()) {
        double depth_m = 0;
        for (btCollisionObject* part : objects[i]->colliders()) depth_m = std::max(depth_m, overlap_m(bullet.get(), *part, *other));
        const auto index = std::size_t(other->getUserIndex());
        const scene::Body& stood_in = config.scene[index];
        const bool inside = is_inside(stood_in, base_from_body[index], object);
        if (depth_m < start_gap_m && !inside) continue;
        problems += (problems.empty() ? "" : "\n") +
                    ("scene: '" + object.name + "' stands in the " + stood_in.name + " as a run begins" +
                     (inside ? ", which lies inside of it" : ", by " + std::to_string(std::lround(1e3 * depth_m)) + " mm") + ": move it");
        break;
      }
    }
    if (!problems.empty()) throw InputError(problems);
  }

  ~Impl() {
    obstacle.reset();
    objects.clear();
    for (ButtonBody& button : buttons) button.part().leave(bullet.get());
    for (ValveBody& valve : valves) valve.part().leave(bullet.get());
    bullet.get().removeCollisionObject(panel.get());
    arm.part().leave(bullet.get());
  }

  void add_valves_and_buttons() {
    std::size_t body = own.first_feature();
    for (std::size_t i = 0; i < config.valves.size(); ++i, ++body)
      valves.emplace_back(config.valves[i], base_from_place(config, config.layout.valves[i].at_m), config.scene[body], int(body),
                          config.step_s);
    for (std::size_t i = 0; i < config.buttons.size(); ++i, ++body)
      buttons.emplace_back(config.buttons[i], base_from_place(config, config.layout.buttons[i].at_m), config.scene[body], int(body),
                           config.step_s);
  }

  bool arm_is_near(const MultibodyPart& part) {
    const Box box = box_of(part);
    for (const auto& collider : arm.part().colliders()) {
      const btBroadphaseProxy& proxy = *collider->getBroadphaseHandle();
      if (TestAabbAgainstAabb2(box.min_m, box.max_m, proxy.m_aabbMin, proxy.m_aabbMax)) return true;
    }
    return false;
  }

  template <typename Mechanism>
  void enter_or_leave(Mechanism& mechanism) {
    const bool moves = arm_is_near(mechanism.part()) || !mechanism.at_rest();
    if (moves && !mechanism.part().entered()) mechanism.part().enter(bullet.get());
    if (!moves && mechanism.part().entered()) mechanism.part().leave(bullet.get());
  }

  void step() {
    for (std::size_t i = 0; i < valves.size(); ++i) {
      if (handle_is_there[i]) enter_or_leave(valves[i]);
    }
    for (ButtonBody& button : buttons) enter_or_leave(button);
    const Pose base_from_tool = arm.base_from_tool();
    arm.before_step();
    if (obstacle) obstacle->before_step();
    for (ValveBody& valve : valves) {
      if (valve.part().entered()) valve.before_step();
    }
    for (ButtonBody& button : buttons) {
      if (button.part().entered()) button.before_step();
    }
    bullet.step(config.step_s);
    arm.after_step();
    for (ButtonBody& button : buttons) {
      if (button.part().entered()) button.after_step();
    }
    ++steps;
    take_contact_impulses(*bullet.get().getDispatcher(), impulses);
    sensor.take(impulses, base_from_tool, double(steps) * config.step_s);
  }
};

World::World(const WorldConfig& config) : impl_(std::make_unique<Impl>(config)) { impl_->refuse_clashes(base_from_body()); }
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

void World::set_drives(const JointDrives& drives) { impl_->arm.set_drives(drives); }
void World::step() { impl_->step(); }
void World::break_handle(std::size_t valve) {
  impl_->handle_is_there.at(valve) = false;
  MultibodyPart& part = impl_->valves.at(valve).part();
  if (part.entered()) part.leave(impl_->bullet.get());
}

void World::push_obstacle() {
  const Vec3 wrist_m = impl_->arm.base_from_link(impl_->own.hand).translation();
  if (!impl_->obstacle) impl_->obstacle = std::make_unique<Obstacle>(impl_->bullet.get(), wrist_m, int(impl_->own.obstacle()));
}

void World::block_jaw(double lower_rad, double upper_rad) { impl_->arm.limit_jaw(lower_rad, upper_rad); }

double World::time_s() const { return double(impl_->steps) * impl_->config.step_s; }
JointReadings World::readings() const { return impl_->arm.readings(); }
Pose World::base_from_panel() const { return impl_->config.base_from_panel; }
Pose World::base_from_tool() const { return impl_->arm.base_from_tool(); }
std::size_t World::valve_count() const { return impl_->valves.size(); }
double World::valve_angle_rad(std::size_t valve) const { return impl_->valves.at(valve).angle_rad(); }
double World::valve_speed_rad_s(std::size_t valve) const { return impl_->valves.at(valve).speed_rad_s(); }
std::size_t World::button_count() const { return impl_->buttons.size(); }
ButtonState World::button(std::size_t index) const { return impl_->buttons.at(index).state(); }
ContactReport World::contacts() const { return impl_->sensor.report(); }
double World::arm_kinetic_energy_j() const { return impl_->arm.kinetic_energy_j(); }

scene::BodyPoses World::base_from_body() const {
  scene::BodyPoses poses;
  poses.reserve(impl_->config.scene.size());
  for (const scene::Body& body : impl_->config.scene) poses.push_back(body.base_from_body);
  for (std::size_t i = 0; i < impl_->config.arm.links.size(); ++i) poses[i] = impl_->arm.base_from_link(i);
  poses[impl_->own.panel()] = impl_->config.base_from_panel;
  std::size_t body = impl_->own.first_feature();
  for (const ValveBody& valve : impl_->valves) poses[body++] = valve.base_from_handle();
  for (const ButtonBody& button : impl_->buttons) poses[body++] = button.base_from_cap();
  return poses;
}

std::uint64_t World::state_digest() const {
  Digest digest;
  for (const JointReading& joint : impl_->arm.readings()) {
    for (const double value : {joint.position_rad, joint.motor_position_rad, joint.velocity_rad_s, joint.torque_nm}) digest.add(value);
  }
  for (const ValveBody& valve : impl_->valves) {
    digest.add(valve.angle_rad());
    digest.add(valve.speed_rad_s());
  }
  for (const ButtonBody& button : impl_->buttons) {
    digest.add(button.state().depth_m);
    digest.add(double(button.state().presses));
  }
  const ContactReport contacts = impl_->sensor.report();
  digest.add(contacts.tool_wrench.force_n);
  digest.add(contacts.tool_wrench.torque_nm);
  digest.add(contacts.base_wrench.torque_nm);
  digest.add(contacts.peak_force_n);
  return digest.value();
}

}  // namespace lf::world
