// Collects all faults of one tick and decides on one reaction: the most severe that the table names for any of them.
//
// The reaction depends on the circumstances of the tick, not on the order in which the faults were reported.
#pragma once

#include <cstdint>

#include "firmware/safety/faults.hpp"
#include "shared/messages/capacity.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf::safety {

struct FaultReport {
  Fault fault = Fault::count;
  std::int32_t code = 0;      // joint or node index, COB-ID of a second master, or what the fault's source says of it
  std::uint16_t emcy = 0;     // the EMCY code with which the node reported it; 0: none yet
  bool out_of_tries = false;  // a retry is of no use any more
  bool touched = false;       // the arm has met what it must not: it stays where it is, since nobody knows which way is free
  bool only_counted = false;  // the mission knows of it and goes on
};

// A tick's worst case: of the watch two for the links, nine for another master, two for each node, six for each joint, the workspace and the output node; of the
// mission's own sources 12. Room for five more: a report that does not fit would be lost.
using FaultReports = StaticVector<FaultReport, 30 + 2 * capacity::nodes + 6 * capacity::joints>;

// What a reaction depends on besides fault and phase.
struct Circumstances {
  Phase phase = Phase::boot;
  bool may_retry = false;  // the step under way has tries left
  bool powered = false;    // the joints follow: without, there is no way back
  bool on_hold = false;    // the operator holds the arm
};

// Another master sends set points and controlwords to a drive: it would take back a quick stop, but cannot take back a lost power with one controlword.
// Such a report takes the power at once, in every phase.
bool drives_are_told_otherwise(const FaultReport& report);

// The table's reaction, made possible in these circumstances: out of tries a retry is a retreat; before the joints follow
// there is no way back, and the drives that already have power are stopped; an arm that the operator holds does not set out by itself, unless the
// operator aborts.
Reaction reaction_in(const FaultReport& report, const Circumstances& circumstances);

class FaultArbiter {
 public:
  // False, and counted, when there is no room.
  bool report(const FaultReport& report);
  bool report(Fault fault, std::int32_t code = 0) { return report(FaultReport{fault, code}); }
  const FaultReports& reports() const { return reports_; }
  void clear() { reports_.clear(); }

  struct Verdict {
    Reaction reaction = Reaction::count_only;
    FaultReport cause;  // the first report that calls for this reaction; its fault is `count` when nothing was reported
  };
  Verdict decide(const Circumstances& circumstances) const;

  std::uint32_t overflows() const { return overflows_; }  // reports that found no room

 private:
  FaultReports reports_;
  std::uint32_t overflows_ = 0;
};

}  // namespace lf::safety
