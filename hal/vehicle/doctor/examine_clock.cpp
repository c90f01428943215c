// The clocks: CLOCK_MONOTONIC, by which everything runs, and the wall clock, which the log carries.
#include "hal/vehicle/doctor/examination.hpp"

namespace lf::hal::doctor {

namespace {

// A tick of 4 ms is woken for within tens of us: timers that step by more have no high resolution (CONFIG_HIGH_RES_TIMERS).
constexpr std::int64_t coarsest_ns = 10'000;

}  // namespace

void examine_clock(const VehicleConfig&, const Machine& machine, Examinations& found) {
  const std::int64_t step_ns = machine.calls->monotonic_step_ns();
  const std::string source = first_line(machine.sys / "devices/system/clocksource/clocksource0/current_clocksource");
  const std::string text = "steps of " + std::to_string(step_ns) + " ns" + (source.empty() ? "" : ", from " + source);
  const bool fine = step_ns > 0 && step_ns <= coarsest_ns && source != "jiffies";
  found.push_back({"clock", "", fine ? Grade::good : Grade::bad, fine ? text : text + ": too coarse for a control period of 4 ms",
                   fine ? "" : "a kernel with CONFIG_HIGH_RES_TIMERS, without `highres=off` and `nohz=off`"});
  const bool set = machine.calls->wall_clock_synchronised();
  found.push_back({"wall clock", "", set ? Grade::good : Grade::note,
                   set ? "synchronised" : "nothing keeps it right: the log's times do not agree with other machines'",
                   set ? "" : "`timedatectl set-ntp true`, or chrony with the ship's time server"});
}

}  // namespace lf::hal::doctor
