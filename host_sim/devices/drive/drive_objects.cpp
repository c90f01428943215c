#include "host_sim/devices/drive/drive_objects.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/devices/canopen/communication_objects.hpp"
#include "host_sim/devices/drive/actuator.hpp"

namespace lf::devices {
namespace {

using can_map::Figure;

constexpr double margin_rad =
    0.01;  // the default of 607D lies this far outside of the stroke: encoder offsets do not clip the last degrees

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

std::int64_t figure_of(Figure figure, const DriveConfig& config, const MotorFigures& motor) {
  switch (figure) {
    case Figure::node: return config.node;
    case Figure::stroke_low: return motor.low;
    case Figure::stroke_high: return motor.high;
    case Figure::following_window: return std::max<std::int64_t>(50, (motor.high - motor.low) / 20);
    case Figure::velocity: return motor.velocity;
    case Figure::velocity_back: return -motor.velocity;
    case Figure::cruise: return motor.velocity / 2 + 1;
    case Figure::creep: return motor.slow;
    case Figure::acceleration: return motor.acceleration;
    case Figure::peak_torque: return std::llround(1000 * config.peak_torque_nm / config.rated_torque_nm);
    case Figure::rated_torque: return std::llround(1000 * config.rated_torque_nm);
    case Figure::water: return std::llround(10 * config.water_celsius);
    case Figure::none: break;
  }
  return 0;
}

}  // namespace

std::int64_t figure_of(Figure figure, const DriveConfig& config) { return figure_of(figure, config, figures(config)); }

std::vector<Object> drive_objects(const DriveConfig& config) {
  const MotorFigures motor = figures(config);
  return node_objects(can_map::servo_drive_objects(), config.node, config.name,
                      [&](Figure figure) { return figure_of(figure, config, motor); });
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
