// What one make of drive does in its own way: its units, what it lacks and what takes the place, and what it needs written before it has power.
//
// The core counts positions in the arm's counts, speeds in counts/s, accelerations in counts/s^2 and torques in thousandths of the rated torque. A drive has
// units of its own for each of them, and a ratio for each says how many of them one of the core's is. Nothing is converted by assumption.
#pragma once

#include <cstdint>

#include "firmware/canopen/boot_step.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"

namespace lf::canopen {

// A positive fraction of whole numbers, so that the same command gives the same bits everywhere. Both are 1 to 1e9: products with 32-bit values fit 64 bits.
struct Ratio {
  static constexpr std::int32_t largest = 1'000'000'000;
  std::int32_t num = 1;
  std::int32_t den = 1;

  constexpr bool valid() const { return num > 0 && den > 0 && num <= largest && den <= largest; }
  // value * num / den and value * den / num, to the nearest, halves away from zero.
  constexpr std::int64_t times(std::int64_t value) const { return divided(value * num, den); }
  constexpr std::int64_t over(std::int64_t value) const { return divided(value * den, num); }

 private:
  static constexpr std::int64_t divided(std::int64_t value, std::int64_t by) {
    return value < 0 ? -((-value + by / 2) / by) : (value + by / 2) / by;
  }
};

// How many of the drive's units one of the core's is.
struct DriveScale {
  Ratio position;        // 6064, 607A, 6065, 607C, 607D
  Ratio speed;           // 607F, 6099
  Ratio acceleration;    // 6085, 609A
  Ratio torque;          // 6077, 60B2; where the drive has them in thousandths of its rating, 1
  std::int8_t sign = 1;  // -1: the drive counts against the arm. 607E is left alone: the sign stands in one place

  // A position in the drive's units and direction, and back. What 32 bits do not hold is held at their ends: no drive counts further.
  constexpr std::int32_t drive_position(std::int64_t counts) const { return held(position.times(sign * counts)); }
  constexpr std::int64_t counts(std::int32_t drive_position) const { return sign * position.over(drive_position); }

  constexpr bool valid() const {
    return position.valid() && speed.valid() && acceleration.valid() && torque.valid() && (sign == 1 || sign == -1);
  }

 private:
  static constexpr std::int32_t held(std::int64_t value) {
    if (value > INT32_MAX) return INT32_MAX;
    return value < INT32_MIN ? INT32_MIN : static_cast<std::int32_t>(value);
  }
};

// What takes the place of an object that a drive does not have. docs/canopen.md explains each.
enum class Substitute : std::uint8_t {
  none,                    // nothing: the boot ends and names the object
  other_object,            // the drive has another object for it, which is written instead
  vendor_limit,            // a limit of the maker's, set with the maker's tool when the drive is commissioned
  master_limits_speed,     // the axis limits the steps of its targets
  master_limits_position,  // the axis refuses targets outside of its limits
  master_times_following,  // the axis times the following error
  no_feed_forward,         // RPDO1 has no torque offset
  configured_rating,       // the machine's file states the rated torque
  node_guarding,           // the drive misses the master's guard requests in place of its heartbeat
  fixed_by_maker,          // the drive does this in one way, which its profile describes
};
const char* name(Substitute substitute);

struct Absence {
  BootValue what = BootValue::nothing;
  Substitute by = Substitute::none;
  // other_object: where the number goes.
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
};

struct DriveProfile {
  DriveScale scale;

  // The rated torque in micro newton metres: object 6076 times `rated_torque_unit_unm`, or, where that is 0, `rated_torque_unm`.
  // Where both stand, the object must agree with the stated number within a tenth, which finds a unit that is wrong by 1000.
  std::uint32_t rated_torque_unit_unm = 1000;
  std::uint32_t rated_torque_unm = 0;

  bool guarded = false;                 // node guarding instead of heartbeats: a drive without 1016
  bool torque_offset = true;            // 60B2 stands in RPDO1
  bool waits_to_follow = false;         // the drive says in bit 12 when it follows; the target stands still until then
  bool master_times_following = false;  // the drive has no 6066, or takes only 0
  Duration brake_opens;                 // from Operation enabled on; the target stands still until then
  Duration brake_closes;                // before the drive leaves Operation enabled: a transition may take so much longer

  // What to try when 605A or 6007 refuse their number (06090030 to 06090032); 0: nothing.
  std::int16_t quick_stop_fallback = 0;
  std::int16_t abort_fallback = 0;

  // Checked and written after the identity and before everything else.
  static constexpr std::size_t max_objects = 16;  // the longest shipped profile has 11
  StaticVector<BootStep, max_objects> objects;
  static constexpr std::size_t max_absences = 12;  // the longest shipped profile has 9
  StaticVector<Absence, max_absences> absences;

  // EMCY codes with which the drive says that its encoder's position is lost: the joint's zero is no longer where it was found.
  static constexpr std::size_t max_position_lost = 8;  // the longest shipped profile has 2
  StaticVector<std::uint16_t, max_position_lost> position_lost;

  bool loses_position(std::uint16_t emcy) const {
    for (const std::uint16_t code : position_lost) {
      if (code == emcy) return true;
    }
    return false;
  }

  const Absence* absence(BootValue what) const {
    for (const Absence& one : absences) {
      if (one.what == what) return &one;
    }
    return nullptr;
  }
};

}  // namespace lf::canopen
