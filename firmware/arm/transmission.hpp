// Between a motor's torque and its joint's: the screw's or gear's ratio at the joint's angle, and friction on the way.
//
// Virtual work gives the ratio: joint torque x d angle = motor torque x d turn, so without friction torque_joint = ratio torque_motor with
// ratio = d turn / d angle of the screw's triangle (actuator.hpp). Friction has a part that is there without load (Coulomb and viscous) and a part that
// grows with the load (efficiency). Driving the load, torque_joint = ratio efficiency (torque_motor - friction); driven by it, torque_joint = ratio / back_efficiency
// (torque_motor - friction). Friction acts against the motion: at standstill the load may be anywhere between the two directions' torques.
// A screw with a back efficiency of 0 locks itself: at standstill the motor's torque does not bound its load.
// Method: real screws are identified so, see docs/canopen.md; efficiencies from lead and friction angle, eta = tan(alpha) / tan(alpha + phi).
#pragma once

#include "firmware/arm/actuator.hpp"

namespace lf::arm {

// Of one joint's motor, screw and gear, at the motor's shaft. Positive.
struct Friction {
  double coulomb_nm = 0;
  double viscous_nm_s = 0;      // per rad/s of the motor
  double efficiency = 1;        // above 0, at most 1: the motor drives the load
  double back_efficiency = 1;   // at most 1: the load drives the motor; 0 or less: it cannot, the screw locks itself
  double doubt = 0;             // how wrong Coulomb and viscous friction can be, as a share of themselves
  double efficiency_doubt = 0;  // how wrong either efficiency can be, as a share of itself
};

struct TransmissionSetup {
  double counts_per_rev = 64;  // of the arm's counts in a revolution of the motor
  Friction friction;
};

// A joint's torque, N m, positive where the drive pushes the joint to larger angles: the best estimate, and the bounds that it is surely within.
struct TorqueEstimate {
  double nm = 0;
  double low_nm = 0;
  double high_nm = 0;
  // The torque's magnitude is at least this; 0 where the bounds have different signs.
  double at_least_nm() const { return low_nm > 0 ? low_nm : high_nm < 0 ? -high_nm : 0; }
};

class Transmission {
 public:
  // What a self-locking screw holds before something breaks: the bound of a load of which the motor says nothing.
  static constexpr double breaking_nm = 1000;

  explicit Transmission(const ArmModel::Joint& joint, const TransmissionSetup& setup = {}) : joint_(joint), setup_(setup) {}

  // d turn of the motor / d angle of the joint at this angle; positive.
  double ratio(double q_rad) const;
  // The motor's torque that moves the joint against a load at this speed, slow enough for inertia not to count: the drive applies `joint_nm` to the
  // joint. Speed 0: without friction.
  double motor_torque_nm(double q_rad, double speed_rad_s, double joint_nm) const;
  // The other way round. `direction` is that of the present motion, or of the last one where the joint stands (0: it has not moved yet, both are
  // possible); `standing` widens the bounds to all loads that the motor's torque could stand still with. `motor_doubt_nm`: of the reading.
  TorqueEstimate joint_torque(double q_rad, double speed_rad_s, int direction, bool standing, double motor_nm, double motor_doubt_nm) const;

 private:
  ArmModel::Joint joint_;
  TransmissionSetup setup_;
};

// One joint's torque over time: remembers which way the joint moved last, SYNC by SYNC.
class TorqueObserver {
 public:
  // Slower than this times the angle of one count, per second, the joint counts as standing: the observed speed wavers by 6 of these at each count.
  static constexpr double standing_counts_s = 12;

  void reset() { *this = TorqueObserver(); }
  TorqueEstimate update(const Transmission& transmission, double rad_per_count, double q_rad, double speed_rad_s, double motor_nm,
                        double motor_doubt_nm);

 private:
  int direction_ = 0;
};

}  // namespace lf::arm
