// The drives' power, and how it is taken: the stop functions of ISO 13850 and IEC 60204-1.
//
//   stop category 1   quick stop at once; power off as soon as the arm stands, and at the latest `longest_stop` after the quick stop
//   stop category 0   power off at once, whatever moves
//   lowering          the arm stands: each drive goes down through every state, so that its brake closes first; then as category 0
//
// Both are one way: a stop is never taken back, and a milder one that comes later changes nothing. The self-locking gears hold the arm without power.
// Power is off when every drive says so. A drive that is not heard is told to go down for `blind_time` and then taken for down: nothing more can be done.
//
// A drive that was never heard may have power all the same: a program that died before this one enabled it, and its make stays powered after its quick stop.
// It takes no process data before it is configured, so it is restarted by NMT, and says that it has booted up.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/arm/kinematics.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/safety/watch.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf::safety {

class Power {
 public:
  enum class State : std::uint8_t {
    off,       // no drive has power, as far as can be known
    on,        // drives are being enabled, or are
    lowering,  // the orderly way down
    stopping,  // the quick stop acts
    removing,  // power off is ordered, but not confirmed yet
  };

  // A drive that has not heeded an order by now does not hear its process data: lost frames, or somebody took the node out of operation. Four SYNC periods:
  // the order acts with the next SYNC, and the answer comes with the one after.
  static constexpr Duration heed_time = Duration::from_ms(16);
  static constexpr Duration insist_period = Duration::from_ms(100);
  // Beside another master's NMT: a node that boots for it hears nothing, and an even beat might always meet it there. Two SYNC periods.
  static constexpr Duration insist_period_beside = Duration::from_ms(8);
  // A drive that is not heard is told by process data for so long before it is restarted by NMT. Where no drive is heard it is this master that is deaf: then
  // each is told twice, by process data and by NMT.
  static constexpr Duration silent_time = Duration::from_ms(300);
  // A tick that comes late finds old data of every drive, once.
  static constexpr int deaf_ticks = 3;
  // Two SYNC periods until the order acts are 8 ms: the power is off within 1.2 s of the stop.
  static constexpr Duration longest_stop = Duration::from_ms(1100);
  // A joint stands when it has moved by no more than `still_rad`, or by one count of its encoder, for so long: 0.02 rad/s.
  static constexpr Duration still_time = Duration::from_ms(50);
  static constexpr double still_rad = 0.001;
  // The joints that are heard lose their power when they stand. One that is not is told to stop meanwhile, and taken for standing when the ramp from its last known speed is over, and this: the order's way, and `still_time`.
  static constexpr Duration silent_margin = heed_time + still_time;
  // Its ramp where its speed or the drive's own deceleration is not known, at least.
  static constexpr Duration unknown_ramp = Duration::from_ms(250);
  // The longest that a drive may take to hear of it: 250 SYNC periods.
  static constexpr Duration blind_time = Duration::from_ms(1000);
  // Four handshakes of three SYNC periods are 48 ms; most brakes take up to half a second to close. A drive keeps its torque for as long as its own takes,
  // by its profile.
  static constexpr Duration usual_lowering = Duration::from_ms(700);
  static constexpr Duration lowering_beside_brake = Duration::from_ms(200);
  static Duration longest_lowering(const canopen::NetworkConfig& config);

  // The arm is known by its place.
  explicit Power(const arm::Arm& arm) : arm_(&arm) {}
  explicit Power(arm::Arm&&) = delete;

  void switch_on() { state_ = state_ == State::off ? State::on : state_; }
  // Category 1.
  void stop(Time now, canopen::Network& network);
  // Category 0.
  void remove(Time now, canopen::Network& network);

  // The orderly way down of an arm that stands.
  void lower(Time now, canopen::Network& network);

  // Once a tick, after the joints were observed.
  void tick(const JointStates& joints, Time now, canopen::Network& network);

  State state() const { return state_; }
  bool off() const { return state_ == State::off; }

 private:
  // What stands as far as can be known: the joints that are heard, and all, those too that are not.
  struct Standing {
    bool heard = true;
    bool all = true;
  };
  Standing standing(const JointStates& joints, Time now, const canopen::Network& network);
  void take_heard(const JointStates& joints, Time now, canopen::Network& network);
  Duration ramp(const JointStates& joints, std::size_t joint, const canopen::Network& network) const;
  bool confirmed(Time now, const canopen::Network& network) const;
  // Stops or restarts by NMT what does not heed its process data.
  void insist(Time now, canopen::Network& network);
  static void restart_unheard(Time now, canopen::Network& network);
  bool heeds(std::size_t joint, Time now, const canopen::Network& network) const;
  // Outputs, the laser's among them, that stay on though they were told to go off.
  void insist_on_outputs(Time now, canopen::Network& network);
  void note_what_left(Time now, const canopen::Network& network);
  static bool hears_none(Time now, const canopen::Network& network);

  const arm::Arm* arm_;
  State state_ = State::off;
  Time insist_at_;
  Time since_;  // of the state
  PerJoint<double> rest_rad_{};
  PerJoint<std::int32_t> rest_counts_{};
  PerJoint<Time> rest_since_{};
  PerJoint<bool> told_by_nmt_{};  // since the stop began: deaf to process data
  PerJoint<bool> left_{};         // out of operation, or booted anew: brakes without being told
  PerJoint<Time> brakes_since_{};
  PerJoint<std::optional<Time>> taken_{};  // its power, since it stood
  Time outputs_off_since_;                 // heard to be off, or not wanted to be
  int deaf_ticks_ = 0;                     // in a row
};

const char* name(Power::State state);

}  // namespace lf::safety
