// The watch over everything measured: each tick it holds the drives' answers against the limits and names the faults that began.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/canopen/network.hpp"
#include "firmware/safety/faults.hpp"
#include "firmware/safety/joint_observer.hpp"
#include "firmware/safety/limits.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"

namespace lf::safety {

// The joints as the drives report them.
struct JointStates {
  std::array<double, joint_count> position_rad{};
  std::array<double, joint_count> velocity_rad_s{};  // observed
  std::array<double, joint_count> torque_nm{};
  std::array<bool, joint_count> fresh{};
  Time t;              // of the SYNC they belong to
  bool valid = false;  // all five are fresh
};

struct FaultReport {
  Fault fault = Fault::count;
  std::int32_t code = 0;  // joint or node index; 1000 + EMCY code where there is one
};
using FaultReports = StaticVector<FaultReport, 32>;

class Watch {
 public:
  explicit Watch(const Limits& limits) : limits_(limits) {}

  // Reads the joints; call once a tick after the frames came in. `rad` are the positions decoded from counts.
  void observe(const canopen::Network& network, const std::array<double, joint_count>& rad, Time now);
  const JointStates& joints() const { return joints_; }

  // Faults that began in this tick: each is reported once, and again only after it went away.
  // `armed`: the drives are booted and powered; before, only the links are watched by the boot itself.
  // `tool_m`: the tool point in the base frame.
  void check(const canopen::Network& network, const Vec3& tool_m, bool armed, Time now, FaultReports& began);

  // Beyond its limits by more than noise.
  bool outside(std::size_t joint) const;
  bool any_outside() const;
  // From now on a joint may stand as far outside as it does now, and then as far as it has come back since, but no farther: an operator brings it back.
  // `false`: the limits are the limits again.
  void bear_outside(bool bear);

 private:
  double excursion_rad(std::size_t joint) const;
  void raise(bool present, Fault fault, std::int32_t code, FaultReports& began);

  Limits limits_;
  std::array<JointObserver, joint_count> observers_;
  bool observing_ = false;
  JointStates joints_;
  std::array<int, joint_count> overload_ticks_{};
  std::array<double, joint_count> borne_rad_{};  // outside of the limits
  // Which (fault, code) pairs are present: the code's low bits are an index below 8.
  std::array<std::uint8_t, fault_count> present_{};
};

}  // namespace lf::safety
