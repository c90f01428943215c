#include "host_sim/scenario/keys.hpp"

#include <limits>

namespace lf::scenario {

namespace {

constexpr double far_m = 0.5;  // farther than this nothing of the layout is near its place
constexpr double huge = std::numeric_limits<std::int32_t>::max();

using Keys = std::vector<Key>;

Key key(std::string path, std::string unit, double min, double max, KeyValue value, std::string doc, std::vector<std::string> words = {}) {
  return {std::move(path), std::move(doc), std::move(unit), min, max, value, std::move(words)};
}

void add_place(Keys& all, Scenario& s) {
  all.push_back(key("docking.x_m", "m", -far_m, far_m, &s.docking.x_m,
                    "how far the docked vehicle's panel stands off its place, away from the robot"));
  all.push_back(key("docking.y_m", "m", -far_m, far_m, &s.docking.y_m, "the same to the right"));
  all.push_back(key("docking.z_m", "m", -far_m, far_m, &s.docking.z_m, "the same downward"));
  all.push_back(key("docking.roll_deg", "deg", -45, 45, &s.docking.roll_deg, "turn of the panel about the base's x axis, at the valve"));
  all.push_back(key("docking.pitch_deg", "deg", -45, 45, &s.docking.pitch_deg, "the same about the base's y axis"));
  all.push_back(key("docking.yaw_deg", "deg", -45, 45, &s.docking.yaw_deg, "the same about the base's z axis"));
  all.push_back(key("valve.start_deg", "deg", -180, 180, &s.valve.start_deg,
                    "the handle's angle at the start: 0 is a vertical bar, positive counter-clockwise"));
  all.push_back(key("valve.friction_nm", "N m", 0, 20, &s.valve.friction_nm, "torque that it takes to turn the handle"));
  all.push_back(key("valve.stop_min_deg", "deg", -360, 360, &s.valve.stop_min_deg, "end stop, clockwise"));
  all.push_back(key("valve.stop_max_deg", "deg", -360, 360, &s.valve.stop_max_deg, "end stop, counter-clockwise"));
  all.push_back(key("valve.detents_deg", "deg", -360, 360, &s.valve.detents_deg, "the named positions, in which the handle settles"));
  all.push_back(key("valve.detent_nm", "N m", 0, 20, &s.valve.detent_nm, "peak pull toward a detent"));
  all.push_back(key("valve.viscous_nm_s", "N m s/rad", 0, 20, &s.valve.viscous_nm_s, "viscous friction of the handle"));
  all.push_back(key("buttons.preload_n", "N", 0, 100, &s.buttons.preload_n, "force at which a button starts to move"));
  all.push_back(key("buttons.spring_n_m", "N/m", 0, 50000, &s.buttons.spring_n_m, "return spring of a button"));
  all.push_back(key("buttons.click_depth_m", "m", 0.0005, 0.05, &s.buttons.click_depth_m, "depth at which a button clicks and counts"));
  all.push_back(key("buttons.release_depth_m", "m", 0, 0.05, &s.buttons.release_depth_m, "depth at which it lets go on the way out"));
  all.push_back(key("buttons.click_drop_n", "N", 0, 100, &s.buttons.click_drop_n, "force that a clicked button gives less"));
}

void add_panel(Keys& all, PanelLayout& p) {
  all.push_back(key("panel.ahead_m", "m", 0.1, 1.2, &p.nominal_x_m, "nominal distance of the panel's plane from the arm's base"));
  all.push_back(key("panel.right_m", "m", -1, 1, &p.nominal_y_m, "nominal place of the valve, to the right"));
  all.push_back(key("panel.down_m", "m", -1, 1.5, &p.nominal_z_m, "nominal place of the valve, downward"));
  all.push_back(
      key("panel.plate_min_m", "m", -2, 2, &p.plate_min_m, "lower left corner of the plate as the robot sees it, from the valve"));
  all.push_back(key("panel.plate_max_m", "m", -2, 2, &p.plate_max_m, "upper right corner"));
  all.push_back(key("panel.handle_length_m", "m", 0.02, 0.5, &p.handle_length_m, "length of the T-bar"));
  all.push_back(key("panel.handle_thickness_m", "m", 0.004, 0.05, &p.handle_thickness_m, "its thickness"));
  all.push_back(key("panel.handle_height_m", "m", 0.03, 0.3, &p.handle_height_m, "its centre line's height over the panel"));
  all.push_back(key("panel.buttons_m", "m", -1, 1, &p.buttons_m, "left, centre and right button's [right, up] from the valve"));
  all.push_back(key("panel.button_width_m", "m", 0.005, 0.2, &p.button_width_m, "diameter of a button's cap"));
  all.push_back(key("panel.button_height_m", "m", 0.005, 0.1, &p.button_height_m, "its height over the panel"));
  all.push_back(key("panel.button_stroke_m", "m", 0.001, 0.05, &p.button_stroke_m, "how far it goes in"));
  all.push_back(key("panel.marker_id", "", 0, 586, &p.marker_id, "the AprilTag 36h11 beside the valve"));
  all.push_back(key("panel.marker_size_m", "m", 0.01, 0.5, &p.marker_size_m, "side of its black square"));
  all.push_back(key("panel.marker_plate_m", "m", 0.01, 0.6, &p.marker_plate_m, "side of its plate"));
  all.push_back(key("panel.marker_centre_m", "m", -1, 1, &p.marker_centre_m, "its centre's [right, up] from the valve"));
}

void add_sight(Keys& all, Scenario& s) {
  all.push_back(key("water.attenuation_per_m", "1/m", 0, 5, &s.water.attenuation_per_m,
                    "attenuation of green light, absorption and scattering together"));
  all.push_back(key("water.scattering_share", "", 0, 1, &s.water.scattering_share, "of the attenuation that scatters"));
  all.push_back(key("water.asymmetry", "", -0.99, 0.99, &s.water.asymmetry, "Henyey-Greenstein g of the scattering"));
  all.push_back(key("water.ambient", "", 0, 100, &s.water.ambient, "daylight, over the default's"));
  all.push_back(key("lamps.lit", "", 0, 0, &s.lamps.lit, "whether the robot uses its lamps"));
  all.push_back(key("lamps.power", "", 0, 100, &s.lamps.power, "their power, over the default's"));
  all.push_back(key("camera.always_on", "", 0, 0, &s.camera.always_on, "a frame every 40 ms throughout, also when nobody needs it"));
  all.push_back(key("camera.noise_grey", "grey", 0, 50, &s.camera.noise_grey, "standard deviation of the read noise"));
  all.push_back(key("camera.exposure_us", "us", 10, 30000, &s.camera.exposure_us, "exposure"));
  all.push_back(key("camera.blur_px", "px", 0, 10, &s.camera.blur_px, "standard deviation of the lens's spot"));
  all.push_back(key("camera.position_m", "m", -2, 2, &s.camera.position_m, "[x, y, z] in the arm's base frame"));
  all.push_back(key("camera.down_deg", "deg", -90, 90, &s.camera.down_deg, "how far it looks down"));
  all.push_back(key("camera.right_deg", "deg", -180, 180, &s.camera.right_deg, "how far it looks to the right"));
  all.push_back(key("camera.focal_px", "px", 50, 5000, &s.camera.focal_px, "focal length in water; the image is 640x480"));
  all.push_back(key("camera.distortion", "", -2, 2, &s.camera.distortion, "k1, k2, p1, p2, k3 as OpenCV has them"));
  all.push_back(key("laser.power_w", "W", 0, 10, &s.laser.power_w, "power of the line"));
  all.push_back(
      key("laser.waist_sigma_m", "m", 0.0001, 0.02, &s.laser.waist_sigma_m, "standard deviation of its cross-section at the emitter"));
  all.push_back(key("laser.fan_half_angle_deg", "deg", 5, 80, &s.laser.fan_half_angle_deg, "half of the fan's angle in water"));
  all.push_back(
      key("laser.position_m", "m", -1, 1, &s.laser.position_m, "[x, y, z] in the tool frame; the plane's normal is the tool's x"));
  all.push_back(key("mounting.camera_m", "m", -0.1, 0.1, &s.mounting.camera_m, "unknown shift of the camera, each axis"));
  all.push_back(key("mounting.camera_deg", "deg", -10, 10, &s.mounting.camera_deg, "unknown turn of the camera, each axis"));
  all.push_back(key("mounting.laser_m", "m", -0.1, 0.1, &s.mounting.laser_m, "unknown shift of the laser, each axis"));
  all.push_back(key("mounting.laser_deg", "deg", -10, 10, &s.mounting.laser_deg, "unknown turn of the laser, each axis"));
  all.push_back(key("mounting.joints_deg", "deg", -10, 10, &s.mounting.joints_deg, "unknown offset of each joint's encoder"));
  all.push_back(key("mounting.marker_m", "m", -0.1, 0.1, &s.mounting.marker_m, "unknown shift of the marker within the panel, each axis"));
  all.push_back(key("mounting.marker_deg", "deg", -10, 10, &s.mounting.marker_deg, "unknown turn of the marker within the panel"));
}

void add_machine(Keys& all, Scenario& s) {
  all.push_back(key("arm.urdf", "", 0, 0, &s.arm.urdf, "the arm; relative to the scenario's folder, then to the shipped files"));
  all.push_back(key("jaw.torque_nm", "N m", 0, 200, &s.jaw.torque_nm, "closing torque at each finger; 0: as the URDF says"));
  all.push_back(key("jaw.pad_friction", "", 0, 3, &s.jaw.pad_friction, "friction of the finger pads; 0: as the URDF says"));
  all.push_back(key("physics.restitution", "", 0, 1, &s.physics.restitution, "of every contact"));
  all.push_back(key("physics.joint_drag_nm_s", "N m s/rad", 0, 100, &s.physics.joint_drag_nm_s, "drag of the water on each joint"));
  all.push_back(key("physics.torque_noise_ratio", "", 0, 1, &s.physics.torque_noise_ratio,
                    "1 sigma of a drive's torque reading over its rated torque"));
  all.push_back(
      key("physics.water_celsius", "deg C", -2, 60, &s.physics.water_celsius, "water temperature: where the motors' windings start"));
  all.push_back(key("latency.image_ms", "ms", 0, 1000, &s.latency.image_ms, "from the start of an exposure until the core has its image"));
  all.push_back(key("latency.panel_vision_ms", "ms", 0, 10000, &s.latency.panel_vision_ms,
                    "from the question until the core has the panel vision's answer"));
  all.push_back(key("sensors.seed", "", 0, huge, &s.sensors.seed, "of camera and drive noise; 0: from the run's seed"));
  all.push_back(key("safety.limits", "", 0, 0, &s.safety.limits, "the checksummed file of limits; found as arm.urdf is"));
}

void add_mission(Keys& all, mission::MissionConfig& m) {
  const double rad_s = 3;
  all.push_back(key("mission.camera_syncs", "SYNC", 1, 250, &m.camera_syncs, "SYNCs from one exposure to the next; 10 are 25 Hz"));
  all.push_back(
      key("mission.frames_per_background", "", 2, 100, &m.frames_per_background, "one frame in so many is taken without the laser"));
  all.push_back(key("mission.sweep_speed_rad_s", "rad/s", 0.001, rad_s, &m.sweep_speed_rad_s,
                    "of the slowest moving joint while scanning: slower is denser, down to the joints' stiction"));
  all.push_back(key("mission.verify_band_m", "m", 0.01, 0.5, &m.verify_band_m, "half height of the second look's sweep around the valve"));
  all.push_back(key("mission.move_speed_fraction", "", 0.01, 1, &m.move_speed_fraction, "of the joints' speed limits, in free motion"));
  all.push_back(key("mission.approach_distance_m", "m", 0.01, 0.3, &m.approach_distance_m,
                    "where straight approaches start, along the panel's normal"));
  all.push_back(key("mission.approach_speed_m_s", "m/s", 0.001, 0.5, &m.approach_speed_m_s, "of straight guarded motions"));
  all.push_back(key("mission.press_speed_m_s", "m/s", 0.001, 0.2, &m.press_speed_m_s, "of a press"));
  all.push_back(
      key("mission.press_overtravel_m", "m", 0, 0.05, &m.press_overtravel_m, "beyond a button's bottom before the press counts as missed"));
  all.push_back(
      key("mission.press_torque_nm", "N m", 0.1, 100, &m.press_torque_nm, "rise of a joint's torque that says the button has bottomed"));
  all.push_back(key("mission.turn_speed_rad_s", "rad/s", 0.01, rad_s, &m.turn_speed_rad_s, "of the handle"));
  all.push_back(
      key("mission.valve_tolerance_rad", "rad", 0.001, 0.5, &m.valve_tolerance_rad, "what the second look accepts without turning again"));
  all.push_back(key("mission.tries", "", 1, 20, &m.tries, "of a step that may be taken again"));
}

// The alternatives of KeyValue, in their order.
struct TypeName {
  const Key& key;
  std::string operator()(double*) const { return "a number"; }
  std::string operator()(std::int64_t*) const { return "a whole number"; }
  std::string operator()(std::int32_t*) const { return "a whole number"; }
  std::string operator()(std::uint32_t*) const { return "a whole number"; }
  std::string operator()(bool*) const { return "true or false"; }
  std::string operator()(std::string*) const { return key.words.empty() ? "text" : "one of " + words(); }
  std::string operator()(Spread*) const { return "a number or {min: , max: }"; }
  std::string operator()(Chance*) const { return "true, false or either"; }
  std::string operator()(std::array<double, 3>*) const { return "a list of 3 numbers"; }
  std::string operator()(Vec2*) const { return "a list of 2 numbers"; }
  std::string operator()(std::array<Vec2, 3>*) const { return "a list of 3 lists of 2 numbers"; }
  std::string operator()(std::vector<double>*) const { return "a list of numbers"; }
  std::string operator()(std::vector<std::string>*) const { return key.words.empty() ? "a list of texts" : "a list of " + words(); }
  std::string operator()(std::vector<Task>*) const { return "a list of tasks"; }
  std::string operator()(std::vector<Fault>*) const { return "a list of faults"; }
  std::string words() const {
    std::string list;
    for (std::size_t i = 0; i < key.words.size(); ++i) list += (i == 0 ? "" : i + 1 == key.words.size() ? " or " : ", ") + key.words[i];
    return list;
  }
};

}  // namespace

std::vector<Key> keys(Scenario& scenario) {
  Keys all;
  all.push_back(key("description", "", 0, 0, &scenario.description, "one line that `lanternfish scenarios` shows"));
  all.push_back(key("time_limit_s", "s", 1, 7200, &scenario.time_limit_s, "simulated time after which the run is given up"));
  all.push_back(key("tasks", "", 0, 0, &scenario.tasks, "the job, in order"));
  add_place(all, scenario);
  add_panel(all, scenario.panel);
  add_sight(all, scenario);
  add_machine(all, scenario);
  add_mission(all, scenario.mission);
  all.push_back(key("faults", "", 0, 0, &scenario.faults, "what goes wrong, and when"));
  return all;
}

std::vector<Key> keys(Task& task) {
  return {key("turn_valve.to_deg", "deg", -180, 180, &task.to_deg, "turn the handle to this angle"),
          key("press_buttons.order", "", 0, 0, &task.order, "press these buttons, one after the other", {"left", "centre", "right"})};
}

std::vector<Key> keys(Fault& fault) {
  return {key("at_s", "s", 0, 7200, &fault.at_s, "when it happens"),
          key("kind", "", 0, 0, &fault.kind, "what happens",
              {"overcurrent", "hot", "following", "stuck_encoder", "silent", "reboot", "estop", "interlock_open", "drop_frames",
               "error_frames", "bus_off"}),
          key("node", "", 0, 0, &fault.node, "to which node, where the kind is a node's",
              {"slew", "shoulder", "elbow", "roll", "jaw", "io", "master"}),
          key("duration_s", "s", 0, 7200, &fault.duration_s, "how long; 0 for the rest of the run"),
          key("can_id", "", 0, 0x7FF, &fault.can_id, "drop_frames: the identifier whose frames are lost")};
}

std::string type_name(const Key& key) { return std::visit(TypeName{key}, key.value); }

}  // namespace lf::scenario
