#include "firmware/safety/faults.hpp"

namespace lf::safety {

namespace {

struct Row {
  Fault fault;
  const char* name;
  std::array<Reaction, phase_count> reactions;  // boot, free, scan, contact, gripping, stow, ended
};

constexpr Reaction count_ = Reaction::count_only;
constexpr Reaction retry = Reaction::retry;
constexpr Reaction back = Reaction::retreat;
constexpr Reaction hold = Reaction::hold;
constexpr Reaction quick = Reaction::quick_stop;
constexpr Reaction off = Reaction::power_off;

// A drive, a node or a bus that cannot be trusted is stopped, in every phase: with one joint dead the others cannot retreat. The output node is among
// them, because it reads the emergency-stop chain: a chain that cannot be read is an open chain. After the end a stop is obeyed, too: what already has
// no power stays so.
// While gripping:
// - the jaw stays closed: its screw holds the handle without power;
// - an overload lets go, since holding on is what overloads;
// - a lost camera or vision does not matter to a turn that is already under way.
constexpr std::array<Row, fault_count> table{{
    //                                                     boot    free   scan   contact gripping stow   ended
    {Fault::limits_refused, "limits refused", {off, off, off, off, off, off, count_}},
    {Fault::boot_failed, "boot failed", {off, off, off, off, off, off, count_}},
    {Fault::estop, "emergency stop", {off, quick, quick, quick, quick, quick, quick}},
    {Fault::node_lost, "node lost", {off, quick, quick, quick, quick, quick, quick}},
    {Fault::node_rebooted, "node rebooted", {off, quick, quick, quick, quick, quick, quick}},
    {Fault::drive_fault, "drive fault", {retry, quick, quick, quick, quick, quick, quick}},
    {Fault::following_error, "following error", {count_, quick, quick, quick, quick, quick, quick}},
    {Fault::stale_position, "stale position", {count_, quick, quick, quick, quick, quick, quick}},
    {Fault::joint_limit, "joint limit", {off, quick, quick, quick, hold, quick, count_}},
    {Fault::overspeed, "overspeed", {off, quick, quick, quick, hold, quick, count_}},
    {Fault::overload, "overload", {count_, hold, hold, back, back, hold, count_}},
    {Fault::workspace, "tool outside its workspace", {count_, quick, quick, back, hold, count_, count_}},
    {Fault::unexpected_contact, "unexpected contact", {count_, hold, hold, back, count_, hold, count_}},
    {Fault::io_lost, "output node lost", {off, quick, quick, quick, quick, quick, quick}},
    {Fault::interlock, "laser interlock open", {count_, count_, retry, count_, count_, count_, count_}},
    {Fault::image_lost, "image lost", {count_, count_, count_, count_, count_, count_, count_}},
    {Fault::camera_lost, "camera silent", {count_, count_, retry, count_, count_, count_, count_}},
    {Fault::vision_late, "panel vision late", {count_, retry, retry, count_, count_, count_, count_}},
    {Fault::vision_poor, "panel vision unsure", {count_, retry, retry, count_, count_, count_, count_}},
    {Fault::grip_lost, "grip lost", {count_, count_, count_, retry, retry, count_, count_}},
    {Fault::step_timeout, "step timed out", {off, back, retry, back, back, quick, count_}},
    {Fault::step_failed, "step failed", {off, retry, retry, retry, retry, quick, count_}},
    {Fault::aborted, "aborted", {off, back, back, back, back, count_, count_}},
    {Fault::port_error, "platform call failed", {count_, count_, count_, count_, count_, count_, count_}},
    {Fault::bus_off, "CAN bus off", {off, quick, quick, quick, quick, quick, quick}},
    {Fault::second_master, "another master on the bus", {off, quick, quick, quick, quick, quick, quick}},
    {Fault::clock_lost, "clock lost", {off, quick, quick, quick, quick, quick, quick}},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < fault_count; ++i) {
    if (table[i].fault != static_cast<Fault>(i)) return false;
  }
  return true;
}
static_assert(in_order(), "one row a fault, in the order of the enumeration");

}  // namespace

Reaction reaction(Fault fault, Phase phase) {
  const auto row = static_cast<std::size_t>(fault);
  const auto column = static_cast<std::size_t>(phase);
  if (row >= fault_count || column >= phase_count) return Reaction::quick_stop;  // not a fault we know: stop
  return table[row].reactions[column];
}

const char* name(Fault fault) {
  const auto row = static_cast<std::size_t>(fault);
  return row < fault_count ? table[row].name : "unknown fault";
}

const char* name(Phase phase) {
  constexpr std::array<const char*, phase_count> names{"boot", "free", "scan", "contact", "gripping", "stow", "ended"};
  const auto i = static_cast<std::size_t>(phase);
  return i < phase_count ? names[i] : "unknown";
}

const char* name(Reaction reaction) {
  constexpr std::array<const char*, 6> names{"count", "retry", "retreat", "hold", "quick stop", "power off"};
  const auto i = static_cast<std::size_t>(reaction);
  return i < names.size() ? names[i] : "unknown";
}

}  // namespace lf::safety
