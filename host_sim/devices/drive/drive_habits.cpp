#include "host_sim/devices/drive/drive_habits.hpp"

#include <array>

namespace lf::devices {
namespace {

using P = PositionUnit;
using S = SpeedUnit;

constexpr std::uint32_t only(unsigned value) { return 1u << value; }

constexpr DriveHabit epos4(const char* name, const char* dictionary) {
  DriveHabit h{name, dictionary, 0xFB, 0x65520000};
  h.speed = S::rpm;
  h.rating = Rating::computed_unm;  // from 3001
  h.sync_loss = SyncLoss::faults;
  h.sync_losses_bridged = 1;  // not in its papers: one lost frame is no reason to fault
  h.misses_targets = true;
  h.quick_stop_values = only(6);
  h.abort_values = only(2) | only(3);
  h.brake_opens_ms = 10;
  h.limits_fault = true;
  h.lost_master_faults = true;
  return h;
}

constexpr DriveHabit elmo(const char* name, const char* dictionary) {
  DriveHabit h{name, dictionary, 0x9A, 0x00030923};
  h.sync_loss = SyncLoss::faults;
  h.sync_losses_bridged_by = 0x2F75;
  h.quick_stop_values = 0xEF;  // 0..3, 5..7
  return h;
}

constexpr DriveHabit ipos(const char* name) {
  DriveHabit h{name, "Technosoft iPOS (iPOS.D v1.04 rev 5)", 0x1A3, 0};
  h.speed = S::fixed_16_16_per_ms;
  h.torque = TorqueUnit::raw_current;
  return h;
}

constexpr DriveHabit c5e() {
  DriveHabit h{"c5e", "Nanotec C5-E-2-09", 0x26C, 0x11};
  h.position = P::tenth_of_degree;
  h.speed = S::rpm;
  h.brake_opens_ms = 1000;
  return h;
}

constexpr DriveHabit ingenia() {
  DriveHabit h{"ingenia", "Ingenia/Novanta EVE-NET-C 1.8.1", 0, 0};
  h.speed = S::millirev_per_s;
  h.brake_opens_ms = 100;
  return h;
}

constexpr DriveHabit lmdrive() {
  DriveHabit h{"lmdrive", "Schneider Lexium MDrive NEMA23", 0x0800005A, 102000};
  h.position = P::microstep;
  h.speed = S::microsteps_per_s;
  return h;
}

constexpr DriveHabit eyou() {
  DriveHabit h{"eyou", "Eyou joint servo V1.4", 0x668, 0x00220811};
  h.position = P::count_65536;
  h.speed = S::counts_65536_per_s;
  return h;
}

constexpr DriveHabit copley() {
  DriveHabit h{"copley", "Copley Accelnet family 2009", 0xAB, 0};
  h.speed = S::tenths_of_count_per_s;
  h.acceleration_factor = 0.01;  // of the speed's: 0.1 a count/s^2 beside 10 a count/s
  h.rating = Rating::stated_mnm;
  return h;
}

constexpr DriveHabit other(const char* name, const char* dictionary, bool cyclic_position) {
  DriveHabit h{name, dictionary, 0, 0};
  h.cyclic_position = cyclic_position;
  return h;
}

constexpr std::array habits{
    epos4("epos4", "maxon EPOS4 Compact 50/5 CAN"),
    epos4("epos4_configured", "maxon EPOS4 Module 50/15 (as configured)"),
    elmo("elmo_gold", "Elmo Gold (V005)"),
    elmo("elmo_gold_configured", "Elmo Gold (as configured)"),
    ipos("ipos"),
    c5e(),
    ingenia(),
    lmdrive(),
    eyou(),
    copley(),
    other("elmo_simpliq", "Elmo SimplIQ", false),
    other("epos2", "maxon EPOS2 50/5", false),
    other("isd860", "Technosoft IDM/ISCM (ISD860)", false),
    other("faulhaber", "Faulhaber MCDC 300x CO", false),
    other("prbt", "Pilz PRBT (Schunk ESPI)", false),
    other("dryve", "igus dryve D1", true),
    other("tmcm6214", "Trinamic TMCM-6214 (axis 0)", true),
    other("tmcm1270", "Trinamic TMCM-1270", true),
    other("roboteq", "Roboteq (v80 beta)", false),
};

}  // namespace

std::span<const DriveHabit> drive_habits() { return habits; }

const DriveHabit* find_habit(const std::string& name) {
  for (const DriveHabit& habit : habits) {
    if (name == habit.name) return &habit;
  }
  return nullptr;
}

double position_units_per_count(const DriveHabit& habit, double counts_per_rev) {
  switch (habit.position) {
    case P::encoder_count: return 1;
    case P::tenth_of_degree: return 3600 / counts_per_rev;
    case P::microstep: return 51200 / counts_per_rev;
    case P::count_65536: return 65536 / counts_per_rev;
  }
  return 1;
}

double speed_units_per_count(SpeedUnit unit, double counts_per_rev) {
  switch (unit) {
    case S::counts_per_s: return 1;
    case S::tenths_of_count_per_s: return 10;
    case S::rpm: return 60 / counts_per_rev;
    case S::millirev_per_s: return 1000 / counts_per_rev;
    case S::fixed_16_16_per_ms: return 65536 * 1e-3;
    case S::microsteps_per_s: return 51200 / counts_per_rev;
    case S::counts_65536_per_s: return 65536 / counts_per_rev;
  }
  return 1;
}

}  // namespace lf::devices
