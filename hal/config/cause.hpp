// Why something failed and what to do about it, in words. The one table of causes: `lanternfish run` with its report and result.json, and lanternfishd with
// its status and log, name causes from here.
//
// A look at the panel that failed is told apart by what the core saw (mission::Sight), which it publishes on the vehicle as in the simulator.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/mission/job.hpp"
#include "firmware/mission/sight.hpp"
#include "firmware/mission/step_failure.hpp"
#include "firmware/safety/faults.hpp"

namespace lf::config {

struct Cause {
  std::string name;    // "the water is too turbid"; empty: the fault's own name says it all
  std::string remedy;  // one or two sentences; may be empty
};

// Of a fault with its `code` as in an Event or an Outcome. `sight`: the newest look's.
Cause cause_of(safety::Fault fault, std::int32_t code, const mission::Sight& sight);

// Of a look's failure, by what it saw. Empty for a failure that is no matter of seeing, and where the numbers name no cause.
Cause sight_cause(StepFailure failure, const mission::Sight& sight);

// How far behind the place where they were seen the faces of the buttons were felt, in the mean; nothing when none was felt.
std::optional<double> faces_off_m(const mission::TaskResults& results);

// What the marker's side may be off by, of a fit whose size and side are above 0.
double allowed_side_error(const mission::CalibrationFit& fit);

// Of a look and presses that leave over more than the calibration's own uncertainty explains: all that does not fit, and what to do. Empty where all fits, or nothing
// is known.
Cause calibration_cause(const mission::CalibrationFit& fit, const mission::TaskResults& results);

// What a look saw, for people: "179 images of the laser, peaks in 3 % of their columns; still: ...". Empty when there was no look.
std::string sight_text(const mission::Sight& sight);

}  // namespace lf::config
