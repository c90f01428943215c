// The screw or gear between a motor and its joint: what the motor feels of the joint's load, and what the joint gets of the motor's torque.
//
// Friction is Coulomb's and viscous, at the motor, and grows with the load: the motor gives 1 / efficiency of what a load without friction would take, and
// gets back back_efficiency of what it would give. Between the two the gear sticks: a motor that stands keeps the torque with which it came to rest, as
// far as that neither moves the load nor is moved by it (the stop operator of Prandtl and Ishlinskii). A gear with a back efficiency of 0 or less locks itself.
//
// The core knows Coulomb's and viscous friction and the efficiencies only. Here a gear also takes more to break away than to keep moving, falling off with the
// speed as Stribeck found, and rubs more one way than the other.
//
// A motor that stands does not turn before its torque breaks friction and load. How fast its controller winds the torque up is the controller's (drive402.hpp):
// it knows neither. A gear that rubs more, a load, or a torque that still points the other way take longer.
#pragma once

namespace lf::devices {

struct GearFriction {
  double coulomb_nm = 0;
  double viscous_nm_s = 0;  // per rad/s of the motor
  double efficiency = 1;
  double back_efficiency = 1;
  double breakaway = 1;  // Coulomb friction of a motor that stands over that of one that moves; at least 1
  double one_way = 0;    // share by which Coulomb friction is more forward and less backward
};

class GearTrain {
 public:
  // Rotor and gear smooth what comes in shorter than this.
  static constexpr double smoothing_s = 0.016;
  // Slower than this the motor stands, rad/s: an eighth of a turn a second, 0.7 mrad/s at a joint.
  static constexpr double standing_rad_s = 0.5;
  // The speed of the motor over which the greater friction of standing falls off: boundary lubrication ends at some turns a second.
  static constexpr double stribeck_rad_s = 10;
  // What a locked gear holds before it breaks, at the joint.
  static constexpr double breaking_nm = 1000;

  explicit GearTrain(const GearFriction& friction) : friction_(friction) {}

  // The motor has no current.
  void reset();
  // The motor's torque after `dt_s` in which the gear gave `joint_nm` to the joint. `ratio`: turns of the motor per turn of the joint, here; positive.
  // `wound_nm`: by how much the controller raises the torque of a motor that stands, meanwhile.
  double step(double joint_nm, double motor_rad_s, double ratio, double dt_s, double wound_nm = 0);

  // Whether the motor's torque turns a motor that stands, `way` 1 or -1, and is not more than the motor may have.
  bool breaks_away(double way, double limit_nm) const;

  // What the joint gets at most from a motor with this torque, at this speed of the motor's: pushing a load, and holding against one that pushes back.
  double push_nm(double motor_nm, double motor_rad_s, double ratio) const;
  double hold_nm(double motor_nm, double ratio) const;

 private:
  double coulomb_nm(double way, double motor_rad_s) const;
  double turning_nm(double way,
                    double load_nm) const;  // at the motor, less viscous friction: what turns it this way against or with this load

  GearFriction friction_;
  double load_nm_ = 0;  // over the ratio, smoothed
  double speed_rad_s_ = 0;
  double held_nm_ = 0;
};

}  // namespace lf::devices
