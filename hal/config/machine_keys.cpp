#include "hal/config/machine.hpp"
#include "shared/can/default_node.hpp"

namespace lf::config {

void add_tasks(Keys& all, std::vector<Task>& tasks, const PanelNames& names, const std::string& doc) {
  all.push_back(key("tasks", "", 0, 0, &tasks, doc));
  all.back().names = names.buttons;
}

void add_panel(Keys& all, std::string& file, DockedPanel& p) {
  all.push_back(key("panel.file", "", 0, 0, &file,
                    "a shipped panel's name, or a file: it says what is on the panel, where it stands is said here; empty: "
                    "the docked mission's"));
  all.push_back(key("panel.ahead_m", "m", 0.25, 3, &p.nominal_x_m, "nominal distance of the panel's plane from the arm's base"));
  all.push_back(
      key("panel.right_m", "m", -1.5, 1.5, &p.nominal_y_m, "nominal place of the panel's origin, the valve's base, to the right"));
  all.push_back(key("panel.down_m", "m", -1.5, 1.5, &p.nominal_z_m, "nominal place of the panel's origin, downward"));
  all.push_back(
      key("panel.plate_min_m", "m", -1, 0, &p.plate_min_m, "lower left corner of the plate as the robot sees it, from the valve"));
  all.push_back(key("panel.plate_max_m", "m", 0, 1, &p.plate_max_m, "upper right corner"));
  all.push_back(key("panel.handle_length_m", "m", 0.06, 0.16, &p.handle_length_m,
                    "length of the T-bar: longer than the pads are wide, and clear of buttons and marker"));
  all.push_back(key("panel.handle_thickness_m", "m", 0.008, 0.05, &p.handle_thickness_m, "its thickness"));
  all.push_back(key("panel.handle_height_m", "m", 0.05, 0.13, &p.handle_height_m, "its centre line's height over the panel"));
  all.push_back(key("panel.pointer", "", 0, 0, &p.pointer,
                    "the mark at that end of the bar which points up at 0 degrees; without one a bar looks the same after half a turn",
                    {pointer_words.begin(), pointer_words.end()}));
  all.push_back(key("panel.pointer_length_m", "m", 0.015, 0.06, &p.pointer_length_m, "how much of the bar the mark covers, from its end"));
  all.push_back(key("panel.buttons_m", "m", -0.4, 0.4, &p.buttons_m, "left, centre and right button's [right, up] from the valve"));
  all.push_back(key("panel.button_width_m", "m", 0.005, 0.06, &p.button_width_m, "diameter of a button's cap"));
  all.push_back(key("panel.button_height_m", "m", 0.005, 0.07, &p.button_height_m,
                    "its height over the panel: its stroke, the press's overtravel up to 8 mm, and some 13 mm more where one is pressed, "
                    "by the tilt at which the arm comes"));
  all.push_back(key("panel.button_stroke_m", "m", 0.001, 0.02, &p.button_stroke_m, "how far it goes in"));
  all.push_back(key("panel.marker_id", "", 0, 586, &p.marker_id, "the AprilTag 36h11 beside the valve"));
  all.push_back(key("panel.marker_size_m", "m", 0.02, 0.16, &p.marker_size_m, "side of its black square"));
  all.push_back(key("panel.marker_plate_m", "m", 0.02, 0.2, &p.marker_plate_m, "side of its plate"));
  all.push_back(key("panel.marker_centre_m", "m", -0.6, 0.6, &p.marker_centre_m, "its centre's [right, up] from the valve"));
}

void add_valve_stops(Keys& all, ValveStops& valve) {
  all.push_back(key("valve.stop_min_deg", "deg", -180, 180, &valve.stop_min_deg, "end stop of the handle, clockwise"));
  all.push_back(
      key("valve.stop_max_deg", "deg", -180, 180, &valve.stop_max_deg, "end stop, counter-clockwise; at most 350 degrees from the other"));
}

void add_arm(Keys& all, std::string& urdf, std::vector<double>& park_rad) {
  constexpr double a_turn = 6.2832;
  all.push_back(
      key("arm.urdf", "", 0, 0, &urdf,
          "the arm: slew, shoulder, elbow, roll and a jaw of two fingers; relative to this file's folder, then to the shipped files"));
  all.push_back(
      key("arm.park_rad", "rad", -a_turn, a_turn, &park_rad,
          "[slew, shoulder, elbow, roll] of the folded arm: where it starts and ends, clear of the panel wherever that may stand"));
}

void add_camera(Keys& all, Camera& camera) {
  all.push_back(key("camera.exposure_us", "us", 10, 30000, &camera.exposure_us, "exposure"));
  all.push_back(key("camera.position_m", "m", -2, 2, &camera.position_m, "[x, y, z] in the arm's base frame"));
  all.push_back(key("camera.down_deg", "deg", -90, 90, &camera.down_deg, "how far it looks down"));
  all.push_back(key("camera.right_deg", "deg", -180, 180, &camera.right_deg, "how far it looks to the right"));
  all.push_back(key("camera.focal_px", "px", 50, 5000, &camera.focal_px, "focal length in water; the image is 640x480"));
  all.push_back(key("camera.distortion", "", -2, 2, &camera.distortion, "k1, k2, p1, p2, k3 as OpenCV has them"));
}

void add_laser(Keys& all, Laser& laser) {
  all.push_back(key("laser.fan_half_angle_deg", "deg", 5, 80, &laser.fan_half_angle_deg, "half of the fan's angle in water"));
  all.push_back(key("laser.position_m", "m", -1, 1, &laser.position_m, "[x, y, z] in the tool frame"));
  all.push_back(key("laser.turn_deg", "deg", -180, 180, &laser.turn_deg,
                    "about the tool's axis. At 0 the plane's normal is the tool's x; at 90 its y, for hands that open sideways"));
}

void add_vehicle(Keys& all, Vehicle& v) {
  constexpr double far_m = 5;
  all.push_back(key("vehicle.boxes_m", "m", -far_m, far_m, &v.boxes_m,
                    "what the arm must not touch, at most 16: [x, y, z, dx, dy, dz], centre and extents in the arm's base frame"));
  all.back().above_zero_from = 3;
  all.push_back(key("vehicle.capsules_m", "m", -far_m, far_m, &v.capsules_m,
                    "the same, round: [x, y, z, x, y, z, radius], the ends of its axis; camera and lamps among them"));
  all.back().above_zero_from = 6;
  all.push_back(key("vehicle.lamps_m", "m", -far_m, far_m, &v.lamps_m,
                    "where the lamps are, at most 8: [x, y, z] in the arm's base frame; simulated ones shine at the panel"));
}

void add_drives(Keys& all, Drives& d, const JointNames& names) {
  constexpr double most_counts = 1e6, most_nm = 1000, most_a = 1000;
  all.push_back(key("drives.profile", "", 0, 0, &d.profile, "make of the joints' drives: a shipped profile's name, or a file"));
  all.push_back(key("drives.counts_per_rev", "counts", fewest_counts_per_rev, most_counts, &d.counts_per_rev,
                    "the arm's counts in a revolution of a motor: fewer than in a turn of the joint"));
  all.push_back(key("drives.rated_current_a", "A", 0, most_a, &d.rated_current_a,
                    "a motor's current at its rated torque, for drives that count in it; 0: not stated"));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string joint = "drives." + names[i] + ".";
    JointDriveChoice& one = d.joints[i];
    all.push_back(key(joint + "node", "", 0, 126, &one.node, "node number on the bus; 0: that of the CAN map"));
    all.push_back(key(joint + "profile", "", 0, 0, &one.profile, "make of this drive; empty: drives.profile"));
    all.push_back(
        key(joint + "polarity", "", 0, 0, &one.polarity, "whether the drive counts with the joint or against it", {"forward", "reversed"}));
    all.push_back(
        key(joint + "holding", "", 0, 0, &one.holding,
            "what holds the joint without power: its gear, by the URDF's holding_torque_nm; a brake, whose times the profile has; "
            "nothing but friction",
            {"gear", "brake", "nothing"}));
    all.push_back(key(joint + "counts_per_rev", "counts", 0, most_counts, &one.counts_per_rev, "0: drives.counts_per_rev"));
    all.push_back(key(joint + "rated_torque_nm", "N m", 0, most_nm, &one.rated_torque_nm,
                      "the motor's rated torque, not the joint's, for drives that do not say it, and to check those that do; within a "
                      "factor of 3 of what the "
                      "arm's description gives; 0: not stated, and a drive that does not say it has the description's"));
    all.push_back(key(joint + "rated_current_a", "A", 0, most_a, &one.rated_current_a, "0: drives.rated_current_a"));
  }
  all.push_back(key("outputs.node", "", 1, 126, &d.output_node, "node number of the output node"));
}

