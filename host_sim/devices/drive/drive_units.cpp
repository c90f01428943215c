#include "host_sim/devices/drive/drive_units.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/devices/drive/drive_habits.hpp"

namespace lf::devices {
namespace {

constexpr double ipos_units_per_a = 65520 / (2 * 40.0);

std::int64_t within(const Object& object, double value) {
  const bool is_signed = object.type == Type::i8 || object.type == Type::i16 || object.type == Type::i32;
  const double bits = 8.0 * static_cast<double>(size_of(object.type));
  const double high = std::pow(2, is_signed ? bits - 1 : bits) - 1;
  return std::llround(std::clamp(value, is_signed ? -high - 1 : 0.0, high));
}

// Hard stops that other makers reach by other numbers: by a current threshold, or at the limit switch that stands there.
std::int64_t native_method(std::int64_t method, bool reversed) {
  constexpr std::int64_t to_low = -1, to_high = -2;
  const auto direction = [reversed](bool low) { return low != reversed ? to_low : to_high; };
  switch (method) {
    case -4:
    case 17: return direction(true);
    case -3:
    case 18: return direction(false);
    case -1: return direction(true);
    case -2: return direction(false);
    default: return method;
  }
}

}  // namespace

DriveUnits::DriveUnits(const DriveConfig& config, ObjectDictionary& native, ObjectDictionary& drive) {
  static constexpr DriveHabit own{"", "", 0, 0};
  const DriveHabit& habit = config.habit != nullptr ? *config.habit : own;
  const SpeedUnit speed = config.switches.speeds_in_rpm ? SpeedUnit::rpm : habit.speed;
  position_ = position_units_per_count(habit, config.counts_per_rev);
  speed_ = speed_units_per_count(speed, config.counts_per_rev);
  acceleration_ = speed_ * habit.acceleration_factor;
  if (speed == SpeedUnit::fixed_16_16_per_ms) acceleration_ *= 1e-3;
  if (habit.torque == TorqueUnit::raw_current) torque_ = 1e-3 * config.rated_current_a * ipos_units_per_a;
  torque_ /= config.switches.torque_basis;
  sign_ = config.reversed ? -1 : 1;

  using K = Kind;
  const auto input = [&](std::uint16_t index, K kind, std::uint8_t sub = 0, std::uint16_t other = 0) {
    link(native, drive, index, sub, kind, true, other);
  };
  const auto output = [&](std::uint16_t index, K kind) { link(native, drive, index, 0, kind, false); };
  for (const std::uint16_t index : {0x6007, 0x6040, 0x605A, 0x605B, 0x605C, 0x605D, 0x605E, 0x6060, 0x6066, 0x6068, 0x6072}) {
    input(index, K::plain);
  }
  input(0x2080, K::plain);
  for (const std::uint16_t index : {0x2081, 0x2082}) output(index, K::plain);
  input(0x60C2, K::plain, 1);
  input(0x60C2, K::plain, 2);
  input(0x6065, K::length);
  input(0x6067, K::length);
  input(0x607A, K::position);
  input(0x607C, K::position);
  input(0x607C, K::position, 0, 0x30B0);
  input(0x607D, config.reversed ? K::upper_limit : K::lower_limit, 1);
  input(0x607D, config.reversed ? K::lower_limit : K::upper_limit, 2);
  for (const std::uint16_t index : {0x607F, 0x6081}) input(index, K::speed);
  for (const std::uint8_t sub : {1, 2}) input(0x6099, K::speed, sub);
  for (const std::uint16_t index : {0x6083, 0x6084, 0x6085, 0x609A}) input(index, K::acceleration);
  input(0x6098, K::homing_method);
  input(0x60FF, K::rate);
  for (const std::uint16_t index : {0x603F, 0x6041, 0x6061}) output(index, K::plain);
  for (const std::uint16_t index : {0x6062, 0x6063, 0x6064, 0x60F4}) output(index, K::position);
  for (const std::uint16_t index : {0x606B, 0x606C}) output(index, K::rate);
  for (const std::uint16_t index : {0x6074, 0x6077, 0x6078}) output(index, K::torque);
}

void DriveUnits::link(ObjectDictionary& native, ObjectDictionary& drive, std::uint16_t index, std::uint8_t sub, Kind kind, bool input,
                      std::uint16_t other) {
  std::uint8_t native_sub = sub;
  if (kind == Kind::lower_limit) native_sub = 1;
  if (kind == Kind::upper_limit) native_sub = 2;
  Object* from = native.find(index, native_sub);
  Object* to = drive.find(other != 0 ? other : index, sub);
  if (from == nullptr || to == nullptr || to->absent) return;
  (input ? inputs_ : outputs_).push_back({from, to, kind, from->value});
}

double DriveUnits::factor(Kind kind) const {
  switch (kind) {
    case Kind::position:
    case Kind::lower_limit:
    case Kind::upper_limit: return sign_ * position_;
    case Kind::length: return position_;
    case Kind::speed: return speed_;
    case Kind::rate: return sign_ * speed_;
    case Kind::acceleration: return acceleration_;
    case Kind::torque: return sign_ * torque_;
    case Kind::plain:
    case Kind::homing_method: break;
  }
  return 1;
}

void DriveUnits::take(Link& link) const {
  const std::int64_t value = link.drive->value;
  switch (link.kind) {
    case Kind::plain: link.native->value = value; return;
    case Kind::homing_method: link.native->value = native_method(value, sign_ < 0); return;
    case Kind::speed:
    case Kind::acceleration:
      // 0 is no speed and no ramp: such a drive takes what its motor can.
      link.native->value = value == 0 ? link.own : std::max<std::int64_t>(1, std::llround(static_cast<double>(value) / factor(link.kind)));
      return;
    default: link.native->value = std::llround(static_cast<double>(value) / factor(link.kind));
  }
}

void DriveUnits::give(Link& link) const {
  const double value = static_cast<double>(link.native->value) * factor(link.kind);
  link.drive->value = within(*link.drive, value);
}

void DriveUnits::take_inputs() {
  for (Link& link : inputs_) take(link);
}

void DriveUnits::give_outputs() {
  for (Link& link : outputs_) give(link);
}

}  // namespace lf::devices
