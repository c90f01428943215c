#include "host_sim/world/drive_rows.hpp"

#include <algorithm>
#include <cmath>

namespace lf::world {
namespace {

enum Slot : std::size_t { lower_flank = 0, upper_flank = 1, lower_stop = 2, upper_stop = 3, coupling = 4, water = 5 };

constexpr double unlimited_n_m_s = 1e6;  // a stop, and the fingers' coupling, give what it takes
// A stop's row is set when it could be met within the step: 20 rad/s is an order above any joint's speed.
constexpr double stop_reach_rad_s = 20;
// A flank's damper for its spring: it settles in about this time, 5 to 10 steps, as rubber pads and greased screws do without ringing.
constexpr double settling_s = 0.005;

// What a flank at `flank_rad` at the step's end asks of the joint: spring and damper, both taken at the step's end, so that any stiffness is stable.
JointRows::Row flank_row(double flank_rad, const DriveStep& drive, double stiffness_nm_rad, double position_rad, double step_s) {
  if (stiffness_nm_rad <= 0) return {(flank_rad - position_rad) / step_s};
  const double damping_nm_s = stiffness_nm_rad * settling_s;
  const double softness = 1 / (step_s * (step_s * stiffness_nm_rad + damping_nm_s));
  JointRows::Row row;
  row.speed = softness * step_s * (stiffness_nm_rad * (flank_rad - position_rad) + damping_nm_s * drive.speed_rad_s);
  row.softness = softness;
  return row;
}

double stall_nm(double wound_up_rad, const DriveStep& drive, const DrivenJoint& joint) {
  return joint.stiffness_nm_rad > 0 ? std::min(drive.push_nm, joint.stiffness_nm_rad * std::max(0.0, wound_up_rad)) : drive.push_nm;
}

void set_row(JointRows& rows, Slot slot, const DrivenJoint& joint, JointRows::Row row) {
  if (joint.coupled) row.first = row.second = 0.5;
  rows.set(slot, row);
}

}  // namespace

DriveStep plan_drive(const JointDrive& drive, double holding_torque_nm, const DrivenJoint& joint, double motor_rad, double position_rad,
                     double step_s) {
  if (drive.released) return {motor_rad, holding_torque_nm, holding_torque_nm, holding_torque_nm, 0};
  if (!std::isfinite(drive.velocity_rad_s) || !std::isfinite(drive.torque_limit_nm) || !std::isfinite(drive.holding_limit_nm))
    return {motor_rad, 0, 0, 0, 0};
  const double push_nm = std::max(0.0, drive.torque_limit_nm), hold_nm = std::max(push_nm, drive.holding_limit_nm);
  if (joint.stiffness_nm_rad > 0) {
    const double stiffness_nm_rad = joint.coupled ? 0.5 * joint.stiffness_nm_rad : joint.stiffness_nm_rad;
    const double wound_up_rad = 0.5 * joint.backlash_rad + push_nm / stiffness_nm_rad;
    const double highest_rad = std::max(motor_rad, position_rad + wound_up_rad),
                 lowest_rad = std::min(motor_rad, position_rad - wound_up_rad);
    const double wanted_rad = std::clamp(motor_rad + drive.velocity_rad_s * step_s, lowest_rad, highest_rad);
    return {wanted_rad, hold_nm, hold_nm, push_nm, (wanted_rad - motor_rad) / step_s};
  }
  const double up_nm = drive.velocity_rad_s > 0 ? push_nm : hold_nm, down_nm = drive.velocity_rad_s < 0 ? push_nm : hold_nm;
  return {motor_rad + drive.velocity_rad_s * step_s, up_nm, down_nm, push_nm, drive.velocity_rad_s};
}

double set_drive_rows(JointRows& rows, const DrivenJoint& joint, const DriveStep& drive, double position_rad, double step_s) {
  const double up = drive.torque_up_nm * step_s, down = drive.torque_down_nm * step_s;
  const double lower_rad = drive.motor_rad - 0.5 * joint.backlash_rad;
  const double upper_rad = drive.motor_rad + 0.5 * joint.backlash_rad;
  const bool at_lower_stop = position_rad - stop_reach_rad_s * step_s < joint.lower_rad;
  const bool at_upper_stop = position_rad + stop_reach_rad_s * step_s > joint.upper_rad;
  if (at_lower_stop) set_row(rows, lower_stop, joint, {(joint.lower_rad - position_rad) / step_s, 0, unlimited_n_m_s});
  if (at_upper_stop) set_row(rows, upper_stop, joint, {(joint.upper_rad - position_rad) / step_s, -unlimited_n_m_s, 0});

  // A drive that asks for what lies beyond a stop: two rows would fight over one joint, so it pushes as its spring is wound up, and the stop answers.
  if (at_lower_stop && upper_rad < joint.lower_rad) return -stall_nm(position_rad - upper_rad, drive, joint);
  if (at_upper_stop && lower_rad > joint.upper_rad) return stall_nm(lower_rad - position_rad, drive, joint);
  if (up <= 0 && down <= 0) return 0;
  JointRows::Row lower = flank_row(lower_rad, drive, joint.stiffness_nm_rad, position_rad, step_s);
  JointRows::Row upper = flank_row(upper_rad, drive, joint.stiffness_nm_rad, position_rad, step_s);
  lower.impulse_max = up;
  upper.impulse_min = -down;
  if (joint.backlash_rad > 0) {
    set_row(rows, lower_flank, joint, lower);
    set_row(rows, upper_flank, joint, upper);
  } else {
    lower.impulse_min = -down;
    set_row(rows, lower_flank, joint, lower);
  }
  return 0;
}

void set_coupling_row(JointRows& rows, const DrivenJoint& joint, double apart_rad, double step_s) {
  // Each finger bends by its own share: half the sum of their stiffnesses in series with the other half.
  JointRows::Row row = flank_row(-apart_rad, {}, 0.25 * joint.stiffness_nm_rad, 0, step_s);
  row.impulse_min = -unlimited_n_m_s;
  row.impulse_max = unlimited_n_m_s;
  row.first = -1;
  row.second = 1;
  rows.set(coupling, row);
}

void set_water_row(JointRows& rows, const DrivenJoint& joint, double drag_nm_s, double step_s) {
  if (drag_nm_s > 0) set_row(rows, water, joint, JointRows::damper(joint.coupled ? 2 * drag_nm_s : drag_nm_s, step_s));
}

double drive_torque_nm(const JointRows& rows, double step_s) { return (rows.impulse(lower_flank) + rows.impulse(upper_flank)) / step_s; }

double motor_after(const DriveStep& drive, const DrivenJoint& joint, double position_rad) {
  const double softness = joint.stiffness_nm_rad > 0 ? 1 / joint.stiffness_nm_rad : 0;
  const double slack_rad = 0.5 * joint.backlash_rad;
  // Above the joint the motor pushes it up.
  return std::clamp(drive.motor_rad, position_rad - slack_rad - softness * drive.torque_down_nm,
                    position_rad + slack_rad + softness * drive.torque_up_nm);
}

}  // namespace lf::world
