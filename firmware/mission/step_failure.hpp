// The reasons a step of the mission gives when it fails: a number for the record, and for people what is wrong and what to do about it.
#pragma once

#include <cstdint>

namespace lf {

// In Event::code and Outcome::code of the faults step_failed and vision_poor. Numbers are never given to another reason.
enum class StepFailure : std::int32_t {
  none = 0,
  unreachable = 1,
  no_motion = 2,
  early_contact = 3,
  no_contact = 4,
  not_gripped = 5,
  wrong_angle = 6,
  no_panel = 7,
  no_marker = 8,
  no_handle = 9,
  panel_moved = 10,
  not_homed = 11,
  too_few_points = 12,
  stalled = 13,
  jaw_stuck = 14,
  touched_on_the_way_back = 15,
  marker_wrong = 16,        // its corners are no square of the surveyed size
  marker_disagrees = 17,    // its own pose and the scanned plane differ
  plane_unsure = 18,        // too many of the laser's points lie off the plane
  handle_unsure = 19,       // too few points for its angle
  pointer_unsure = 20,      // the mark at the bar's end was not told from the other end
  half_turn_open = 21,      // without a mark: two angles half a turn apart both lie within the stops
  beyond_stops = 22,        // the handle is seen where its stops do not let it be
  slipped = 23,             // the handle did not follow the turn of the jaw that held it
  vision_failed = 24,       // panel vision gave no answer of use although it saw plane and marker
  panel_in_the_way = 25,    // the arm would come too near to it, jaw and what is not known of its place included
  vehicle_in_the_way = 26,  // hull, camera, lamps
  arm_in_its_own_way = 27,
  button_stuck = 28,    // touched where it should be, and it does not go in
  button_missing = 29,  // nothing there, or only what lies behind it
  button_yields = 30,   // it goes in without bottoming
  jaw_not_closed = 31,  // a press needs closed fingers with nothing between them
  line_misshapen = 32,  // the laser's line is no bell across: where its middle is cannot be told well enough
};

// What a joint may have made that is not where its encoder says: told by the arm's torques, or by what the jaw held.
constexpr bool may_be_misled(StepFailure failure) {
  using enum StepFailure;
  return failure == early_contact || failure == touched_on_the_way_back || failure == stalled || failure == button_stuck ||
         failure == button_missing || failure == button_yields || failure == not_gripped || failure == slipped || failure == wrong_angle;
}

// What is wrong, in a few words; and what a user can do about it, one sentence, empty where the words say it all.
const char* name(StepFailure failure);
const char* remedy(StepFailure failure);

}  // namespace lf
