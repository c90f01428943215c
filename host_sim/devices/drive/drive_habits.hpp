// What makes of drive do that their dictionaries do not say: units, accepted option codes, what a lost SYNC does. For drives made of shared/drives/objects.csv.
//
// Written from the makers' documents as physical units, and not from the profiles in shared/drives: a scale that is wrong there must show here.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lf::devices {

enum class PositionUnit : std::uint8_t {
  encoder_count,
  tenth_of_degree,
  microstep,
  count_65536
};  // 51200 microsteps, 65536 counts a revolution
enum class SpeedUnit : std::uint8_t {
  counts_per_s,
  tenths_of_count_per_s,
  rpm,
  millirev_per_s,
  fixed_16_16_per_ms,
  microsteps_per_s,
  counts_65536_per_s
};
enum class TorqueUnit : std::uint8_t { permille, raw_current };  // raw: 65520 are twice 40 A
enum class Rating : std::uint8_t { computed_unm, stated_mnm, as_listed };
enum class SyncLoss : std::uint8_t { holds, faults };

struct DriveHabit {
  const char* name;               // of the profile
  const char* dictionary;         // in objects.csv
  std::uint32_t vendor, product;  // 1018, where the dictionary is silent
  PositionUnit position = PositionUnit::encoder_count;
  SpeedUnit speed = SpeedUnit::counts_per_s;  // and per second squared
  double acceleration_factor = 1;             // Copley: tens of counts/s^2 beside tenths of counts/s
  TorqueUnit torque = TorqueUnit::permille;
  Rating rating = Rating::as_listed;
  SyncLoss sync_loss = SyncLoss::holds;
  unsigned sync_losses_bridged = 0;          // cycles that it goes on without a SYNC
  std::uint16_t sync_losses_bridged_by = 0;  // the object that says so instead, as it stands
  bool misses_targets = false;               // without an RPDO, too
  std::uint32_t quick_stop_values = 0xFF;    // bit n: 605A takes n
  std::uint32_t abort_values = 0x0F;         // the same of 6007
  int brake_opens_ms = 0;
  bool cyclic_position = true;  // it has mode 8
  bool limits_fault = false;    // a target outside of 607D is a fault 8A82, not a clamped target
  // What it loses its master by (8130, 8250, 81FD) is a fault with 6007's reaction: it ends without power, whatever 605A says.
  bool lost_master_faults = false;
};

// What a maker's documents leave open. Each is one way by default, and tests try the other.
struct DriveSwitches {
  bool refuses_quick_stop_6 = false;  // Elmo Gold
  bool inhibits_synchronous = false;  // inhibit times hold back synchronous TPDOs, too
  bool faults_without_sync = false;   // iPOS, Ingenia, LMDrive
  bool speeds_in_rpm = false;         // LMDrive
  bool ignores_lost_master = false;   // Eyou, which has no 6007
  bool ignores_deadline = false;      // Ingenia, LMDrive: 1400:05 is there, and does nothing
  double torque_basis = 1;            // Ingenia, LMDrive, Eyou: 6077 counts thousandths of so many ratings
  bool holds_without_master = false;  // EPOS4: no fault, and power after its quick stop
  bool ramps_from_demand = false;     // of every make: its stop makes up for the following error
};

std::span<const DriveHabit> drive_habits();
// nullptr for the simulator's own drive and for an unknown name.
const DriveHabit* find_habit(const std::string& name);

double position_units_per_count(const DriveHabit& habit, double counts_per_rev);
double speed_units_per_count(SpeedUnit unit, double counts_per_rev);

}  // namespace lf::devices
