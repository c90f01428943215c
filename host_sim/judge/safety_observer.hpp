// Watches a run from outside the core and keeps what a judge of its safety needs: the frames on the bus, the drives' power, and the world. It knows
// nothing of the core's own account.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "hal/sim/sim_platform.hpp"

namespace lf::judge {

// A bit a joint.
using JointBits = std::uint16_t;
static_assert(capacity::joints <= 16);

// One millisecond.
struct Moment {
  PerJoint<float> speed_rad_s{};  // true, absolute
  PerJoint<float> angle_rad{};    // true
  PerJoint<float> motor_rad{};    // the motor's, in the joint's units: differs by what the gear gives
  PerArmJoint<float> works_nm{};  // of a joint that moves: torque of its drive in the direction in which it goes; 0 of one that stands
  float force_n = 0;              // the largest on any one body, over the world's force window
  float push_n = 0;               // between the arm and the obstacle, over the same
  float grip_n = 0;               // of each finger on the handle, over the same
  JointBits power = 0;            // bit a joint: its power stage holds or moves it
  JointBits told_to_run = 0;      // bit a joint: in operation, and the newest RPDO says operation enabled
};

// What was seen since watching began; times are seconds since then.
struct Seen {
  std::size_t arm_joints = 4;   // that place the tool: the jaw comes after them
  std::vector<Moment> moments;  // one a millisecond
  // The first frame that says a drive is in fault, a node has an emergency or has rebooted, or the emergency-stop chain is open.
  std::optional<double> fault_reported_s;
  std::optional<double> drive_fault_s;    // the first statusword in which a drive says that it is in fault
  std::optional<double> chain_open_s;     // the first that says the chain is open
  std::optional<double> second_master_s;  // the first frame of a second master
  // The newest process data that arrived from each node, by its index in the network; 0 when none did.
  std::array<double, capacity::nodes> last_heard_s{};
  // The lowest and the highest position that our master told each drive to go to, in the drive's units; nothing where it told none.
  PerJoint<std::optional<std::pair<std::int32_t, std::int32_t>>> told_to_go{};
};

class SafetyObserver : public hal::SimObserver {
 public:
  // `nodes`: numbers on the bus, of the drives in the order of their joints, then of the output node.
  explicit SafetyObserver(std::vector<std::uint8_t> nodes) : nodes_(std::move(nodes)) {}

  // From now on; what was seen before is forgotten. `devices` outlives the watch.
  void begin(const devices::Devices& devices, Time now);

  void on_bus_frame(const devices::BusRecord& record) override;
  void on_step(Time now, const world::World& world) override;

  const Seen& seen() const { return seen_; }

 private:
  // Of a node in the network: the drives in the order of their joints, then the output node; nothing for another.
  std::optional<std::size_t> index_of(std::size_t node) const;
  void note_target(std::size_t joint, const CanFrame& frame);
  void judge_report(const CanFrame& frame, double t_s);

  std::size_t drive_count() const { return nodes_.size() - 1; }

  std::vector<std::uint8_t> nodes_;
  const devices::Devices* devices_ = nullptr;
  Time begin_;
  Seen seen_;
  PerJoint<bool> run_ordered_{};  // known before watching began, too
};

}  // namespace lf::judge
