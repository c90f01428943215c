#include "hal/sim/sim_faults.hpp"

namespace lf::hal {

FaultSchedule::FaultSchedule(const std::vector<SimFault>& faults) {
  for (const SimFault& fault : faults) add(fault);
}

void FaultSchedule::add(const SimFault& fault) {
  Entry entry;
  entry.fault = fault;
  const auto step = static_cast<std::size_t>(fault.at_step);
  if (fault.at_step == mission::Step::count) {
    entry.begin = Time::from_s(fault.at_s);
    entry.timed = true;
  } else if (seen_[step]) {
    entry.begin = entered_[step] + Duration::from_s(fault.after_s);
    entry.timed = true;
  }
  entries_.push_back(entry);
}

void FaultSchedule::in_step(mission::Step step, Time now) {
  const auto index = static_cast<std::size_t>(step);
  if (index >= seen_.size() || seen_[index]) return;
  seen_[index] = true;
  entered_[index] = now;
  for (Entry& entry : entries_) {
    if (entry.timed || entry.fault.at_step != step) continue;
    entry.begin = now + Duration::from_s(entry.fault.after_s);
    entry.timed = true;
  }
}

std::optional<Time> FaultSchedule::entered(mission::Step step) const {
  const auto index = static_cast<std::size_t>(step);
  return index < seen_.size() && seen_[index] ? std::optional(entered_[index]) : std::nullopt;
}

const SimFault* FaultSchedule::next(Time now) {
  for (Entry& entry : entries_) {
    if (entry.begun && !entry.over && entry.fault.duration_s > 0 && now >= entry.end) {
      entry.over = true;
      --on_[static_cast<std::size_t>(entry.fault.kind)];
    }
    if (!entry.timed || entry.begun || now < entry.begin) continue;
    entry.begun = true;
    entry.end = now + Duration::from_s(entry.fault.duration_s);
    ++on_[static_cast<std::size_t>(entry.fault.kind)];
    return &entry.fault;
  }
  return nullptr;
}

}  // namespace lf::hal
