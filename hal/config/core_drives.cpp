#include "hal/config/core_drives.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/arm/actuator.hpp"
#include "firmware/mission/axis_limits.hpp"
#include "hal/config/holding.hpp"
#include "hal/config/motor_check.hpp"
#include "shared/arm/motor.hpp"
#include "shared/input_error.hpp"

namespace lf::config {
namespace {

// Of a joint's best acceleration: drives refuse a ramp above what they are able to. As delivered some would take seconds to stop.
constexpr double quick_stop_share = 0.95;

// Friction of the description's, not of this machine's measurement: what a catalogue says is wrong by 20 to 30 % in the force that follows from it.
constexpr double friction_doubt = 0.3, efficiency_doubt = 0.05;
// What the cap lies above the torque of an overload, and what a reading can be wrong by, of the rated torque.
constexpr double overload_reserve = 1.05, torque_noise = 0.01;

// The drives' own limits lie this far outside of the stroke: encoder offsets do not clip the last degrees.
constexpr double beyond_stroke_rad = 0.01;

canopen::DriveSetup drive_setup(const ArmModel::Joint& joint, const safety::JointLimit& limit) {
  canopen::DriveSetup setup;
  setup.min_counts = arm::counts_from_rad(joint, limit.min_rad);
  setup.max_counts = arm::counts_from_rad(joint, limit.max_rad);
  setup.drive_margin_counts = std::max({0, setup.min_counts - arm::counts_from_rad(joint, joint.lower_rad - beyond_stroke_rad),
                                        arm::counts_from_rad(joint, joint.upper_rad + beyond_stroke_rad) - setup.max_counts});
  // A drive has one number for all poses, so it gets that of the pose where a radian has the most counts: elsewhere it allows a screw more. The master
  // limits each pose by its own (mission/axis_limits.hpp).
  double least = 1e9;
  for (int i = 0; i <= 64; ++i) least = std::min(least, arm::rad_per_count(joint, std::lerp(limit.min_rad, limit.max_rad, i / 64.0)));
  setup.max_speed_counts_s = static_cast<std::uint32_t>(joint.velocity_rad_s / least);
  setup.following_window_counts = static_cast<std::uint32_t>(mission::following_window_rad / least);
  setup.quick_stop_counts_s2 = static_cast<std::uint32_t>(quick_stop_share * joint.acceleration_rad_s2 / least);
  return setup;
}

}  // namespace

void set_drive(const Machine& machine, std::size_t joint, const DriveKind& kind, const ArmJoint& description, canopen::DriveSetup& setup) {
  const JointDriveChoice choice = drive_of(machine.drives, joint);
  const std::string where = machine.told_in() + ": drives." + description.name;
  check_motor(choice, description, where);
  check_holding(choice, kind, where);
  setup.node = static_cast<std::uint8_t>(choice.node);
  // A drive that says its rated torque is only checked against a stated one; one that does not, has the arm's description's.
  const bool described = choice.rated_torque_nm == 0 && kind.rating == "configured";
  const Motor motor = motor_of(description, choice.counts_per_rev);
  setup.described_torque_unm = static_cast<std::uint32_t>(std::llround(1e6 * motor.rated_torque_nm));
  apply(kind,
        {choice.counts_per_rev, described ? motor.rated_torque_nm : choice.rated_torque_nm, choice.rated_current_a,
         choice.polarity == "reversed"},
        where, setup);
  check_position_unit(choice, description, kind, where);
}

arm::TransmissionSetup transmission_of(const ArmJoint& joint, double counts_per_rev) {
  const Motor motor = motor_of(joint, counts_per_rev);
  return {
      counts_per_rev,
      {motor.coulomb_nm, motor.viscous_nm_s, joint.friction.efficiency, joint.friction.back_efficiency, friction_doubt, efficiency_doubt}};
}

std::uint16_t torque_cap_permille(const ArmJoint& joint, const safety::JointLimit& limit, const arm::TransmissionSetup& transmission) {
  const Motor motor = motor_of(joint, transmission.counts_per_rev);
  const arm::Friction& friction = transmission.friction;
  const double ratio = best_motor_ratio(joint, transmission.counts_per_rev);
  const double load_nm = overload_reserve * limit.max_torque_nm / (ratio * friction.efficiency * (1 - friction.efficiency_doubt));
  const double seen_nm = load_nm + friction.coulomb_nm * (1 + friction.doubt) + torque_noise * motor.rated_torque_nm;
  return static_cast<std::uint16_t>(std::clamp(1000 * std::min(seen_nm, motor.peak_torque_nm) / motor.rated_torque_nm, 1.0, 1000.0));
}

canopen::NetworkConfig network_config(const arm::Arm& arm, const safety::Limits& limits) {
  canopen::NetworkConfig network;
  for (std::size_t i = 0; i < arm.joint_count(); ++i)
    (void)network.drives.push_back(drive_setup(arm.joint(i), limits.joints[i]));  // they fit: the arm does
  return network;
}

void check_network(const Machine& machine, const canopen::NetworkConfig& network) {
  std::size_t offender = 0;
  const canopen::ConfigError error = canopen::check(network, offender);
  if (error == canopen::ConfigError::none) return;
  const std::size_t drives = network.drives.size();
  const auto name_of = [&](std::size_t i) { return i < drives ? "drives." + machine.joints[i] : std::string("outputs"); };
  if (error == canopen::ConfigError::node_twice) {
    const auto node_of = [&](std::size_t i) { return i < drives ? network.drives[i].node : network.io.node; };
    std::size_t first = 0;
    while (node_of(first) != node_of(offender)) ++first;
    throw InputError(machine.told_in() + ": " + name_of(first) + " and " + name_of(offender) + " have the same node number, " +
                     std::to_string(node_of(offender)));
  }
  if (error == canopen::ConfigError::positions) {
    const canopen::DriveSetup& drive = network.drives[offender];
    const double units = static_cast<double>(drive.profile.scale.position.num) / drive.profile.scale.position.den;
    char text[256];
    std::snprintf(
        text, sizeof text,
        "its profile makes %.6g of the drive's units of one of the arm's counts: over the joint's range the drive would count beyond the "
        "2147483647 that 32 bits hold. Set a coarser position unit in the drive and in its profile, or check 'counts_per_rev'",
        units);
    throw InputError(machine.told_in() + ": " + name_of(offender) + ": " + text);
  }
  throw InputError(machine.told_in() + ": " + (offender < drives ? name_of(offender) : "outputs, or the bus") + ": " +
                   canopen::name(error));
}

}  // namespace lf::config
