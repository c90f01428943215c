#include "host_sim/devices/drive_objects.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/devices/actuator.hpp"
#include "host_sim/devices/communication_objects.hpp"

namespace lf::devices {
namespace {

constexpr std::int64_t int32_max = 0x7FFFFFFF;
constexpr std::int64_t uint32_max = 0xFFFFFFFF;
constexpr double margin_rad = 0.01;  // 607D's default lies this far outside the stroke: encoder offsets do not clip the last degrees

class Builder {
 public:
  explicit Builder(std::vector<Object>& objects) : objects_(objects) {}

  Object& add(std::uint16_t index, std::uint8_t sub, Type type, Access access, std::int64_t value, Mapping mapping = Mapping::none) {
    objects_.push_back({.index = index, .sub = sub, .type = type, .access = access, .mapping = mapping, .value = value});
    return objects_.back();
  }
  void setting(std::uint16_t index, Type type, std::int64_t value, std::int64_t low, std::int64_t high, Mapping mapping = Mapping::none) {
    setting(index, 0, type, value, low, high, mapping);
  }
  void setting(std::uint16_t index, std::uint8_t sub, Type type, std::int64_t value, std::int64_t low, std::int64_t high,
               Mapping mapping = Mapping::none) {
    Object& object = add(index, sub, type, Access::read_write, value, mapping);
    object.low = low;
    object.high = high;
  }
  void actual(std::uint16_t index, Type type, std::int64_t value = 0) { add(index, 0, type, Access::read_only, value, Mapping::transmit); }
  void count(std::uint16_t index, std::int64_t subs) { add(index, 0, Type::u8, Access::constant, subs); }

