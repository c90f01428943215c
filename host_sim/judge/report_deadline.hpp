// What kind of cause a fault is, and when it has to have stopped the arm: by its kind, and by the frame that told the core of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "host_sim/judge/verdict.hpp"

namespace lf::judge {

inline constexpr double ms = 1e-3;  // of a moment
inline constexpr double sync_s = 0.004;

// By when a stop has to be on the bus.
struct Deadline {
  const Cause* cause = nullptr;
  double at_s = 0;       // from when on time counts
  double allowed_s = 0;  // until the stop is on the bus

  double end_s() const { return at_s + allowed_s; }
};

// Of "slew" or "tpdo slew" among the nodes; their number for none of them.
std::size_t node_index(const std::string& node, const JointNames& names);
// A drive that hears nothing of the master any more.
bool cut_off(const Cause& cause);
// A drive that hears NMT commands, and no process data.
bool loses_process_data(const Cause& cause);
// A node whose process data the master does not hear: its times count from the last that arrived, like a silent node's.
bool is_unheard(const Cause& cause);
// Its drive's reading, or its motion, is not what the core takes it for.
bool misleads(const Cause& cause);
// Of these, what leads the joint away.
bool misleads_its_joint(const Cause& cause);
bool is_a_drives_fault(const Cause& cause);
// A master that nobody hears: the drives stop by themselves when its heartbeat is missing.
bool cuts_off_the_master(const Cause& cause);
// A master that hears nothing.
bool deafens_the_master(const Cause& cause);
// When a frame told the core of a cause; nothing for one that no frame tells, or that none has told.
std::optional<double> told_by_a_frame_s(const Seen& seen, const Cause& cause, double begins_s);
bool told_by_a_frame(const Cause& cause);
// `begins_s`: of the cause, since watching began.
Deadline report_of(const Seen& seen, const Cause& cause, double begins_s, const JointNames& names, const SafetyFigures& figures);

}  // namespace lf::judge
