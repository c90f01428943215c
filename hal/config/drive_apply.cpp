// From a profile's words to the core's numbers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "hal/config/drive_kind.hpp"
#include "shared/can/can_map.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

namespace {

using canopen::BootAction;
using canopen::BootStep;
using canopen::BootValue;
using canopen::Substitute;

struct NamedObject {
  std::uint16_t index;
  const char* name;
};
constexpr std::array<NamedObject, 43> object_names{{
    {0x1000, "device type"},
    {0x1005, "SYNC's identifier"},
    {0x1006, "SYNC period"},
    {0x1008, "device name"},
    {0x100C, "guard time"},
    {0x100D, "life time factor"},
    {0x1014, "EMCY's identifier"},
    {0x1016, "consumer heartbeat time"},
    {0x1017, "producer heartbeat time"},
    {0x1018, "identity"},
    {0x1400, "RPDO 1"},
    {0x1600, "RPDO 1's mapping"},
    {0x1800, "TPDO 1"},
    {0x1A00, "TPDO 1's mapping"},
    {0x6007, "abort connection option"},
    {0x6040, "controlword"},
    {0x6041, "statusword"},
    {0x605A, "quick stop option"},
    {0x605B, "shutdown option"},
    {0x605C, "disable operation option"},
    {0x605E, "fault reaction option"},
    {0x6060, "mode of operation"},
    {0x6064, "actual position"},
    {0x6065, "following error window"},
    {0x6066, "following error time-out"},
    {0x6072, "maximum torque"},
    {0x6075, "rated current"},
    {0x6076, "rated torque"},
    {0x6077, "actual torque"},
    {0x607A, "target position"},
    {0x607C, "home offset"},
    {0x607D, "software position limits"},
    {0x607F, "maximum profile velocity"},
    {0x6080, "maximum motor speed"},
    {0x6085, "quick stop deceleration"},
    {0x6098, "homing method"},
    {0x6099, "homing speeds"},
    {0x609A, "homing acceleration"},
    {0x60A8, "position unit"},
    {0x60A9, "velocity unit"},
    {0x60B2, "torque offset"},
    {0x60C2, "interpolation period"},
    {0x6091, "gear ratio"},
}};

struct Row {
  std::uint16_t index;
  std::uint8_t sub;
  BootValue value;
  Substitutes by;  // what does its work where the drive lacks it
};
constexpr std::array<Row, 22> rows{{
    {0x6076, 0, BootValue::rated_torque, {Substitute::configured_rating, Substitute::other_object}},
    {0x1016, 1, BootValue::master_heartbeat, {Substitute::node_guarding}},
    {0x60C2, 1, BootValue::interpolation_value, {Substitute::fixed_by_maker}},
    {0x60C2, 2, BootValue::interpolation_exponent, {Substitute::fixed_by_maker}},
    {0x6007, 0, BootValue::abort_option, {Substitute::fixed_by_maker, Substitute::other_object}},
    {0x605A, 0, BootValue::quick_stop_option, {Substitute::fixed_by_maker, Substitute::other_object}},
    {0x6085, 0, BootValue::quick_stop_deceleration, {Substitute::fixed_by_maker, Substitute::other_object}},
    {0x6065, 0, BootValue::following_window, {Substitute::vendor_limit, Substitute::other_object}},
    {0x6066, 0, BootValue::following_timeout, {Substitute::master_times_following, Substitute::other_object}},
    {0x607D, 1, BootValue::min_position, {Substitute::master_limits_position, Substitute::vendor_limit, Substitute::other_object}},
    {0x607D, 2, BootValue::max_position, {Substitute::master_limits_position, Substitute::vendor_limit, Substitute::other_object}},
    {0x6072, 0, BootValue::max_torque, {Substitute::vendor_limit, Substitute::other_object}},
    {0x607F, 0, BootValue::max_speed, {Substitute::master_limits_speed, Substitute::vendor_limit, Substitute::other_object}},
    {0x6080, 0, BootValue::max_motor_speed, {Substitute::master_limits_speed, Substitute::vendor_limit, Substitute::other_object}},
    {0x6098, 0, BootValue::homing_method, {Substitute::fixed_by_maker, Substitute::other_object}},
    {0x6099, 1, BootValue::homing_speed, {Substitute::fixed_by_maker, Substitute::other_object}},
    {0x6099, 2, BootValue::homing_creep_speed, {Substitute::fixed_by_maker, Substitute::other_object}},
    {0x609A, 0, BootValue::homing_acceleration, {Substitute::fixed_by_maker, Substitute::other_object}},
    {0x607C, 0, BootValue::home_offset, {Substitute::other_object}},
    {0x60B2, 0, BootValue::rpdo1_torque_offset, {Substitute::no_feed_forward}},
    {0x1017, 0, BootValue::node_heartbeat, {Substitute::fixed_by_maker}},
    {0x1006, 0, BootValue::sync_period_us, {Substitute::fixed_by_maker}},
}};

const Row* row_of(std::uint16_t index, std::uint8_t sub) {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.index == index && r.sub == sub; });
  return row == rows.end() ? nullptr : &*row;
}