 private:
  std::vector<Object>& objects_;
};

// Figures of the motor over the joint's stroke, in counts.
struct MotorFigures {
  std::int64_t low = 0, high = 0;
  std::int64_t velocity = 0, acceleration = 0;  // where the gear gives the most counts per radian
  std::int64_t slow = 0;                        // twice the stiction speed
};

MotorFigures figures(const DriveConfig& config) {
  const Actuator actuator(config.actuator);
  double most = 0;
  for (int i = 0; i <= 64; ++i) {
    most = std::max(most, std::abs(actuator.counts_per_rad(config.lower_rad + (config.upper_rad - config.lower_rad) * i / 64)));
  }
  const double a = actuator.counts(config.lower_rad - margin_rad), b = actuator.counts(config.upper_rad + margin_rad);
  MotorFigures f;
  f.low = std::llround(std::min(a, b));
  f.high = std::llround(std::max(a, b));
  f.velocity = std::max<std::int64_t>(1, std::llround(config.max_velocity_rad_s * most));
  f.acceleration = std::max<std::int64_t>(1, std::llround(config.max_acceleration_rad_s2 * most));
  f.slow = std::max<std::int64_t>(1, std::llround(2 * config.stiction_rad_s * most));
  return f;
}

void add_state(Builder& b) {
  b.setting(0x6007, Type::i16, 1, 0, 3);
  b.actual(0x603F, Type::u16);
  b.add(0x6040, 0, Type::u16, Access::read_write, 0, Mapping::both);
  b.actual(0x6041, Type::u16);
  for (const std::uint16_t index : {0x605A, 0x605B, 0x605C, 0x605D, 0x605E}) {
    const bool quick_stop = index == 0x605A;
    b.setting(index, Type::i16, quick_stop ? 2 : 1, 0, quick_stop ? 6 : (index == 0x605D || index == 0x605E ? 2 : 1));
  }
  b.setting(0x6060, Type::i8, 0, 0, mode_cyclic_position, Mapping::receive);
  b.actual(0x6061, Type::i8);
  b.add(0x6502, 0, Type::u32, Access::constant, 0xA5);  // bits 0 PP, 2 PV, 5 homing, 7 CSP
}

void add_position(Builder& b, const MotorFigures& f) {
  for (const std::uint16_t index : {0x6062, 0x6063, 0x6064}) b.actual(index, Type::i32);
  b.setting(0x6065, Type::u32, std::max<std::int64_t>(50, (f.high - f.low) / 20), 0, uint32_max);  // a twentieth of the stroke
  b.setting(0x6066, Type::u16, 100, 0, 0xFFFF);
  b.setting(0x6067, Type::u32, 3, 0, uint32_max);  // the loop parks within 2
  b.setting(0x6068, Type::u16, 20, 0, 0xFFFF);
  b.setting(0x607A, Type::i32, 0, -int32_max - 1, int32_max, Mapping::receive);
  b.setting(0x607C, Type::i32, 0, -int32_max - 1, int32_max);
  b.count(0x607D, 2);
  b.setting(0x607D, 1, Type::i32, f.low, -int32_max - 1, int32_max);
  b.setting(0x607D, 2, Type::i32, f.high, -int32_max - 1, int32_max);
  b.setting(0x6098, Type::i8, 35, -2, 37);
  b.count(0x6099, 2);
  b.setting(0x6099, 1, Type::u32, f.slow, 1, f.velocity);
  b.setting(0x6099, 2, Type::u32, f.slow, 1, f.velocity);
  b.setting(0x609A, Type::u32, f.acceleration, 1, f.acceleration);
  b.setting(0x60B0, Type::i32, 0, -int32_max - 1, int32_max, Mapping::receive);
  b.setting(0x60B1, Type::i32, 0, -int32_max - 1, int32_max, Mapping::receive);
  b.count(0x60C2, 2);
  b.setting(0x60C2, 1, Type::u8, 1, 1, 255);
  b.setting(0x60C2, 2, Type::i8, -3, -6, 0);
  b.actual(0x60F4, Type::i32);
}

void add_velocity(Builder& b, const MotorFigures& f) {
  b.actual(0x606B, Type::i32);
  b.actual(0x606C, Type::i32);
  b.setting(0x607F, Type::u32, f.velocity, 1, f.velocity);
  b.add(0x6080, 0, Type::u32, Access::constant, f.velocity);
  b.setting(0x6081, Type::u32, f.velocity / 2 + 1, 1, f.velocity, Mapping::receive);
  for (const std::uint16_t index : {0x6083, 0x6084, 0x6085}) b.setting(index, Type::u32, f.acceleration, 1, f.acceleration);
  b.setting(0x6086, Type::i16, 0, 0, 0);  // trapezoidal
  b.setting(0x60C5, Type::u32, f.acceleration, 1, f.acceleration);
  b.setting(0x60FF, Type::i32, 0, -f.velocity, f.velocity, Mapping::receive);
}

void add_torque(Builder& b, const DriveConfig& config) {
  const auto peak = static_cast<std::int64_t>(std::llround(1000 * config.peak_torque_nm / config.rated_torque_nm));
  b.setting(0x6071, Type::i16, 0, -32768, 32767, Mapping::receive);
  b.setting(0x6072, Type::u16, peak, 0, peak, Mapping::receive);
  b.actual(0x6074, Type::i16);
  b.add(0x6075, 0, Type::u32, Access::constant, 1333);  // mA; at the rated torque
  b.add(0x6076, 0, Type::u32, Access::constant, std::llround(1000 * config.rated_torque_nm));
  b.actual(0x6077, Type::i16);
  b.actual(0x6078, Type::i16);
  b.actual(0x6079, Type::u32, 24000);
  b.setting(0x60B2, Type::i16, 0, -32768, 32767, Mapping::receive);
  b.setting(0x2080, Type::u16, 400, 50, peak);
  b.actual(0x2081, Type::i16, std::llround(10 * config.water_celsius));
  b.actual(0x2082, Type::u8);
  b.actual(0x60FD, Type::u32);
  b.count(0x60FE, 1);
  b.setting(0x60FE, 1, Type::u32, 0, 0, uint32_max, Mapping::receive);
}

}  // namespace

std::vector<Object> drive_objects(const DriveConfig& config) {
  // CiA 402-2's pre-defined PDOs.
  PdoDefaults pdos;
  pdos.receive[0] = {0x60400010};
  pdos.receive[1] = {0x60400010, 0x60600008};
  pdos.receive[2] = {0x60400010, 0x607A0020};
  pdos.receive[3] = {0x60400010, 0x60FF0020};
  pdos.transmit[0] = {0x60410010};
  pdos.transmit[1] = {0x60410010, 0x60610008};
  pdos.transmit[2] = {0x60410010, 0x60640020};
  pdos.transmit[3] = {0x60410010, 0x606C0020};
  std::vector<Object> objects = communication_objects(config.node, servo_drive_type, config.name, pdos);
  Builder builder(objects);
  const MotorFigures motor = figures(config);
  add_state(builder);
  add_position(builder, motor);
  add_velocity(builder, motor);
  add_torque(builder, config);
  return objects;
}

DriveObjects::DriveObjects(ObjectDictionary& o)
    : abort_option(o.at(0x6007)),
      error_code(o.at(0x603F)),
      controlword(o.at(0x6040)),
      statusword(o.at(0x6041)),
      quick_stop_option(o.at(0x605A)),
      shutdown_option(o.at(0x605B)),
      disable_option(o.at(0x605C)),
      halt_option(o.at(0x605D)),
      fault_option(o.at(0x605E)),
      mode(o.at(0x6060)),
      mode_display(o.at(0x6061)),
      position_demand(o.at(0x6062)),
      position_actual_internal(o.at(0x6063)),
      position_actual(o.at(0x6064)),
      following_window(o.at(0x6065)),
      following_time_ms(o.at(0x6066)),
      position_window(o.at(0x6067)),
      position_time_ms(o.at(0x6068)),
      velocity_actual(o.at(0x606C)),
      velocity_demand(o.at(0x606B)),
      max_torque(o.at(0x6072)),
      torque_demand(o.at(0x6074)),
      torque_actual(o.at(0x6077)),
      current_actual(o.at(0x6078)),
      target_position(o.at(0x607A)),
      home_offset(o.at(0x607C)),
      limit_low(o.at(0x607D, 1)),
      limit_high(o.at(0x607D, 2)),
      max_velocity(o.at(0x607F)),
      profile_velocity(o.at(0x6081)),
      profile_acceleration(o.at(0x6083)),
      profile_deceleration(o.at(0x6084)),
      quick_stop_deceleration(o.at(0x6085)),
      homing_method(o.at(0x6098)),
      homing_speed(o.at(0x6099, 1)),
      homing_threshold(o.at(0x2080)),
      interpolation_time(o.at(0x60C2, 1)),
      interpolation_exponent(o.at(0x60C2, 2)),
      following_error(o.at(0x60F4)),
      target_velocity(o.at(0x60FF)),
      temperature(o.at(0x2081)),
      overload(o.at(0x2082)) {}

}  // namespace lf::devices
