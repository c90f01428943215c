#include "firmware/safety/fault_arbiter.hpp"

#include "firmware/canopen/foreign_frames.hpp"

namespace lf::safety {

bool drives_are_told_otherwise(const FaultReport& report) {
  return report.fault == Fault::second_master && canopen::is_rpdo(static_cast<std::uint32_t>(report.code));
}

Reaction reaction_in(const FaultReport& report, const Circumstances& circumstances) {
  if (report.only_counted) return Reaction::count_only;
  if (drives_are_told_otherwise(report)) return Reaction::power_off;
  Reaction wanted = reaction(report.fault, circumstances.phase);
  if (wanted == Reaction::retry && (report.out_of_tries || !circumstances.may_retry)) wanted = Reaction::retreat;
  if (wanted == Reaction::retreat && !circumstances.powered) {
    wanted = circumstances.phase == Phase::boot ? Reaction::power_off : Reaction::quick_stop;
  }
  const bool sets_out = wanted == Reaction::retry || wanted == Reaction::retreat;
  if (sets_out && report.touched) wanted = Reaction::hold;
  if (circumstances.on_hold && sets_out && report.fault != Fault::aborted) wanted = Reaction::hold;
  return wanted;
}

bool FaultArbiter::report(const FaultReport& report) {
  if (reports_.push_back(report)) return true;
  ++overflows_;
  return false;
}

FaultArbiter::Verdict FaultArbiter::decide(const Circumstances& circumstances) const {
  Verdict verdict;
  for (const FaultReport& report : reports_) {
    const Reaction wanted = reaction_in(report, circumstances);
    if (verdict.cause.fault != Fault::count && wanted <= verdict.reaction) continue;
    verdict = {wanted, report};
  }
  return verdict;
}

}  // namespace lf::safety
