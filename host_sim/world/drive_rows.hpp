// A self-locking drive with play, as constraints on its joint. Internal to this folder.
//
// Motor and joint are a lash apart: |motor - joint| <= backlash / 2. The motor runs at the commanded speed; the joint is free between the two flanks of the
// play and is carried by the flank it meets, with at most the drive's torque. A joint that the torque cannot move (or that is pushed back by more) holds or
// drags the motor with it, as a slip clutch would: the motor's position is that of the flank in contact. With no power the motor stands still and the flanks
// hold with the self-locking gear's friction. This is exact for loads of either sign and for loads that reverse: the joint then crosses the play by itself.
#pragma once

#include "host_sim/world/joint_rows.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::world {

// A joint of the arm's multibody and what turns it. The jaw has two, one a finger, on one motor.
struct DrivenJoint {
  int link = 0;
  double lower_rad = 0, upper_rad = 0;
  double backlash_rad = 0;
  double holding_torque_nm = 0;
};

// Speed and torque that the drive works with in one step.
struct DriveStep {
  double motor_rad = 0;  // where the motor gets to when nothing stalls it
  double torque_nm = 0;  // most it applies, either way
};

// The step's target for a motor at `motor_rad`. A drive command that is not finite applies no torque.
DriveStep plan_drive(const JointDrive& drive, double holding_torque_nm, double motor_rad, double step_s);

// Sets the rows of one joint at `position_rad`, flanks and stops, and returns the torque that stalls against a stop (0 when it does not),
// to be applied to the joint as it is.
double set_drive_rows(JointRows& rows, const DrivenJoint& joint, const DriveStep& drive, double position_rad, double step_s);

// After the step: the torque that the flanks gave the joint.
double drive_torque_nm(const JointRows& rows, double step_s);

// After the step: the motor's position nearest to `planned_rad` that the play allows for a joint at `position_rad`.
double motor_in_play(double planned_rad, double position_rad, double backlash_rad);

}  // namespace lf::world
