// The served nodes on a bus: what comes in goes to each of them at once, and what they answer goes out at once. Nodes that are not served are listened to.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "host_sim/devices/bus/bus_record.hpp"
#include "host_sim/devices/canopen/node_rack.hpp"
#include "host_sim/serve/can_link.hpp"
#include "host_sim/serve/loop_camera.hpp"
#include "host_sim/serve/node_set.hpp"
#include "host_sim/serve/overheard.hpp"
#include "host_sim/serve/pace.hpp"

namespace lf::serve {

class ServedBus {
 public:
  static constexpr std::size_t most_answers = 1'000'000;  // over an hour of SYNCs, 8 MB

  struct Stats {
    std::uint64_t received = 0, sent = 0, send_failures = 0;
    std::uint64_t error_frames = 0;
    std::uint64_t bits = 0;         // of all frames seen, with their stuff bits
    std::vector<double> answer_us;  // from a SYNC's reception to its last answer handed to the kernel; the first `most_answers`
  };

  // `real_zero_counts`: see OverheardDrives.
  ServedBus(devices::NodeRack& rack, CanLink& link, const NodeSet& served, const ArmModel& arm,
            const PerJoint<std::int32_t>& real_zero_counts = {})
      : rack_(rack), link_(link), served_(served), real_drives_(arm, real_zero_counts) {
    // What grows by the hour looks like a leak, and in the tests of the daemon like one of the daemon's.
    stats_.answer_us.reserve(most_answers);
  }

  // Takes what is there, a bus's worst millisecond at most, and answers it. False when the link has failed: it is to be tried again a little later.
  bool receive(const Pace& pace);
  // One step of all nodes at simulated time `t`, then what they have to say. Configured faults of a real bus (error frames, bus-off) cannot be made here;
  // lost identifiers and a node off the bus can.
  void step(Time t, const JointReadings& readings);

  // What each joint of the world does next: as its served drive drives it, or after the real one.
  JointDrives drives(const JointReadings& readings) const;
  // Exposures in simulated time, of the served output node or of the real one.
  std::optional<devices::Exposure> take_exposure();
  // Of the same node, as they are now.
  Outputs outputs() const;

  const Stats& stats() const { return stats_; }
  int link_error() const { return link_error_; }  // of the last call; 0 when it was well
  // Told of every frame on the bus that this side sees, with the clock's time.
  void set_tap(std::function<void(Time, const CanFrame&)> tap) { tap_ = std::move(tap); }

 private:
  void dispatch(const CanFrame& frame, std::size_t sender, Time t);
  void collect(std::size_t slot);
  void flush(Time t);
  void set_fault(const devices::DeviceFault& fault, bool on, Time t);
  void count(const CanFrame& frame);
  bool dropped(std::uint32_t id) const;

  devices::NodeRack& rack_;
  CanLink& link_;
  NodeSet served_;
  OverheardDrives real_drives_;
  OverheardOutputs real_outputs_;
  std::vector<CanFrame> outgoing_;
  std::vector<std::uint32_t> dropped_ids_;
  std::array<int, capacity::nodes> off_bus_{};
  std::function<void(Time, const CanFrame&)> tap_;
  bool powered_ = false;
  int link_error_ = 0;
  Stats stats_;
};

}  // namespace lf::serve
