// Whether a run to which a fault happened was safe, from what was seen in the world and on the bus; and whether what the core says of it is true.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/judge/fault_rules.hpp"
#include "host_sim/judge/safety_observer.hpp"

namespace lf::judge {

// The figures of safety. Sources: the "safe means", which are this project's requirements.
struct SafetyFigures {
  double stop_ms = 12;           // on the bus, from the report: three SYNC periods
  double unread_ms = 26;         // on the bus, after the last good process data: six SYNC periods and the bus's own time
  double standing_rad_s = 0.02;  // the drives' compliance lets a stopped arm swing by less
  double settling_s = 0.15;      // over what speed and deceleration ask for
  double off_after_standing_s = 0.100;
  double off_after_stop_s = 1.2;
  double force_n = 150;       // over 50 ms
  double halt_s = 0.6;        // of an arm in motion on its own path: half a second, and the tick and SYNC after
  double self_stop_s = 0.40;  // the drives' consumer time of the master's heartbeat, 300 ms, and one heartbeat
  // A drive whose process data are lost is told by NMT: five SYNC periods after the stop, which it does not heed; in an orderly shut-down after the time in
  // which brakes may close.
  double unheeded_stop_s = 0.020, unheeded_lowering_s = 0.7;
  double unheeded_off_s = 0.120;  // until it is restarted, from when its power had to be off
  // A drive that hears no process data and is not heard either looks like one that brakes in good order, and that is told to go down once the arm stands: it is
  // restarted when the arm's ramp and a brake would be over.
  double unreached_off_s = 0.44;  // over the longest ramp
  double quivers_rad = 0.001;     // by which a joint whose motor stands may quiver under a load: half a millimetre at the tool
  // What an arm has to feel, at each joint: 33 N at the tool, and a third of it for what current and friction leave in doubt. Not the core's own limits: one that
  // feels less than this has missed it.
  double felt_nm = 17, felt_by_roll_nm = 4.3;
  // By which slew, shoulder and elbow may go while their drive, or their encoder, misleads: the core's window of 0.15 rad, the 0.2 s that it gives, and the ramp, at
  // the slew's 0.42 rad/s and half as much again.
  double misled_rad = 0.5;
  double touch_n = 5;             // less is no contact that an arm could feel: 4 N m at a joint 0.8 m away
  double touched_within_s = 0.5;  // before it was told
  double unwinding_s = 0.5;       // in which a joint whose motor stands may still unwind its gear
};

// `self_stop_s` of a drive that has a deadline for its process data: 100 ms, a SYNC period, and the tick in which it is found.
inline constexpr double by_deadline_s = 0.106;

// What the core says, and what is true, at the end.
struct Ending {
  bool ended = false;
  bool success = false;      // by the core's account
  std::string step;          // in which it stands
  std::string reason;        // of a failure
  std::string contradicted;  // how the truth contradicts a success; empty: it does not
  bool expected_to_end = true;
  bool holds = false;            // it says that the arm is held under power
  std::optional<double> told_s;  // when it said why, since watching began; of its account only the time is taken
  std::optional<double> held_s;  // when it began to hold the arm
};

struct Situation {
  static PerJoint<double> ones() {
    PerJoint<double> all;
    all.fill(1);
    return all;
  }

  JointNames names;  // of the machine
  std::vector<Cause> causes;
  std::vector<double> begins_s;  // of each, since watching began
  bool powering_up = false;      // the first fault came in the boot phase, before any drive has power
  bool over = false;             // the mission had ended before
  bool fails_anyway = false;     // it was on its way to a failure of another cause, which is what its reason names
  PerJoint<double> deceleration_rad_s2{};
  PerJoint<double> units_per_count = ones();  // of each drive's position, for an encoder's count
  // By which a joint may be off its motor: half of its gear's play, and the wind-up under what a motor at its rated torque holds, and the gear alone, too.
  PerJoint<double> gear_gives_rad{};
  // By which its motor may slip as its power goes: half of its gear's play, and the wind-up under what the drive held and the gear alone does not.
  PerJoint<double> slips_rad{};
};

struct Verdict {
  std::vector<std::string> wrong;    // why it was not safe; empty: it was
  std::vector<std::string> unclear;  // safe, but the end does not say what happened
  bool false_success = false;
  bool went_on = false;  // the mission succeeded, and truly
  // A joint that seized where it should stay was told as a contact, and nothing was touched. No sensor tells the two apart, and what has seized cannot move.
  bool stood_anyway = false;
  bool gripped = false;   // the jaw held the handle when there was no power any more
  bool gave_way = false;  // a joint of such an arm moved in its gear, later than a joint may: the handle slipped in the pads
  // Measured; nothing where it does not apply.
  std::optional<double> stop_ms;      // from the report until no drive runs as it was told
  std::optional<double> standing_s;   // from there until every joint stands
  std::optional<double> power_off_s;  // from standing until no drive has power
  std::optional<double> stop_to_off_s;
  double force_n = 0;
};

// Whether a joint that moved worked against a push of more than `felt_nm` over what it took when watching began, for the time over which a force is judged.
// Torques of the drives are all by which an arm can feel: a push on a screw that stands, or along its way, is not felt.
bool felt_a_push(const Seen& seen, const SafetyFigures& figures = {});

Verdict judge(const Seen& seen, const Situation& situation, const Ending& ending, const SafetyFigures& figures = {});

}  // namespace lf::judge
