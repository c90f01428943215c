// The docked vehicle's world in Bullet: arm, gripper, panel, valves, buttons and their contacts, stepped at a fixed rate.
//
// Everything is computed and given in the base frame B (x toward the panel, y right, z down), which stands still while the vehicle is docked.
// Valves are turned, and buttons are pressed, by contact and friction only. Without noise or clocks: equal calls give equal bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/world/contact_force.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/panel/panel_layout.hpp"
#include "shared/scene/scene.hpp"

namespace lf::world {

// A T-bar on a shaft. Angles as in geometry/pose.hpp: about panel z, 0 is a vertical bar.
struct ValveConfig {
  double start_rad = 0;
  double friction_nm = 1.5;      // Coulomb: what it takes to move it
  double viscous_nm_s = 0.05;    // per rad/s
  double inertia_kg_m2 = 1e-3;   // handle, stem and the fluid they move; below 1e-4 the contact jitters (Bullet, 1 kHz)
  double stop_min_rad = -1.832;  // -105 deg, so that +/-90 deg is clear of the stops
  double stop_max_rad = 1.832;
  std::vector<double> detents_rad;   // the named positions
  double detent_nm = 0.3;            // peak torque toward a detent, on top of the friction
  double detent_width_rad = 0.0873;  // half a detent's width: the pull is -detent_nm sin(pi x / width), gone at the edge
};

// A sprung cap: force to hold it at depth x is preload + spring x, and less by `click_drop_n` once it has clicked.
struct ButtonConfig {
  double preload_n = 5;
  double spring_n_m = 2000;
  double damping_n_s_m = 20;
  double stroke_m = 0.005;
  double click_depth_m = 0.0035;    // going in: pressed, and counted
  double release_depth_m = 0.0025;  // coming out: no longer pressed
  double click_drop_n = 3;
  bool stuck = false;     // it does not move
  double mass_kg = 0.25;  // cap, plunger and water; below 0.2 kg a bottomed cap overtravels (Bullet, 1 kHz, 30 iterations)
};

// What screws, links and pads of the default arm give way by under load, lumped at the joints. 4000 N m/rad is 30 kN/m at the tool, and 0.2 mm of sag from its weight
// in water.
inline PerJoint<double> usual_stiffness_nm_rad() {
  PerJoint<double> all{};
  constexpr std::size_t arm_joints = 4;
  for (std::size_t i = 0; i <= arm_joints; ++i) all[i] = static_cast<double>(ArmModel::usual_stiffness_nm_rad(i, arm_joints));
  return all;
}
// At which a run finds the jaw.
inline constexpr double half_open_rad = 0.3;

struct WorldConfig {
  ArmDescription arm;
  PanelLayout layout;
  scene::Scene scene;                       // shapes with `collides` are collided; see shared/scene/panel_scene.hpp
  Pose base_from_panel = Pose::Identity();  // true
  std::vector<ValveConfig> valves{{}};      // as the layout's
  std::vector<ButtonConfig> buttons{{}, {}, {}};
  PerJoint<double> start_rad{0, 0.60, 1.90, 0, half_open_rad};         // parked
  Vec3 vehicle_com_m = Vec3(-0.5, 0, -0.3);                            // where the base wrench is taken, in B
  PerJoint<double> drive_stiffness_nm_rad = usual_stiffness_nm_rad();  // 0 rigid
  double drag_coefficient =
      1.1;  // of the links across the flow: a cylinder's at Reynolds numbers of 1e3 to 1e5 (Hoerner, Fluid-Dynamic Drag, 1965)
  double joint_drag_nm_s = 0.5;  // viscous, each arm joint in water, per rad/s; the jaw's fingers a tenth of it
  double restitution = 0;        // of every contact that closes at 1 cm/s or more
  double step_s = 0.001;
  double force_window_s = 0.020;   // over which a sensor would average a contact's wrench
  double judged_window_s = 0.050;  // over which a contact's force is judged: what panel and arm bear
  int solver_iterations = 50;      // 30 leave a bar askew between pads that are not parallel to it
};

struct ButtonState {
  double depth_m = 0;
  bool pressed = false;
  std::uint32_t presses = 0;
};

// Two bodies that should not have met.
struct UnintendedContact {
  scene::BodyId a = 0, b = 0;  // in their order
  double first_s = 0;          // since the world began
  double peak_force_n = 0;     // over `judged_window_s`
  std::string name_a, name_b;
};

// Forces from contacts alone (no weight, no inertia), acting on the robot. Wrenches, handle and grip are averaged over `force_window_s`, the largest and the
// peak forces over `judged_window_s`.
struct ContactReport {
  Wrench tool_wrench;                  // on wrist and fingers, in the tool frame, about its origin
  Wrench base_wrench;                  // on arm and vehicle, in B, about `vehicle_com_m`
  Vec3 handle_force_n = Vec3::Zero();  // on all handles, in B
  double grip_force_n = 0;             // each finger's force on a handle along the jaw's closing direction, mean of both
  double largest_force_n = 0;   // between the robot and one other body, or two parts that should not have met: opposed forces do not cancel
  double peak_force_n = 0;      // largest of it so far
  double obstacle_force_n = 0;  // of what push_obstacle() brought, over `judged_window_s`
  // Intended are: finger on finger, finger on handle, finger on button. Each other pair of bodies that touches is listed once, in order of time.
  std::vector<UnintendedContact> unintended;
};

class World {
 public:
  // Throws InputError when a value is not finite or out of its range, when layout, scene, valves and buttons do not belong together, when the arm starts outside its limits, and when an
  // object stands in the robot, the handle or a button.
  explicit World(const WorldConfig& config);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // What the drives do from the next step on. The jaw's torque is that on each of the two fingers. NaN holds the joint with no torque.
  void set_drives(const JointDrives& drives);
  // Advances by `step_s`.
  void step();

  // A handle breaks off: from the next step on it touches nothing, and its valve stays where it is.
  void break_handle(std::size_t valve);
  // From the next step on a box floats up from the wrist's left and pushes against it with 80 N.
  void push_obstacle();
  // From the next step on something rigid keeps the jaw's angle at or above `lower_rad` and at or below `upper_rad`. The jaw stands between the two when
  // this is called.
  void block_jaw(double lower_rad, double upper_rad);

  double time_s() const;
  // After construction and after each step. motor_position_rad: see drive_rows.hpp for the model of the play.
  JointReadings readings() const;
  scene::BodyPoses base_from_body() const;
  Pose base_from_tool() const;
  Pose base_from_panel() const;  // true
  std::size_t valve_count() const;
  double valve_angle_rad(std::size_t valve) const;
  double valve_speed_rad_s(std::size_t valve) const;
  std::size_t button_count() const;
  ButtonState button(std::size_t index) const;
  ContactReport contacts() const;
  // Kinetic energy of the arm, joule.
  double arm_kinetic_energy_j() const;
  // FNV-1a over the bits of the whole state: equal worlds have equal digests.
  std::uint64_t state_digest() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lf::world
