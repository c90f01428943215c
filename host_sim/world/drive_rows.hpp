// A self-locking drive with play and compliance, as constraints on its joint. Internal to this folder.
//
// Motor and joint are a lash apart: |motor - joint| <= backlash / 2. The motor runs at the commanded speed; the joint is free between the two flanks of the
// play and is carried by the flank it meets, with at most the drive's torque. A joint that the torque cannot move (or that is pushed back by more) holds or
// drags the motor with it, as a slip clutch would: the motor's position is that of the flank in contact. With no power the motor stands still and the flanks
// hold with the gear's friction. This is exact for loads of either sign and for loads that reverse: the joint then crosses the play by itself.
//
// The flanks are springs: what screws, links and pads give way by under load is lumped there. Without it a gripped, misaligned handle sees 900 N.
#pragma once

#include "host_sim/world/joint_rows.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::world {

// A coordinate that a drive turns: a joint, or the mean of the two fingers, which the jaw's one screw moves together (`coupled`). Torques and stiffness of
// coupled joints are the sums over both.
struct DrivenJoint {
  bool coupled = false;
  double lower_rad = 0, upper_rad = 0;
  double backlash_rad = 0;
  double stiffness_nm_rad = 0;  // of a flank; 0 rigid
};

// Speed and torque that the drive works with in one step.
struct DriveStep {
  double motor_rad = 0;       // where the motor gets to when nothing stalls it
  double torque_up_nm = 0;    // most it applies to larger angles
  double torque_down_nm = 0;  // and to smaller ones; both positive
  double push_nm = 0;         // with which it presses on a stop
  double speed_rad_s = 0;
};

// The step's target for a motor at `motor_rad` of a joint at `position_rad`. The motor winds its spring up to the torque that it can push, and stalls there:
// friction holds it against a load that is larger. A drive command that is not finite applies no torque.
DriveStep plan_drive(const JointDrive& drive, double holding_torque_nm, const DrivenJoint& joint, double motor_rad, double position_rad,
                     double step_s);

// Sets the rows of a coordinate at `position_rad`, flanks and stops, and returns the torque that stalls against a stop (0 when it does not),
// to be applied to the coordinate as it is.
double set_drive_rows(JointRows& rows, const DrivenJoint& joint, const DriveStep& drive, double position_rad, double step_s);

// Holds two coupled joints together: the second less the first is `apart_rad` as the step begins.
void set_coupling_row(JointRows& rows, const DrivenJoint& joint, double apart_rad, double step_s);

// The water's drag, N m a rad/s of each of the joints.
void set_water_row(JointRows& rows, const DrivenJoint& joint, double drag_nm_s, double step_s);

// After the step: the torque that the flanks gave the joint.
double drive_torque_nm(const JointRows& rows, double step_s);

// After the step: the motor's position nearest to the planned one that play and springs allow for a joint at `position_rad`.
double motor_after(const DriveStep& drive, const DrivenJoint& joint, double position_rad);

}  // namespace lf::world
