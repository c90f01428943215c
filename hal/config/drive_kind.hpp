// The profile of one make of drive, as its YAML file in shared/drives says it: identity, a scale for each quantity, what it lacks and what takes the place,
// what is checked and written before it has power, its option codes, brake, and the texts of its errors.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "firmware/canopen/setup.hpp"

namespace lf::config {

// How many of the drive's units are one of the motor encoder's counts (a second, a second squared), or one revolution of the motor (a second ...).
// Exactly one of them is stated; 0 is not stated.
struct UnitScale {
  double per_count = 0;
  double per_rev = 0;
};

// An object that the boot checks or writes, beside those of every drive.
struct ProfileObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::string type;   // u8 u16 u32 i8 i16 i32
  std::string value;  // a number, or rated_current_ma, rated_torque_mnm, rated_torque_unm, counts_per_rev
  bool optional = false;
  bool writes = false;
  std::string why;
};

struct ProfileAbsence {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  canopen::Substitute by = canopen::Substitute::none;
  std::string use;  // other_object: which
  std::string why;
};

struct DriveKind {
  std::string name;  // of its file, without the ending
  std::string file;
  std::vector<std::string> like;  // files of the profiles that this one is like, the nearest first
  std::string title;
  canopen::Identity identity;
  UnitScale position, speed, acceleration;

  std::string torque_basis;       // torque, current: thousandths of the rated torque or current; raw: the drive's own units of current
  std::string rating = "object";  // object: 6076; configured: the machine's file
  double rating_unit_unm = 1000;  // of one of 6076, in micro newton metres
  double units_per_a = 0;         // raw only

  std::int32_t quick_stop = 2, quick_stop_fallback = 0;
  std::int32_t abort = 3, abort_fallback = 0;
  std::int32_t shutdown = -1, disable = -1, fault = -1;  // 605B, 605C, 605E; -1: left alone
  std::int32_t following_timeout_ms = 100;
  bool waits_to_follow = false;
  double brake_opens_ms = 0, brake_closes_ms = 0;

  std::string sync_loss = "unknown";
  double most_mapped = 64;  // objects in one PDO; 64, CiA 301's own limit, where the file says nothing
  bool any_homing = true;   // no list of methods
  std::vector<double> homing_methods;
  std::vector<std::string> unconfirmed;
  std::vector<ProfileObject> objects;
  std::vector<ProfileAbsence> absences;
  std::map<std::uint16_t, std::string> errors;  // of EMCY and 603F
  std::vector<std::string> position_lost;       // EMCY codes, 4 hex digits each

  const ProfileAbsence* absence(std::uint16_t index) const;
  // What a code of EMCY or 603F means on this drive, else in the standard.
  std::string error_text(std::uint16_t code) const;
};

// Of a value in a profile, decimal or 0x...: false where it is none, as a figure of the motor, or fits no 32 bits.
bool whole_number(const std::string& text, std::int64_t& value);

// Reads a file and the one it is `like`. Throws InputError with all that is wrong, a line each, "file:line: ...".
DriveKind read_drive_kind(const std::filesystem::path& file);

// A shipped profile by its name, or a file. Throws InputError, with the nearest known name.
DriveKind find_drive_kind(const std::string& name_or_file, const std::filesystem::path& folder);
std::vector<std::string> shipped_drive_kinds();

// The drive's motor, as the machine's file has it.
struct DriveMotor {
  double counts_per_rev = 0;   // of the arm's counts in a revolution of the motor
  double rated_torque_nm = 0;  // 0: not stated
  double rated_current_a = 0;
  bool reversed = false;  // the drive counts against the arm
};

// Fills profile, identity and option codes of `setup`. Throws InputError, beginning with `where`, for what the two do not allow: a scale that is no fraction of
// whole numbers, a rating that is asked for and not stated, a homing method that the drive does not have.
void apply(const DriveKind& kind, const DriveMotor& motor, const std::string& where, canopen::DriveSetup& setup);

// What may take an object's place, Substitute::none where there is none; all none for an object that the boot does not write or cannot do without.
using Substitutes = std::array<canopen::Substitute, 3>;
Substitutes substitutes_of(std::uint16_t index, std::uint8_t sub);

// "6099:02" and its name in the standard; the name is empty for objects that the boot does not know.
std::string object_text(std::uint16_t index, std::uint8_t sub);
const char* object_name(std::uint16_t index);

}  // namespace lf::config
