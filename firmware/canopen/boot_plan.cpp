#include "firmware/canopen/boot_plan.hpp"

#include <array>

#include "firmware/canopen/cia402.hpp"
#include "firmware/canopen/cob_id.hpp"

namespace lf::canopen {

namespace {

using A = BootAction;
using V = BootValue;

constexpr std::uint32_t all = 0xFFFFFFFFu;
constexpr std::uint32_t type_mask = 0x0000FFFFu;        // 1000: the profile's number; the upper half is the device's kinds
constexpr std::uint32_t id_and_valid = 0x800007FFu;     // of a COB-ID; bit 30 says whether remote frames are answered and some nodes fix it
constexpr std::uint32_t id_and_producer = 0x400007FFu;  // 1005: bit 30 would make the node a second SYNC producer
constexpr std::uint32_t every_sync = 1;                 // transmission type

constexpr BootStep literal(std::uint16_t index, std::uint8_t sub, std::uint8_t width, std::uint32_t value, std::uint32_t mask = all) {
  return {index, sub, width, A::write, V::literal, value, mask, false};
}
constexpr BootStep setting(std::uint16_t index, std::uint8_t sub, std::uint8_t width, V value, std::uint32_t mask = all) {
  return {index, sub, width, A::write, value, 0, mask, false};
}
constexpr BootStep optional(BootStep step) {
  step.optional = true;
  return step;
}
constexpr BootStep best_effort(BootStep step) {
  step.optional = step.best_effort = true;
  return step;
}
constexpr BootStep check(std::uint16_t index, std::uint8_t sub, V value, std::uint32_t number, std::uint32_t mask) {
  return {index, sub, 4, A::check, value, number, mask, false};
}
constexpr BootStep record(std::uint16_t index, std::uint8_t sub, std::uint8_t width) {
  return {index, sub, width, A::record, V::nothing, 0, all, false};
}
constexpr BootStep invalidate(std::uint16_t index) { return {index, 1, 4, A::invalidate_pdo, V::nothing, 0, id_and_valid, false}; }

constexpr std::uint16_t rpdo(int n) { return static_cast<std::uint16_t>(0x1400 + n - 1); }
constexpr std::uint16_t tpdo(int n) { return static_cast<std::uint16_t>(0x1800 + n - 1); }
constexpr std::uint16_t rpdo_map = 0x1600;
constexpr std::uint16_t tpdo_map = 0x1A00;
// The rows below write as many entries as the map has.
static_assert(can_map::drive_rpdo1::entries.size() == 3 && can_map::drive_tpdo1::entries.size() == 3);
static_assert(can_map::io_rpdo1::entries.size() == 3 && can_map::io_tpdo1::entries.size() == 4);

// CiA 402 drives. A profile's own rows stand behind the identity: the factor group is read before any number is written in the drive's units.
constexpr std::size_t identity_rows = 7;
constexpr std::array drive_plan{
    // Who is there.
    check(0x1000, 0, V::literal, 0x0192, type_mask),
    optional(record(0x1018, 1, 4)),
    optional(record(0x1018, 2, 4)),
    check(0x1018, 1, V::vendor, 0, all),
    check(0x1018, 2, V::product, 0, all),
    optional(record(0x1008, 0, 0)),
    BootStep{0x6076, 0, 4, A::record, V::rated_torque, 0, all, false},
    // Who hears whom. 1016 is 0 on a new drive: a dead master would go unnoticed. A guarded drive has no heartbeat: CiA 301 allows one of the two.
    optional(check(0x1005, 0, V::literal, cob_id::sync, id_and_producer)),
    optional(check(0x1014, 0, V::emcy_cob_id, 0, id_and_valid)),
    setting(0x1016, 1, 4, V::master_heartbeat),
    setting(0x1017, 0, 2, V::node_heartbeat),
    setting(0x100C, 0, 2, V::guard_time),
    setting(0x100D, 0, 1, V::life_factor),
    optional(setting(0x1006, 0, 4, V::sync_period_us)),
    setting(0x60C2, 2, 1, V::interpolation_exponent),
    setting(0x60C2, 1, 1, V::interpolation_value),
    // What it does when things go wrong.
    setting(0x6007, 0, 2, V::abort_option),
    setting(0x605A, 0, 2, V::quick_stop_option),
    setting(0x6085, 0, 4, V::quick_stop_deceleration),
    setting(0x6065, 0, 4, V::following_window),
    setting(0x6066, 0, 2, V::following_timeout),
    // Limits.
    setting(0x607D, 1, 4, V::min_position),
    setting(0x607D, 2, 4, V::max_position),
    setting(0x6072, 0, 2, V::max_torque),
    setting(0x607F, 0, 4, V::max_speed),
    optional(setting(0x6080, 0, 4, V::max_motor_speed)),
    // Homing.
    setting(0x6098, 0, 1, V::homing_method),
    setting(0x6099, 1, 4, V::homing_speed),
    setting(0x6099, 2, 4, V::homing_creep_speed),
    setting(0x609A, 0, 4, V::homing_acceleration),
    setting(0x607C, 0, 4, V::home_offset),
    // RPDO1: controlword, target position, torque offset.
    invalidate(rpdo(1)),
    literal(rpdo_map, 0, 1, 0),
    literal(rpdo_map, 1, 4, can_map::drive_rpdo1::entries[0]),
    literal(rpdo_map, 2, 4, can_map::drive_rpdo1::entries[1]),
    setting(rpdo_map, 3, 4, V::rpdo1_torque_offset),
    setting(rpdo_map, 0, 1, V::rpdo1_entries),
    literal(rpdo(1), 2, 1, every_sync),
    best_effort(setting(rpdo(1), 5, 2, V::process_data_deadline)),
    setting(rpdo(1), 1, 4, V::rpdo1_cob_id, id_and_valid),
    // TPDO1: statusword, actual position, actual torque. Drives come with inhibit times of 1 to 100 ms, which would hold back answers.
    invalidate(tpdo(1)),
    optional(literal(tpdo(1), 3, 2, 0)),
    literal(tpdo_map, 0, 1, 0),
    literal(tpdo_map, 1, 4, can_map::drive_tpdo1::entries[0]),
    literal(tpdo_map, 2, 4, can_map::drive_tpdo1::entries[1]),
    literal(tpdo_map, 3, 4, can_map::drive_tpdo1::entries[2]),
    literal(tpdo_map, 0, 1, 3),
    literal(tpdo(1), 2, 1, every_sync),
    setting(tpdo(1), 1, 4, V::tpdo1_cob_id, id_and_valid),
    // The others would only load the bus.
    optional(invalidate(rpdo(2))),
    optional(invalidate(rpdo(3))),
    optional(invalidate(rpdo(4))),
    optional(invalidate(tpdo(2))),
    optional(invalidate(tpdo(3))),
    optional(invalidate(tpdo(4))),
    BootStep{0x6060, 0, 1, A::set_mode, V::literal, static_cast<std::uint32_t>(OperationMode::cyclic_position), 0xFFu, false},
};

// CiA 401 output node.
constexpr std::array io_plan{
    check(0x1000, 0, V::literal, 0x0191, type_mask),
    optional(record(0x1018, 1, 4)),
    optional(record(0x1018, 2, 4)),
    check(0x1018, 1, V::vendor, 0, all),
    check(0x1018, 2, V::product, 0, all),
    optional(record(0x1008, 0, 0)),
    optional(check(0x1005, 0, V::literal, cob_id::sync, id_and_producer)),
    optional(check(0x1014, 0, V::emcy_cob_id, 0, id_and_valid)),
    setting(0x1016, 1, 4, V::master_heartbeat),
    setting(0x1017, 0, 2, V::node_heartbeat),
    optional(setting(0x1006, 0, 4, V::sync_period_us)),
    // On a communication error the node stops (1029:01 = 2), and stopped, every output (6206) takes its error value (6207), off:
    // CiA 401 applies error values on a failure and in the stopped state, not in pre-operational.
    literal(0x1029, 1, 1, 2),
    literal(0x6206, 1, 1, 0xFF),
    literal(0x6207, 1, 1, 0x00),
    // RPDO1: outputs, trigger counter, exposure.
    invalidate(rpdo(1)),
    literal(rpdo_map, 0, 1, 0),
    literal(rpdo_map, 1, 4, can_map::io_rpdo1::entries[0]),
    literal(rpdo_map, 2, 4, can_map::io_rpdo1::entries[1]),
    literal(rpdo_map, 3, 4, can_map::io_rpdo1::entries[2]),
    literal(rpdo_map, 0, 1, 3),
    literal(rpdo(1), 2, 1, every_sync),
    best_effort(setting(rpdo(1), 5, 2, V::process_data_deadline)),
    setting(rpdo(1), 1, 4, V::rpdo1_cob_id, id_and_valid),
    // TPDO1: inputs, outputs as they are, last trigger counter, last exposure.
    invalidate(tpdo(1)),
    literal(tpdo_map, 0, 1, 0),
    literal(tpdo_map, 1, 4, can_map::io_tpdo1::entries[0]),
    literal(tpdo_map, 2, 4, can_map::io_tpdo1::entries[1]),
    literal(tpdo_map, 3, 4, can_map::io_tpdo1::entries[2]),
    literal(tpdo_map, 4, 4, can_map::io_tpdo1::entries[3]),
    literal(tpdo_map, 0, 1, 4),
    literal(tpdo(1), 2, 1, every_sync),
    setting(tpdo(1), 1, 4, V::tpdo1_cob_id, id_and_valid),
    optional(invalidate(rpdo(2))),
    optional(invalidate(rpdo(3))),
    optional(invalidate(rpdo(4))),
    optional(invalidate(tpdo(2))),
    optional(invalidate(tpdo(3))),
    optional(invalidate(tpdo(4))),
};

using Number = std::optional<std::uint32_t>;

// Numbers where 0 means: leave the node's own.
constexpr Number unless_zero(std::uint32_t value) { return value == 0 ? Number{} : Number{value}; }

std::uint32_t milliseconds(Duration d) { return static_cast<std::uint32_t>(d.ns() / 1'000'000); }

Number bus_value(V value, const BootContext& context) {
  const bool guarded = context.drive != nullptr && context.drive->profile.guarded;
  const Identity& identity = context.drive != nullptr ? context.drive->identity : context.config->io.identity;
  std::uint8_t period = 0;
  std::int8_t exponent = 0;
  interpolation_period(context.config->sync_period, period, exponent);
  switch (value) {
    case V::vendor: return unless_zero(identity.vendor);
    case V::product: return unless_zero(identity.product);
    case V::emcy_cob_id: return cob_id::emcy + context.node;
    case V::master_heartbeat:
      if (guarded) return std::nullopt;
      return (std::uint32_t{can_map::master_node} << 16) | milliseconds(can_map::master_heartbeat_timeout);
    case V::node_heartbeat: return guarded ? 0 : milliseconds(can_map::node_heartbeat);
    case V::guard_time: return guarded ? Number{milliseconds(can_map::master_heartbeat)} : Number{};
    // Guard time and life factor together are the time after which a silent master is missed, as long as by heartbeat.
    case V::life_factor:
      return guarded ? Number{milliseconds(can_map::master_heartbeat_timeout) / milliseconds(can_map::master_heartbeat)} : Number{};
    case V::process_data_deadline: return milliseconds(can_map::process_data_deadline);
    case V::sync_period_us: return static_cast<std::uint32_t>(context.config->sync_period.ns() / 1000);
    case V::interpolation_value: return period;
    case V::interpolation_exponent: return static_cast<std::uint8_t>(exponent);
    case V::rpdo1_cob_id: return cob_id::rpdo1 + context.node;
    case V::tpdo1_cob_id: return cob_id::pdo_no_remote | (cob_id::tpdo1 + context.node);
    default: return std::nullopt;
  }
}

bool moves_to_home(const DriveSetup& drive) { return drive.homing_speed_counts_s != 0; }

std::uint32_t position(const DriveSetup& drive, std::int64_t counts) {
  return static_cast<std::uint32_t>(drive.profile.scale.drive_position(counts));
}
// Numbers of which drives take no 0.
std::uint32_t at_least_one(std::int64_t value) { return value < 1 ? 1u : static_cast<std::uint32_t>(value); }

// The lower and the upper limit of the drive, which counts the other way round where the sign is negative.
std::uint32_t limit(const DriveSetup& drive, bool upper) {
  const bool arms_upper = upper == (drive.profile.scale.sign > 0);
  const std::int64_t margin = arms_upper ? drive.drive_margin_counts : -std::int64_t{drive.drive_margin_counts};
  return position(drive, (arms_upper ? drive.max_counts : drive.min_counts) + margin + drive.encoder_zero_counts);
}

Number drive_value(V value, const DriveSetup& drive, std::uint32_t rated_torque_unm) {
  const bool homes = drive.homing_method != 0;
  const bool moves = homes && moves_to_home(drive);
  const DriveScale& scale = drive.profile.scale;
  switch (value) {
    case V::rated_torque: return drive.profile.rated_torque_unit_unm != 0 ? Number{0} : Number{};
    case V::rpdo1_torque_offset: return drive.profile.torque_offset ? Number{can_map::drive_rpdo1::entries[2]} : Number{};
    case V::rpdo1_entries: return drive.profile.torque_offset ? 3 : 2;
    case V::abort_option: return static_cast<std::uint16_t>(drive.abort_option);
    case V::quick_stop_option: return static_cast<std::uint16_t>(drive.quick_stop_option);
    case V::quick_stop_deceleration:
      return drive.quick_stop_counts_s2 != 0 ? Number{at_least_one(scale.acceleration.times(drive.quick_stop_counts_s2))} : Number{};
    case V::following_window: return at_least_one(scale.position.times(drive.following_window_counts));
    case V::following_timeout: return drive.following_timeout_ms;
    case V::min_position: return limit(drive, false);
    case V::max_position: return limit(drive, true);
    case V::max_torque: return drive.max_torque_of(rated_torque_unm);
    case V::max_speed: return at_least_one(scale.speed.times(drive.max_speed_counts_s));
    case V::max_motor_speed: return unless_zero(drive.max_motor_speed_rpm);
    case V::homing_method: return homes ? Number{static_cast<std::uint8_t>(drive.homing_method)} : Number{};
    case V::homing_speed: return moves ? Number{at_least_one(scale.speed.times(drive.homing_speed_counts_s))} : Number{};
    case V::homing_creep_speed: return moves ? Number{at_least_one(scale.speed.times((drive.homing_speed_counts_s + 3) / 4))} : Number{};
    case V::homing_acceleration:
      return moves && drive.homing_accel_counts_s2 != 0 ? Number{at_least_one(scale.acceleration.times(drive.homing_accel_counts_s2))}
                                                        : Number{};
    case V::home_offset: return homes ? Number{position(drive, drive.home_offset_counts)} : Number{};
    default: return std::nullopt;
  }
}

std::size_t own_rows(const BootContext& context) { return context.drive != nullptr ? context.drive->profile.objects.size() : 0; }

}  // namespace

std::size_t boot_step_count(const BootContext& context) {
  return context.drive != nullptr ? drive_plan.size() + own_rows(context) : io_plan.size();
}

BootStep boot_step(std::size_t i, const BootContext& context) {
  if (context.drive == nullptr) return io_plan[i];
  const std::size_t own = own_rows(context);
  if (i >= identity_rows && i < identity_rows + own) return context.drive->profile.objects[i - identity_rows];
  BootStep step = drive_plan[i < identity_rows ? i : i - own];
  const Absence* absence = context.drive->profile.absence(step.value);
  if (absence != nullptr && absence->by == Substitute::other_object) {
    step.index = absence->index;
    step.sub = absence->sub;
  }
  return step;
}

std::optional<std::uint32_t> boot_value(const BootStep& step, const BootContext& context) {
  if (step.value == BootValue::literal || step.value == BootValue::nothing) return step.literal;
  if (const Number bus = bus_value(step.value, context)) return bus;
  return context.drive != nullptr ? drive_value(step.value, *context.drive, context.rated_torque_unm) : Number{};
}

}  // namespace lf::canopen
