// What is heard of nodes that are not served, from the process data that the master has mapped (shared/can/can_map.yaml): where a real drive stands, and
// what a real output node switches and triggers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "host_sim/devices/exposure.hpp"
#include "shared/arm/arm_model.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf::serve {

class OverheardDrives {
 public:
  // `zero_counts`: what each real drive's encoder counts where the arm's own count is 0.
  explicit OverheardDrives(const ArmModel& arm, const PerJoint<std::int32_t>& zero_counts = {}) : arm_(arm), zero_counts_(zero_counts) {}

  void hear(const CanFrame& frame, Time t);
  // The joint's motor, as its drive last reported it; nothing before it did.
  std::optional<double> position_rad(std::size_t joint) const;
  // What moves the world's motor, which stands at `motor_rad`, there: the reported speed and a share of the distance, up to the joint's own top speed and
  // torque. A drive that was never heard holds.
  JointDrive follow(std::size_t joint, double motor_rad) const;

 private:
  struct Report {
    Time t;
    double position_rad = 0;
    double velocity_rad_s = 0;  // smoothed: a count in a SYNC period is up to 0.8 rad/s
    bool heard = false;
  };
  ArmModel arm_;
  PerJoint<std::int32_t> zero_counts_;
  PerJoint<Report> reports_{};
};

class OverheardOutputs {
 public:
  // `t` as it is to stand in the exposures.
  void hear(const CanFrame& frame, Time t);
  // The camera was triggered at a SYNC; oldest first, each once.
  std::optional<devices::Exposure> take_exposure();
  bool laser_on() const;  // after the interlock
  bool lamps_on() const;

 private:
  void on_sync(Time t);

  bool known_ = false;  // the node has said which trigger it saw last
  bool asked_ = false;  // an RPDO waits for its SYNC
  bool interlock_closed_ = false;
  std::uint8_t outputs_ = 0, counter_ = 0, last_counter_ = 0;
  std::uint16_t exposure_us_ = 0;
  std::vector<devices::Exposure> exposures_;
};

}  // namespace lf::serve
