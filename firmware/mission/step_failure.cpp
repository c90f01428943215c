#include "firmware/mission/step_failure.hpp"

namespace lf {

namespace {

struct Words {
  const char* name;
  const char* remedy;
};

Words words(StepFailure failure) {
  switch (failure) {
    case StepFailure::none: return {"none", ""};
    case StepFailure::unreachable:
      return {"out of reach",
              "Dock nearer to the nominal place, or start nearer: mission.approach_distance_m. `reach` shows what the arm reaches."};
    case StepFailure::no_motion: return {"no way there", "Something stands in every way that was tried: check the panel's layout."};
    case StepFailure::early_contact: return {"touched something before the aim", "Check the panel's layout and what hangs before it."};
    case StepFailure::no_contact: return {"nothing to touch where the aim should be", "Check the panel's layout."};
    case StepFailure::not_gripped:
      return {"the jaw holds nothing",
              "Check panel.handle_thickness_m, the jaw's torque, and that each joint stands where its encoder says."};
    case StepFailure::wrong_angle: return {"the handle is not where it was turned to", "Check valve.stop_min_deg and valve.stop_max_deg."};
    case StepFailure::no_panel:
      return {"no panel seen",
              "The laser's line was not found on a plane: the water is too turbid, the laser is off, or the exposure is too short, or so "
              "long that all is white."};
    case StepFailure::no_marker:
      return {"no usable marker seen",
              "It is hidden, out of view, or too dim: look at the still image; check panel.marker_id and the lamps."};
    case StepFailure::no_handle:
      return {
          "no handle seen",
          "Nothing of its height and length stands before the valve: check panel.handle_length_m and panel.handle_height_m, and in turbid "
          "water whether the laser reaches it."};
    case StepFailure::panel_moved: return {"the panel has moved", "The docking slipped: dock again."};
    case StepFailure::not_homed: return {"homing failed", "Commission the joint again."};
    case StepFailure::too_few_points:
      return {"too few points of the panel",
              "The laser's line is too weak or the sweep too fast: check mission.sweep_speed_rad_s and the water."};
    case StepFailure::jaw_stuck: return {"the jaw does not open", "Look at what it holds; free it by hand without power."};
    case StepFailure::jaw_not_closed:
      return {"the jaw does not close", "Look at what is between the fingers; free it by hand without power."};
    case StepFailure::touched_on_the_way_back:
      return {"touched something on the way back",
              "Press the emergency stop, then look at what the arm touches, or what jams one of its joints, before it is moved again."};
    case StepFailure::stalled: return {"the turn stalled", "The valve takes more torque than the wrist has, or something blocks it."};
    case StepFailure::marker_wrong:
      return {"the marker has another size than surveyed", "Check panel.marker_size_m and the camera's calibration."};
    case StepFailure::marker_disagrees:
      return {"the marker's own pose and the scanned plane disagree",
              "Check the calibration of camera and laser, and that the marker lies flat."};
    case StepFailure::plane_unsure:
      return {"too many of the laser's points lie off the panel", "The water is turbid, or something drifts before the panel: scan again."};
    case StepFailure::line_misshapen:
      return {"the laser's line is misshapen",
              "It has a second line or a tail beside it: clean the laser's window and the camera's, check the laser's focus, and that no "
              "reflection or other laser shines beside it."};
    case StepFailure::handle_unsure:
      return {"too few points on the handle for its angle", "Sweep slower: check mission.sweep_speed_rad_s; clean the handle."};
    case StepFailure::pointer_unsure:
      return {"the handle's pointer mark was not recognised",
              "Clean the mark; check panel.pointer and panel.pointer_length_m, and the lamps."};
    case StepFailure::half_turn_open:
      return {"the handle may stand at either of two angles half a turn apart",
              "It has no pointer mark: turn it by hand to within what its stops make unique, or paint one end and set panel.pointer."};
    case StepFailure::beyond_stops:
      return {"the handle is seen beyond its stops",
              "Check valve.stop_min_deg, valve.stop_max_deg and which end carries the pointer mark."};
    case StepFailure::slipped:
      return {"the handle slipped in the jaw", "Clean the pads and the bar; the valve may take more torque than the grip holds."};
    case StepFailure::vision_failed: return {"panel vision failed", "Look at the log: it ran out of memory or met a bad picture."};
    case StepFailure::panel_in_the_way:
      return {"the panel is in the way",
              "Check the panel's layout, mission.docking_m and mission.docking_rad; else dock nearer to the nominal place."};
    case StepFailure::vehicle_in_the_way:
      return {"the vehicle is in the way", "Check vehicle.boxes_m and vehicle.capsules_m; else dock nearer to the nominal place."};
    case StepFailure::button_stuck:
      return {"the button is stuck",
              "It was touched and did not go in by half its stroke: free it, or take away what stands before it; check "
              "panel.button_stroke_m, mission.press_torque_nm, and that no joint's torque is far above the usual while the arm touches "
              "nothing."};
    case StepFailure::button_missing:
      return {"no button there",
              "Nothing was touched down to its bottom: look whether it broke off; check panel.buttons_m and panel.button_height_m. If it "
              "is there, a joint's torque reading stands still."};
    case StepFailure::button_yields:
      return {
          "the button gives way without bottoming",
          "Check panel.button_stroke_m, mission.press_overtravel_m and mission.press_torque_nm. A panel that is farther off than it was "
          "seen feels the same: check the calibration of camera and laser, and the joints' zeros."};
    case StepFailure::arm_in_its_own_way: return {"the arm is in its own way", "Dock nearer to the nominal place, or jog it apart."};
  }
  return {"unknown", ""};
}

}  // namespace

const char* name(StepFailure failure) { return words(failure).name; }
const char* remedy(StepFailure failure) { return words(failure).remedy; }

}  // namespace lf
