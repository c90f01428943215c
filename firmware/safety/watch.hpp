// The watch over everything measured: each tick it holds the drives' answers against the limits and names the faults that began.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/arm/joint_observer.hpp"
#include "firmware/arm/kinematics.hpp"
#include "firmware/arm/transmission.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/safety/fault_arbiter.hpp"
#include "firmware/safety/limits.hpp"
#include "firmware/safety/stuck_encoder.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf::safety {

// The joints as the drives report them.
struct JointStates {
  PerJoint<double> position_rad{};
  PerJoint<double> velocity_rad_s{};  // observed
  PerJoint<bool> speed_known{};       // not so while a drive homes by its own method, and changes its zero
  PerJoint<double> torque_nm{};       // that the drives give the joints, estimated from their motors'
  PerJoint<double> torque_low_nm{};   // and its bounds
  PerJoint<double> torque_high_nm{};  //
  PerJoint<bool> fresh{};
  Time t;              // of the SYNC they belong to
  bool valid = false;  // all are fresh: only then are speeds, torques and the time brought up to date
};

// How much there is to watch.
enum class Vigilance : std::uint8_t {
  bus,     // the bus and, where it is heard, the emergency-stop chain: the boot watches the nodes itself
  nodes,   // and every node: drives are being enabled and homed, and those that have power have to stand
  joints,  // and what the joints do
};

class Watch {
 public:
  // The arm is known by its place. `foreign`: what the network has counted of another master's, and what was reported already.
  using Transmissions = PerJoint<arm::TransmissionSetup>;
  explicit Watch(const arm::Arm& arm, const Limits& limits, const Transmissions& transmissions = {},
                 const canopen::ForeignFrames& foreign = {})
      : arm_(&arm), limits_(limits), transmissions_(transmissions), foreign_(foreign) {}

  // Reads the joints; call once a tick after the frames came in. `rad` are the positions decoded from counts.
  void observe(const canopen::Network& network, const PerJoint<double>& rad, Time now);
  const JointStates& joints() const { return joints_; }

  // Faults that began in this tick: each is reported once, and again only after it went away. `tool_m`: the tool point in the base frame.
  void check(const canopen::Network& network, const Vec3& tool_m, Vigilance vigilance, Time now, FaultArbiter& began);

  // Its position stands still while its set-point goes on.
  bool shows_nothing(std::size_t joint) const;
  // Beyond its limits by more than noise.
  bool outside(std::size_t joint) const;
  bool any_outside() const;
  // From now on a joint may stand as far outside its limits as it does now, and the tool as far outside its workspace, and then as far as they have come
  // back since, but no farther: an operator brings them back.
  // `false`: the limits are the limits again.
  void tolerate_excursion(bool tolerate);

 private:
  double excursion_rad(std::size_t joint) const;
  bool is_fresh(const canopen::Axis& axis, Time now) const;
  void observe_torque(const canopen::Axis& axis, std::size_t joint);
  double at_least_nm(std::size_t joint) const;  // that its torque surely is
  void observe_encoder(const canopen::Axis& axis, std::size_t joint, Time now);
  void check_bus(const canopen::Network& network, Time now, FaultArbiter& began);
  void check_nodes(const canopen::Network& network, Vigilance vigilance, Time now, FaultArbiter& began);
  void check_drive(const canopen::Network& network, std::size_t joint, FaultArbiter& began);
  void check_standing(const canopen::Network& network, std::size_t joint, FaultArbiter& began);
  void check_speed(std::size_t joint, FaultArbiter& began);
  void check_joint(std::size_t joint, FaultArbiter& began);
  void check_workspace(const Vec3& tool_m, FaultArbiter& began);
  // `index` tells reports of one fault apart: joint, node, or 0.
  void raise(bool present, std::size_t index, const FaultReport& report, FaultArbiter& began);

  const arm::Arm* arm_;
  Limits limits_;
  Transmissions transmissions_;
  PerJoint<arm::JointObserver> observers_;
  PerJoint<arm::TorqueObserver> torque_observers_;
  bool observing_ = false;
  JointStates joints_;
  PerJoint<StuckEncoder> encoders_;
  PerJoint<bool> stuck_{};  // the roll's turn and the jaw's gripper have rules of their own
  PerJoint<bool> stood_{};  // under power, while others were still being enabled
  PerJoint<int> overload_ticks_{};
  bool tolerating_ = false;
  double tolerated_m_ = 0;  // of the tool, outside of its workspace
  bool tool_outside_ = false;
  PerJoint<double> tolerated_rad_{};                                         // outside of the limits
  static constexpr std::size_t index_count = canopen::ForeignFrames::slots;  // joints, nodes, another master's identifiers
  static_assert(capacity::nodes <= index_count);
  std::array<std::array<bool, index_count>, fault_count> present_{};
  canopen::ForeignFrames foreign_;  // known of
};

}  // namespace lf::safety