// units / base as whole numbers, both given to a millionth.
canopen::Ratio ratio(double units, double base, const std::string& where) {
  const auto num = static_cast<std::int64_t>(std::llround(units * 1e6));
  const auto den = static_cast<std::int64_t>(std::llround(base * 1e6));
  const std::int64_t common = std::max<std::int64_t>(1, std::gcd(num, den));
  if (num <= 0 || den <= 0 || num / common > canopen::Ratio::largest || den / common > canopen::Ratio::largest) {
    throw InputError(where + ": " + std::to_string(units) + " units in " + std::to_string(base) +
                     " counts is no fraction that the core holds: give both with fewer digits");
  }
  return {static_cast<std::int32_t>(num / common), static_cast<std::int32_t>(den / common)};
}

canopen::Ratio ratio(const UnitScale& unit, const DriveMotor& motor, const std::string& where) {
  return unit.per_count > 0 ? ratio(unit.per_count, 1, where) : ratio(unit.per_rev, motor.counts_per_rev, where);
}

std::uint8_t width_of(const std::string& type) { return type.ends_with("8") ? 1 : type.ends_with("16") ? 2 : 4; }

std::uint32_t number_of(const ProfileObject& object, const DriveMotor& motor, const std::string& where) {
  const auto need = [&](double value, const char* key) {
    if (!(value > 0))
      throw InputError(where + ": object " + object_text(object.index, object.sub) + " needs '" + key + "', which is not stated");
    return value;
  };
  if (object.value == "rated_current_ma")
    return static_cast<std::uint32_t>(std::llround(1e3 * need(motor.rated_current_a, "rated_current_a")));
  if (object.value == "rated_torque_mnm")
    return static_cast<std::uint32_t>(std::llround(1e3 * need(motor.rated_torque_nm, "rated_torque_nm")));
  if (object.value == "rated_torque_unm")
    return static_cast<std::uint32_t>(std::llround(1e6 * need(motor.rated_torque_nm, "rated_torque_nm")));
  if (object.value == "counts_per_rev") return static_cast<std::uint32_t>(std::llround(motor.counts_per_rev));
  return static_cast<std::uint32_t>(std::stoll(object.value, nullptr, 0));
}

void add(canopen::DriveProfile& profile, const BootStep& step, const std::string& where) {
  if (!profile.objects.push_back(step)) throw InputError(where + ": the profile has more objects than the core holds");
}

void add_option(canopen::DriveProfile& profile, std::uint16_t index, std::int32_t value, const std::string& where) {
  if (value >= 0) add(profile, {index, 0, 2, BootAction::write, BootValue::literal, static_cast<std::uint32_t>(value)}, where);
}

// 6077 has 16 bits: a motor of more current than the drive reports would push unseen. One of far less is as good as not seen.
void check_readable(const DriveKind& kind, double rated_a, const std::string& where) {
  constexpr double most_units = 32767 / 1.1;  // a motor is capped at its rating at most: what an overload takes is seen, and a tenth above
  constexpr double least_units = 100;         // 1 % of the rating, as exact as readings are taken to be
  const double units = kind.units_per_a * rated_a;
  if (units >= least_units && units <= most_units) return;
  char text[160];
  std::snprintf(text, sizeof text, ": 'rated_current_a' is %.4g A, and %s reads torque for motors of %.3g to %.4g A", rated_a,
                kind.title.c_str(), least_units / kind.units_per_a, most_units / kind.units_per_a);
  throw InputError(where + text);
}

void set_torque(const DriveKind& kind, const DriveMotor& motor, const std::string& where, canopen::DriveProfile& profile) {
  profile.rated_torque_unit_unm = kind.rating == "object" ? static_cast<std::uint32_t>(std::llround(kind.rating_unit_unm)) : 0;
  if (motor.rated_torque_nm > 0) profile.rated_torque_unm = static_cast<std::uint32_t>(std::llround(1e6 * motor.rated_torque_nm));
  if (kind.rating == "configured" && profile.rated_torque_unm == 0)
    throw InputError(where + ": " + kind.title + " does not say its rated torque: state 'rated_torque_nm'");
  if (kind.torque_basis != "raw") return;
  if (!(motor.rated_current_a > 0))
    throw InputError(where + ": " + kind.title + " reports current in its own units: state 'rated_current_a'");
  check_readable(kind, motor.rated_current_a, where);
  profile.scale.torque = ratio(kind.units_per_a * motor.rated_current_a, 1000, where);
}

