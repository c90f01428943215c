// A servo drive: CiA 402 state machine, modes PP, PV, homing and CSP, its position loop, and what makes it fault.
//
// With the power stage on, the drive imposes a speed, up to what object 6072's torque of the motor gives the joint through gear and friction. Torque and current are
// the motor's: without power there are none. Off, the joint is released to the gear's friction, except in the fault state when 605E asked for a stop (1, 2): then the holding brake stays closed.
// The target of an enabled CSP drive is whatever 607A holds at the next SYNC: who does not seed it with 6064 makes the arm jump.
// 60B0, 60B1, 60B2 and 6071 are taken and ignored: a self-locking axis has no use for them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host_sim/devices/canopen/node.hpp"
#include "host_sim/devices/devices_config.hpp"
#include "host_sim/devices/drive/actuator.hpp"
#include "host_sim/devices/drive/drive_objects.hpp"
#include "host_sim/devices/drive/drive_state.hpp"
#include "host_sim/devices/drive/drive_units.hpp"
#include "host_sim/devices/drive/gear_train.hpp"
#include "host_sim/devices/drive/homing.hpp"
#include "host_sim/devices/drive/position_loop.hpp"
#include "host_sim/devices/drive/profile.hpp"
#include "host_sim/devices/drive/winding.hpp"
#include "host_sim/devices/noise.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::devices {

// What breaks a drive from outside.
struct DriveFaults {
  bool overcurrent = false;
  bool hot = false;
  bool jammed = false;
  bool stuck_encoder = false;
  bool high_torque = false;  // the current sensor says too much
};

class Drive402 : private Application {
 public:
  // Asked for the joint's stiction speed, the controller winds a standing motor's torque up to the rated one in this time: a gain of its own, which knows
  // no gear. A gear with usual friction breaks away after a SYNC. Chosen: real drives have gains of their own, and say none.
  static constexpr double winding_s = 0.05;

  Drive402(const DriveConfig& config, Duration boot_time, std::uint64_t seed);

  Node& node() { return node_; }
  DriveFaults& faults() { return faults_; }

  void power_on(Time now, const JointReading& reading);

  // One millisecond of the control loop: `reading` is the joint at `now`, the answer holds until the next call.
  JointDrive tick(Time now, const JointReading& reading);

  DriveState state() const { return state_; }
  double counts_of(double angle_rad) const { return actuator_.counts(angle_rad); }

 private:
  Abort may_write(const Object& object, std::int64_t value) override;
  void written(const Object& object, Time now) override;
  void received(Time now) override;
  void synced(Time now) override;
  void connection_lost(std::uint16_t code, Time now) override;
  void state_changed(NmtState, Time) override {}
  void restarted(Time now) override;

  Abort may_write_habit(const Object& object, std::int64_t value) const;
  bool without_sync(Time now) const;
  bool brake_closed(Time now) const;
  void measure(const JointReading& reading);
  void measure_torque(const JointReading& reading);
  double torque_limit_nm() const;
  double ratio() const;              // turns of the motor per turn of the joint
  double asked_of_stiction() const;  // the speed that the loop asks for, over the joint's stiction speed
  void on_controlword(Time now);
  void reset_fault(Time now);
  void begin_ramp();
  void enter(DriveState state);
  // `option`: how it stops, as 605E numbers it.
  void fault(std::uint16_t code, std::int64_t option, Time now);
  void watch(Time now);
  bool follows_badly() const;
  void change_mode();
  void generate(Time now);
  void profile_position();
  void run_homing();
  void finish_ramp();
  JointDrive actuate();
  void publish();
  std::int64_t mode_bits() const;

  static constexpr std::int64_t quick_stop_ramp = 2;  // 605E

  bool ramp_wanted(DriveState next) const;
  bool powered() const;
  double clamp_to_limits(double target);
  double top_speed() const { return static_cast<double>(o_.max_velocity.value); }

  DriveConfig config_;
  Actuator actuator_;
  Node node_;
  // A strict drive's objects are in its own units: it works in these.
  std::optional<ObjectDictionary> native_;
  std::optional<DriveUnits> units_;
  DriveObjects o_;
  Noise noise_;
  PositionLoop loop_;
  Profile profile_;
  CyclicPosition cyclic_;
  Homing homing_;
  GearTrain gear_;
  Winding winding_;
  DriveFaults faults_;

  DriveState state_ = DriveState::not_ready;
  bool ramping_ = false;  // slowing down in a state that is already without operation
  bool brake_ = false;
  std::int64_t reaction_option_ = 0;  // of the fault under way
  std::int64_t mode_ = 0;
  std::uint16_t last_controlword_ = 0;
  Time last_sync_;
  Time last_target_;
  Time enabled_at_;
  bool brake_closed_ = false;

  std::int64_t encoder_ = 0;  // counts, before homing's shift
  std::int64_t zero_ = 0;     // position actual = encoder + zero
  double rad_per_count_ = 1e-4;
  double motor_rad_ = 0;     // as the joint's angle
  double jammed_nm_ = 0;     // of a motor that has seized
  double torque_ratio_ = 0;  // of the motor's rated torque, positive in the direction of counts, filtered
  double velocity_counts_s_ = 0;
  double ramp_counts_s_ = 0;  // that a stop's ramp may begin with: no jump of the encoder is in it
  double last_counts_ = 0;
  double output_rad_s_ = 0;

  std::int64_t set_point_ = 0;  // PP
  bool set_point_taken_ = false;
  bool homed_ = false;    // the present homing run has set the zero
  bool limited_ = false;  // the target was outside 607D
  int following_ms_ = 0;
  int on_target_ms_ = 0;
};

}  // namespace lf::devices
