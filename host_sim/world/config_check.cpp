#include "host_sim/world/config_check.hpp"

#include <cmath>
#include <string>

#include "shared/input_error.hpp"

namespace lf::world {
namespace {

void expect(bool holds, const std::string& name, const std::string& wish) {
  if (!holds) throw InputError("world: " + name + " " + wish);
}

void expect_positive(double value, const std::string& name) {
  expect(std::isfinite(value) && value > 0, name, "must be finite and above 0");
}
void expect_not_negative(double value, const std::string& name) {
  expect(std::isfinite(value) && value >= 0, name, "must be finite and not below 0");
}

void check_valve(const ValveConfig& valve, const std::string& name) {
  expect_not_negative(valve.friction_nm, name + ".friction_nm");
  expect_not_negative(valve.viscous_nm_s, name + ".viscous_nm_s");
  expect(std::isfinite(valve.inertia_kg_m2) && valve.inertia_kg_m2 >= 1e-4, name + ".inertia_kg_m2",
         "must be at least 1e-4 (below, contact jitters)");
  expect(std::isfinite(valve.stop_min_rad) && std::isfinite(valve.stop_max_rad) && valve.stop_min_rad < valve.stop_max_rad,
         name + ".stop_min_rad", "must be below stop_max_rad");
  expect(valve.start_rad >= valve.stop_min_rad && valve.start_rad <= valve.stop_max_rad, name + ".start_rad", "must lie between the stops");
  expect_not_negative(valve.detent_nm, name + ".detent_nm");
  expect_positive(valve.detent_width_rad, name + ".detent_width_rad");
  for (const double detent : valve.detents_rad) expect(std::isfinite(detent), name + ".detents_rad", "must be finite");
}

void check_button(const ButtonConfig& button, const std::string& name) {
  expect_not_negative(button.preload_n, name + ".preload_n");
  expect_not_negative(button.spring_n_m, name + ".spring_n_m");
  expect_not_negative(button.damping_n_s_m, name + ".damping_n_s_m");
  expect_positive(button.stroke_m, name + ".stroke_m");
  expect_positive(button.mass_kg, name + ".mass_kg");
  expect(button.release_depth_m > 0 && button.release_depth_m < button.click_depth_m && button.click_depth_m <= button.stroke_m,
         name + ".click_depth_m", "must lie above release_depth_m (> 0) and not beyond stroke_m");
  expect(button.click_drop_n >= 0 && button.click_drop_n < button.preload_n + button.spring_n_m * button.release_depth_m,
         name + ".click_drop_n", "must leave a force that returns the cap");
}

void check_arm(const WorldConfig& config) {
  for (std::size_t i = 1; i < config.arm.links.size(); ++i) {
    expect_positive(config.arm.links[i].mass_kg, "arm link " + config.arm.links[i].name + " mass");
    expect(std::isfinite(config.arm.links[i].wet_weight_n), "arm link " + config.arm.links[i].name + " wet weight", "must be finite");
  }
  for (std::size_t i = 0; i < config.arm.joints.size(); ++i) {
    const ArmJoint& joint = config.arm.joints[i];
    expect(joint.lower_rad < joint.upper_rad, "arm joint " + joint.name, "needs lower < upper");
    expect(config.start_rad[i] >= joint.lower_rad && config.start_rad[i] <= joint.upper_rad, "start_rad of " + joint.name,
           "must lie within the joint's limits");
    expect_not_negative(config.drive_stiffness_nm_rad[i], "drive_stiffness_nm_rad of " + joint.name);
    expect_not_negative(joint.backlash_rad, "arm joint " + joint.name + " backlash");
    expect_not_negative(joint.holding_torque_nm, "arm joint " + joint.name + " holding torque");
  }
}

void check_scene(const scene::Scene& scene, const PanelLayout& layout, std::size_t arm_joints) {
  PanelNames names;
  names.valves.resize(layout.valves.size());
  names.buttons.resize(layout.buttons.size());
  const scene::Scene own = scene::bare_scene(layout, names, std::vector<std::string>(arm_joints));
  expect(scene.size() >= own.size() && scene.size() <= scene::max_bodies, "scene",
         "must have its " + std::to_string(own.size()) + " own bodies, and " + std::to_string(scene::max_bodies) + " at most");
  for (std::size_t i = 0; i < own.size(); ++i) expect(scene[i].role == own[i].role, "scene", "must begin with its own bodies");
  for (std::size_t i = own.size(); i < scene.size(); ++i) {
    const Pose& pose = scene[i].base_from_body;
    expect(scene[i].role == scene::Role::object, scene[i].name, "must be an object: it follows the scene's own bodies");
    expect(pose.matrix().allFinite() && pose.linear().isUnitary(1e-6), scene[i].name, "must have a finite rotation and translation");
  }
}

}  // namespace

void check(const WorldConfig& config) {
  expect(config.base_from_panel.matrix().allFinite() && config.base_from_panel.linear().isUnitary(1e-6), "base_from_panel",
         "must be a finite rotation and translation");
  check_scene(config.scene, config.layout, config.arm.arm_joints());
  expect(config.valves.size() == config.layout.valves.size(), "valves", "must be as many as the layout's");
  expect(config.buttons.size() == config.layout.buttons.size(), "buttons", "must be as many as the layout's");
  expect(config.vehicle_com_m.allFinite(), "vehicle_com_m", "must be finite");
  // One alone has its name, of several each its number.
  for (std::size_t i = 0; i < config.valves.size(); ++i)
    check_valve(config.valves[i], config.valves.size() == 1 ? "valve" : "valves[" + std::to_string(i) + "]");
  for (std::size_t i = 0; i < config.buttons.size(); ++i) check_button(config.buttons[i], "buttons[" + std::to_string(i) + "]");
  check_arm(config);
  expect_not_negative(config.joint_drag_nm_s, "joint_drag_nm_s");
  expect_not_negative(config.drag_coefficient, "drag_coefficient");
  expect(config.restitution >= 0 && config.restitution <= 1, "restitution", "must lie in 0..1");
  expect(config.step_s > 0 && config.step_s <= 0.01, "step_s", "must lie in 0..0.01");
  expect(config.force_window_s >= config.step_s && config.force_window_s <= 10, "force_window_s", "must lie in step_s..10");
  expect(config.judged_window_s >= config.step_s && config.judged_window_s <= 10, "judged_window_s", "must lie in step_s..10");
  expect(config.solver_iterations >= 1 && config.solver_iterations <= 1000, "solver_iterations", "must lie in 1..1000");
}

}  // namespace lf::world