void set_absences(const DriveKind& kind, const std::string& where, canopen::DriveProfile& profile) {
  for (const ProfileAbsence& absence : kind.absences) {
    const Row* row = row_of(absence.index, absence.sub);
    if (row == nullptr) throw InputError(where + ": nothing takes the place of " + object_text(absence.index, absence.sub));
    canopen::Absence core{row->value, absence.by, 0, 0};
    if (absence.by == Substitute::other_object) {
      core.index = static_cast<std::uint16_t>(std::stoul(absence.use.substr(0, 4), nullptr, 16));
      core.sub = absence.use.size() > 5 ? static_cast<std::uint8_t>(std::stoul(absence.use.substr(5), nullptr, 16)) : std::uint8_t{0};
    }
    profile.guarded = profile.guarded || absence.by == Substitute::node_guarding;
    profile.torque_offset = profile.torque_offset && absence.by != Substitute::no_feed_forward;
    profile.master_times_following = profile.master_times_following || absence.by == Substitute::master_times_following;
    if (!profile.absences.push_back(core)) throw InputError(where + ": the profile lacks more objects than the core holds");
  }
}

// The boot maps the controlword, the target and the torque offset into RPDO 1, and what can_map says into TPDO 1.
void check_mapping(const DriveKind& kind, const canopen::DriveProfile& profile, const std::string& where) {
  const std::size_t rpdo = can_map::drive_rpdo1::entries.size() - (profile.torque_offset ? 0 : 1),
                    tpdo = can_map::drive_tpdo1::entries.size();
  const auto refuse = [&](const char* pdo, std::size_t objects) {
    throw InputError(where + ": " + kind.title + " maps " + std::to_string(static_cast<int>(kind.most_mapped)) +
                     " objects into a PDO at most ('mapping.most_objects'), and " + pdo + " takes " + std::to_string(objects));
  };
  if (static_cast<double>(tpdo) > kind.most_mapped) refuse("TPDO 1", tpdo);
  if (static_cast<double>(rpdo) > kind.most_mapped) refuse("RPDO 1", rpdo);
}

void check_homing(const DriveKind& kind, const canopen::DriveSetup& setup, const std::string& where) {
  if (setup.homing_method == 0 || kind.any_homing) return;
  const auto& methods = kind.homing_methods;
  if (std::find(methods.begin(), methods.end(), setup.homing_method) != methods.end()) return;
  std::string list;
  for (const double method : methods) list += (list.empty() ? " " : ", ") + std::to_string(static_cast<int>(method));
  throw InputError(where + ": " + kind.title + " has no homing method " + std::to_string(setup.homing_method) + " (6098)" +
                   (methods.empty() ? ": it has none, give it an absolute encoder" : "; it has" + list));
}

}  // namespace

std::string object_text(std::uint16_t index, std::uint8_t sub) {
  char text[16];
  std::snprintf(text, sizeof text, "%04X:%02X", index, sub);
  return text;
}

const char* object_name(std::uint16_t index) {
  const auto found = std::find_if(object_names.begin(), object_names.end(), [index](const NamedObject& o) { return o.index == index; });
  return found == object_names.end() ? "" : found->name;
}

Substitutes substitutes_of(std::uint16_t index, std::uint8_t sub) {
  const Row* row = row_of(index, sub);
  return row != nullptr ? row->by : Substitutes{};
}

void apply(const DriveKind& kind, const DriveMotor& motor, const std::string& where, canopen::DriveSetup& setup) {
  canopen::DriveProfile profile;
  profile.scale.position = ratio(kind.position, motor, where);
  profile.scale.speed = ratio(kind.speed, motor, where);
  profile.scale.acceleration = ratio(kind.acceleration, motor, where);
  profile.scale.sign = motor.reversed ? std::int8_t{-1} : std::int8_t{1};
  set_torque(kind, motor, where, profile);
  set_absences(kind, where, profile);
  check_mapping(kind, profile, where);
  profile.waits_to_follow = kind.waits_to_follow;
  profile.brake_opens = Duration::from_s(1e-3 * kind.brake_opens_ms);
  profile.brake_closes = Duration::from_s(1e-3 * kind.brake_closes_ms);
  for (const std::string& code : kind.position_lost) {
    if (!profile.position_lost.push_back(static_cast<std::uint16_t>(std::stoul(code, nullptr, 16))))
      throw InputError(where + ": the profile has more codes of a lost position than the core holds");
  }
  profile.quick_stop_fallback = static_cast<std::int16_t>(kind.quick_stop_fallback);
  profile.abort_fallback = static_cast<std::int16_t>(kind.abort_fallback);
  for (const ProfileObject& object : kind.objects) {
    add(profile,
        {object.index, object.sub, width_of(object.type), object.writes ? BootAction::write : BootAction::check, BootValue::literal,
         number_of(object, motor, where), 0xFFFFFFFFu, object.optional},
        where);
  }
  add_option(profile, 0x605B, kind.shutdown, where);
  add_option(profile, 0x605C, kind.disable, where);
  add_option(profile, 0x605E, kind.fault, where);
  setup.profile = profile;
  setup.identity = kind.identity;
  setup.quick_stop_option = static_cast<std::int16_t>(kind.quick_stop);
  setup.abort_option = static_cast<std::int16_t>(kind.abort);
  setup.following_timeout_ms = static_cast<std::uint16_t>(kind.following_timeout_ms);
  check_homing(kind, setup, where);
}

}  // namespace lf::config