JointDriveChoice drive_of(const Drives& drives, std::size_t joint) {
  JointDriveChoice one = drives.joints[joint];
  if (one.node == 0) one.node = can_map::default_node(joint);
  if (one.profile.empty()) one.profile = drives.profile;
  if (one.counts_per_rev == 0) one.counts_per_rev = drives.counts_per_rev;
  if (one.rated_current_a == 0) one.rated_current_a = drives.rated_current_a;
  return one;
}

void add_mission(Keys& all, mission::MissionConfig& m) {
  all.push_back(key("mission.docking_m", "m", 0, 0.025, &m.docking.shift_m,
                    "how far the panel may be off its nominal place along each of the base's axes: kept clear of until it was looked at. "
                    "At 0.03 the only "
                    "sweep that passes over such a panel is too fast to show the handle"));
  all.push_back(key(
      "mission.docking_rad", "rad", 0, 0.05, &m.docking.turn_rad,
      "how far it may be turned about each of them. At 0.1 no sweep passes over such a panel, and with docking_m at its most not at 0.08"));
  all.push_back(key("mission.camera_syncs", "SYNC", 2, 20, &m.camera_syncs,
                    "SYNCs from one exposure to the next; 10 are 25 Hz. At 1 no report confirms the outputs; beyond 20 the stripes on the "
                    "handle are no longer one"));
  all.push_back(
      key("mission.frames_per_background", "", 2, 50, &m.frames_per_background, "one frame in so many is taken without the laser"));
  all.push_back(key("mission.sweep_speed_rad_s", "rad/s", 0.001, 0.2, &m.sweep_speed_rad_s,
                    "of the slowest moving joint while scanning: slower is denser, down to the joints' stiction"));
  all.push_back(key("mission.verify_band_m", "m", 0.01, 0.5, &m.verify_band_m,
                    "half height of the second look's sweep around the valve, no less than the handle needs"));
  all.push_back(key("mission.move_speed_fraction", "", 0.01, 1, &m.move_speed_fraction, "of the joints' speed limits, in free motion"));
  all.push_back(key("mission.approach_distance_m", "m", 0.04, 0.3, &m.approach_distance_m,
                    "where straight approaches start, along the panel's normal"));
  all.push_back(key("mission.approach_speed_m_s", "m/s", 0.001, 0.5, &m.approach_speed_m_s,
                    "of straight guarded motions, at most: an arm that would press too hard goes more slowly"));
  all.push_back(key("mission.press_speed_m_s", "m/s", 0.001, 0.2, &m.press_speed_m_s, "of a press, at most"));
  all.push_back(
      key("mission.press_overtravel_m", "m", 0, 0.05, &m.press_overtravel_m, "beyond a button's bottom before the press counts as missed"));
  all.push_back(key("mission.press_torque_nm", "N m", 2, 20, &m.press_torque_nm,
                    "rise of a joint's torque that says the button has bottomed; of a stronger arm at least 3/13 of the joint's torque of "
                    "contact is taken. "
                    "The default arm's drives give 26 N m, and at 25 no press is told"));
  all.push_back(key("mission.turn_speed_rad_s", "rad/s", 0.01, 1, &m.turn_speed_rad_s, "of the handle; no faster than the wrist"));
  all.push_back(key("mission.valve_tolerance_rad", "rad", 0.015, 0.045, &m.valve_tolerance_rad,
                    "what the second look accepts without turning again. Its own error is 0.6 degrees as a rule and 1.15 at worst: below "
                    "0.02 rad a handle "
                    "that stands right may be turned again"));
  all.push_back(key("mission.tries", "", 1, 20, &m.tries, "of a step that may be taken again"));
}

}  // namespace lf::config
