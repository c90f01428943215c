#include "host_sim/scenario/keys.hpp"

#include <limits>

namespace lf::scenario {

namespace {

// What mission.docking_m and mission.docking_rad may be told at most, and a little.
constexpr double far_m = 0.03, far_deg = 3;
constexpr double huge = std::numeric_limits<std::int32_t>::max();

using config::key;
using config::Keys;

void add_place(Keys& all, Scenario& s) {
  all.push_back(key("docking.x_m", "m", -far_m, far_m, &s.docking.x_m,
                    "how far the docked vehicle's panel stands off its place, away from the robot"));
  all.push_back(key("docking.y_m", "m", -far_m, far_m, &s.docking.y_m, "how far it stands off its place, to the right"));
  all.push_back(key("docking.z_m", "m", -far_m, far_m, &s.docking.z_m, "how far it stands off its place, downward"));
  all.push_back(
      key("docking.roll_deg", "deg", -far_deg, far_deg, &s.docking.roll_deg, "turn of the panel about the base's x axis, at its origin"));
  all.push_back(key("docking.pitch_deg", "deg", -far_deg, far_deg, &s.docking.pitch_deg, "the same about the base's y axis"));
  all.push_back(key("docking.yaw_deg", "deg", -far_deg, far_deg, &s.docking.yaw_deg, "the same about the base's z axis"));
  all.push_back(key("valve.start_deg", "deg", -180, 180, &s.valve.start_deg,
                    "the handle's angle at the start: 0 is a vertical bar, positive counter-clockwise"));
  all.push_back(key("valve.friction_nm", "N m", 0, 20, &s.valve.friction_nm, "torque that it takes to turn the handle"));
  config::add_valve_stops(all, s.valve);
  all.push_back(key("valve.detents_deg", "deg", -360, 360, &s.valve.detents_deg, "the named positions, in which the handle settles"));
  all.push_back(key("valve.detent_nm", "N m", 0, 6, &s.valve.detent_nm, "peak pull toward a detent"));
  all.push_back(key("valve.viscous_nm_s", "N m s/rad", 0, 20, &s.valve.viscous_nm_s, "viscous friction of the handle"));
  all.push_back(key("buttons.preload_n", "N", 0, 25, &s.buttons.preload_n, "force at which a button starts to move"));
  all.push_back(key("buttons.spring_n_m", "N/m", 0, 9000, &s.buttons.spring_n_m, "return spring of a button"));
  all.push_back(key("buttons.click_depth_m", "m", 0.0005, 0.02, &s.buttons.click_depth_m,
                    "depth at which a button clicks and counts; within its stroke"));
  all.push_back(key("buttons.release_depth_m", "m", 0.0001, 0.02, &s.buttons.release_depth_m,
                    "depth at which it lets go on the way out; less than where it clicks"));
  all.push_back(key("buttons.click_drop_n", "N", 0, 20, &s.buttons.click_drop_n,
                    "force that a clicked button gives less; less than its spring gives where it lets go"));
  all.push_back(key("buttons.stuck", "", 0, 0, &s.buttons.stuck, "buttons that do not move", s.survey.names.buttons));
  all.push_back(key("buttons.missing", "", 0, 0, &s.buttons.missing, "buttons that broke off", s.survey.names.buttons));
}

void add_sight(Keys& all, Scenario& s) {
  all.push_back(key("water.attenuation_per_m", "1/m", 0, 5, &s.water.attenuation_per_m,
                    "attenuation of green light, absorption and scattering together"));
  all.push_back(key("water.scattering_share", "", -1, 1, &s.water.scattering_share,
                    "of the attenuation that scatters; below 0: as much as sea water of that attenuation"));
  all.push_back(key("water.scattering_percent", "%", -50, 50, &s.water.scattering_percent, "unknown part of what scatters"));
  all.push_back(key("water.phase_percent", "%", -50, 50, &s.water.phase_percent,
                    "unknown part of each share of the light that scatters: near, far, farther and back"));
  all.push_back(key("water.asymmetry", "", -0.99, 0.99, &s.water.asymmetry, "Henyey-Greenstein g of the light that scatters forward"));
  all.push_back(key("water.particles_per_l", "1/l", 0, 100, &s.water.particles_per_l, "specks of more than 0.5 mm in a litre of water"));
  all.push_back(key("water.ambient", "", 0, 100, &s.water.ambient, "daylight, over the default's"));
  all.push_back(key("lamps.lit", "", 0, 0, &s.lamps.lit, "whether the robot uses its lamps"));
  all.push_back(key("lamps.power", "", 0, 100, &s.lamps.power, "their power, over the default's"));
  all.push_back(key("camera.always_on", "", 0, 0, &s.camera.always_on, "a frame every 40 ms throughout, also when nobody needs it"));
  all.push_back(key("camera.noise_grey", "grey", 0, 50, &s.camera.noise_grey, "standard deviation of the read noise"));
  all.push_back(
      key("camera.blur_px", "px", 0, 4.5, &s.camera.blur_px, "standard deviation of the lens's spot in the middle of the picture"));
  all.push_back(key("camera.corner_blur", "", 1, 2.5, &s.camera.corner_blur,
                    "the spot at the picture's corners, over that in the middle; no spot is wider than 4.5 px"));
  all.push_back(key("camera.electrons_per_grey", "", 5, 1000, &s.camera.electrons_per_grey,
                    "electrons of a grey level at gain 1: the light's own noise; the core takes it for 40"));
  all.push_back(key("camera.exposure_jitter", "", 0, 0.02, &s.camera.exposure_jitter,
                    "standard deviation of a frame's exposure, or of the light, over the ordered one"));
  all.push_back(key("camera.ghost_share", "", 0, 0.01, &s.camera.ghost_share, "of the laser's light, in a second reflection"));
  all.push_back(key("camera.ghost_px", "px", 0, 100, &s.camera.ghost_px, "how far down the picture the second reflection lies"));
  config::add_camera(all, s.camera);
  all.push_back(key("laser.power_w", "W", 0, 10, &s.laser.power_w, "power of the line"));
  all.push_back(
      key("laser.waist_sigma_m", "m", 0.0001, 0.02, &s.laser.waist_sigma_m, "standard deviation of its cross-section at the emitter"));
  all.push_back(key("laser.speckle", "", 0, 0.5, &s.laser.speckle, "standard deviation of a pixel's laser light over its mean"));
  all.push_back(key("laser.waist_at_m", "m", -0.5, 0.5, &s.laser.waist_at_m, "range at which the line is narrowest"));
  all.push_back(key("laser.lobe_share", "", 0, 0.1, &s.laser.lobe_share,
                    "height of a second line beside the first, over the first's; the laser's plane is the middle of their light"));
  all.push_back(
      key("laser.lobe_sigmas", "", 0, 4, &s.laser.lobe_sigmas, "how far the second line lies from the first, in its standard deviations"));
  all.push_back(key("laser.lobe_ahead", "", 0, 0, &s.laser.lobe_ahead, "whether it lies on the side of the laser's x axis"));
  all.push_back(key("laser.fan_low_percent", "%", 0, 50, &s.laser.fan_low_percent, "most that the power changes slowly along the line"));
  all.push_back(key("laser.fan_fine_percent", "%", 0, 30, &s.laser.fan_fine_percent, "most that it changes in fine structure"));
  config::add_laser(all, s.laser);
  all.push_back(key("mounting.camera_m", "m", -0.005, 0.005, &s.mounting.camera_m, "unknown shift of the camera, each axis"));
  all.push_back(key("mounting.camera_deg", "deg", -0.4, 0.4, &s.mounting.camera_deg, "unknown turn of the camera, each axis"));
  all.push_back(key("mounting.laser_m", "m", -0.005, 0.005, &s.mounting.laser_m, "unknown shift of the laser, each axis"));
  all.push_back(key("mounting.laser_deg", "deg", -0.5, 0.5, &s.mounting.laser_deg, "unknown turn of the laser, each axis"));
  all.push_back(key("mounting.joints_deg", "deg", -0.3, 0.3, &s.mounting.joints_deg, "unknown offset of each joint's encoder"));
  all.push_back(
      key("mounting.marker_m", "m", -0.005, 0.005, &s.mounting.marker_m, "unknown shift of the marker within the panel, each axis"));
  all.push_back(key("mounting.marker_deg", "deg", -0.4, 0.4, &s.mounting.marker_deg, "unknown turn of the marker within the panel"));
}

void add_calibration(Keys& all, Scenario& s) {
  Calibration& c = s.calibration;
  all.push_back(key("calibration.principal_point_px", "px", -3, 3, &c.principal_point_px,
                    "unknown shift of the camera's principal point, each axis"));
  all.push_back(key("calibration.focal_percent", "%", -0.5, 0.5, &c.focal_percent, "unknown part of the focal length"));
  all.push_back(key("calibration.distortion_px", "px", -2, 2, &c.distortion_px,
                    "unknown distortion at the picture's corners, of each of the terms k1, p1, p2"));
  all.push_back(key("calibration.lens_percent", "%", -50, 50, &c.lens_percent, "unknown part of the lens's spot"));
  all.push_back(
      key("calibration.laser_cone_mrad", "mrad", -20, 20, &c.laser_cone_mrad, "cone that the laser's sheet is bent to; its middle stays"));
  all.push_back(key("calibration.beam_percent", "%", -50, 50, &c.beam_percent, "unknown part of the laser line's width"));
  all.push_back(key("calibration.buttons_m", "m", -0.002, 0.002, &c.buttons_m, "unknown shift of each button on the panel, each axis"));
  all.push_back(key("calibration.exposure_delay_ms", "ms", 0, 2, &c.exposure_delay_ms,
                    "from the trigger that the core takes for an exposure's start until the shutter opens"));
  all.push_back(key("calibration.stamp_ms", "ms", -1, 1, &c.stamp_ms, "by which an image's time stamp is late"));
  all.push_back(key("calibration.handle_m", "m", -0.002, 0.002, &c.handle_m, "unknown part of the handle's length, thickness and height"));
  all.push_back(key("calibration.button_size_m", "m", -0.002, 0.002, &c.button_size_m, "unknown part of the buttons' width and height"));
  all.push_back(key("calibration.marker_size_m", "m", -0.001, 0.001, &c.marker_size_m, "unknown part of the marker's size"));
  all.push_back(key("calibration.marker_flat_m", "m", -0.002, 0.002, &c.marker_flat_m,
                    "how far an edge of the marker's plate stands off the panel, each axis"));
}

void add_machine(Keys& all, Scenario& s) {
  config::add_vehicle(all, s.vehicle);
  config::add_arm(all, s.arm.urdf, s.arm.park_rad);
  all.push_back(key("jaw.torque_nm", "N m", 0, 200, &s.jaw.torque_nm,
                    "closing torque at each finger, no less than the rated one; 0: as the URDF says"));
  all.push_back(key("jaw.pad_friction", "", 0, 1.2, &s.jaw.pad_friction, "friction of the finger pads; 0: as the URDF says"));
  all.push_back(key("physics.restitution", "", 0, 0.5, &s.physics.restitution, "of every contact that closes at 1 cm/s or more"));
  all.push_back(key("physics.joint_drag_nm_s", "N m s/rad", 0, 5, &s.physics.joint_drag_nm_s, "drag of the water on each joint"));
  all.push_back(key("physics.drag_coefficient", "", 0, 3, &s.physics.drag_coefficient,
                    "of the water on the links, across them; a cylinder's is 1.1"));
  all.push_back(key("physics.torque_noise_ratio", "", 0, 0.02, &s.physics.torque_noise_ratio,
                    "1 sigma of a drive's torque reading over its rated torque"));
  all.push_back(
      key("physics.water_celsius", "deg C", -2, 60, &s.physics.water_celsius, "water temperature: where the motors' windings start"));
  all.push_back(key("physics.stops_from_demand", "", 0, 0, &s.physics.stops_from_demand,
                    "a drive's stop begins where its set-point is, and not where its joint is: makers do not say which"));
  all.push_back(key("friction.coulomb", "", 0, 2, &s.friction.coulomb,
                    "true Coulomb friction of each drive's screw or gear, over what the core takes it for"));
  all.push_back(key("friction.viscous", "", 0, 10, &s.friction.viscous, "the same of the viscous friction"));
  all.push_back(key("friction.efficiency", "", 0.6, 1.3, &s.friction.efficiency,
                    "the same of the efficiency with which a motor drives its load, which is never above 1"));
  all.push_back(key("friction.back_efficiency", "", 0, 1.3, &s.friction.back_efficiency,
                    "the same of the efficiency with which a load drives its motor; 0: the screw locks itself"));
  all.push_back(
      key("friction.breakaway", "", 1, 2, &s.friction.breakaway, "Coulomb friction of a motor that stands over that of one that moves"));
  all.push_back(key("friction.one_way", "", -0.5, 0.5, &s.friction.one_way, "share by which it is more forward and less backward"));
  all.push_back(key("friction.pivot_m", "m", -0.0005, 0.0005, &s.friction.pivot_m,
                    "how much longer the true linkage of each screw is from its joint to its far pivot than the core takes it for"));
  all.push_back(key("latency.image_ms", "ms", 0, 250, &s.latency.image_ms,
                    "from the start of an exposure until the core has its image; less than stale_image_s of the safety limits"));
  all.push_back(key("latency.panel_vision_ms", "ms", 0, 4000, &s.latency.panel_vision_ms,
                    "from the question until the core has the panel vision's answer; less than vision_timeout_s of the safety limits"));
  all.push_back(key("sensors.seed", "", 0, huge, &s.sensors.seed, "of camera and drive noise; 0: from the run's seed"));
  all.push_back(key("safety.limits", "", 0, 0, &s.safety.limits, "the checksummed file of limits; found as arm.urdf is"));
  all.push_back(key("safety.mission_limits", "", 0, 0, &s.safety.mission_limits,
                    "a file of the same form with limits of this mission, none wider; empty: the same"));
}

}  // namespace

std::vector<Key> keys(Scenario& scenario) {
  Keys all;
  all.push_back(key("description", "", 0, 0, &scenario.description, "one line that `lanternfish scenarios` shows"));
  all.push_back(key("time_limit_s", "s", 1, 7200, &scenario.time_limit_s, "simulated time after which the run is given up"));
  config::add_tasks(all, scenario.tasks, scenario.survey.names, "the job, in order");
  all.push_back(key("machine", "", 0, 0, &scenario.machine,
                    "a file of what the robot is, or a shipped one's name, whose values the keys of this file overrule; found as arm.urdf "
                    "is; empty: the robot is as the keys say"));
  all.push_back(key("scene", "", 0, 0, &scenario.scene, "a file of what else stands about; found as arm.urdf is; empty: nothing"));
  add_place(all, scenario);
  config::add_panel(all, scenario.panel_file, scenario.docked_panel);
  add_sight(all, scenario);
  add_calibration(all, scenario);
  add_machine(all, scenario);
  config::add_drives(all, scenario.drives, scenario.joints);
  config::add_mission(all, scenario.mission);
  all.push_back(key("faults", "", 0, 0, &scenario.faults, "what goes wrong, and when"));
  all.back().names.assign(scenario.joints.begin(), scenario.joints.end());
  std::vector<std::string> failures{Expect::nothing};
  for (std::size_t i = 0; i < safety::fault_count; ++i) failures.emplace_back(safety::name(static_cast<safety::Fault>(i)));
  all.push_back(key("expect.failure", "", 0, 0, &scenario.expect.failure,
                    "the fault that has to end the mission; the run succeeds when it does, safely", failures));
  return all;
}

}  // namespace lf::scenario
