#include "host_sim/world/drive_rows.hpp"

#include <algorithm>
#include <cmath>

namespace lf::world {
namespace {

enum Slot : std::size_t { lower_flank = 0, upper_flank = 1, lower_stop = 2, upper_stop = 3 };

constexpr double stop_impulse_n_m_s = 1e6;  // a stop gives what it takes
// A stop's row is set when it could be met within the step: 20 rad/s is an order above any joint's speed.
constexpr double stop_reach_rad_s = 20;

}  // namespace

DriveStep plan_drive(const JointDrive& drive, double holding_torque_nm, double motor_rad, double step_s) {
  if (drive.released) return {motor_rad, holding_torque_nm};
  if (!std::isfinite(drive.velocity_rad_s) || !std::isfinite(drive.torque_limit_nm)) return {motor_rad, 0};
  return {motor_rad + drive.velocity_rad_s * step_s, std::max(0.0, drive.torque_limit_nm)};
}

double set_drive_rows(JointRows& rows, const DrivenJoint& joint, const DriveStep& drive, double position_rad, double step_s) {
  const double impulse = drive.torque_nm * step_s;
  const double lower_rad = drive.motor_rad - 0.5 * joint.backlash_rad;
  const double upper_rad = drive.motor_rad + 0.5 * joint.backlash_rad;
  const double speed_to_lower = (lower_rad - position_rad) / step_s;
  const double speed_to_upper = (upper_rad - position_rad) / step_s;

  const bool at_lower_stop = position_rad - stop_reach_rad_s * step_s < joint.lower_rad;
  const bool at_upper_stop = position_rad + stop_reach_rad_s * step_s > joint.upper_rad;
  if (at_lower_stop) rows.set(lower_stop, {(joint.lower_rad - position_rad) / step_s, 0, stop_impulse_n_m_s});
  if (at_upper_stop) rows.set(upper_stop, {(joint.upper_rad - position_rad) / step_s, -stop_impulse_n_m_s, 0});

  // A drive that asks for what lies beyond a stop: two rows would fight over one joint, so it pushes with all its torque and the stop answers.
  if (at_lower_stop && upper_rad < joint.lower_rad) return -drive.torque_nm;
  if (at_upper_stop && lower_rad > joint.upper_rad) return drive.torque_nm;
  if (impulse <= 0) return 0;
  if (joint.backlash_rad <= 0) {
    rows.set(lower_flank, {speed_to_lower, -impulse, impulse});
  } else {
    rows.set(lower_flank, {speed_to_lower, 0, impulse});
    rows.set(upper_flank, {speed_to_upper, -impulse, 0});
  }
  return 0;
}

double drive_torque_nm(const JointRows& rows, double step_s) { return (rows.impulse(lower_flank) + rows.impulse(upper_flank)) / step_s; }

double motor_in_play(double planned_rad, double position_rad, double backlash_rad) {
  return std::clamp(planned_rad, position_rad - 0.5 * backlash_rad, position_rad + 0.5 * backlash_rad);
}

}  // namespace lf::world
