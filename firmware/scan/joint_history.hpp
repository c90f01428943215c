// The arm's joints at an instant between SYNCs: a local least-squares polynomial through the newest samples.
//
// An encoder tick at the elbow is 0.37 mrad, 0.2 mm at the panel, and a stripe's points all share its error. A quadratic through the samples
// around mid-exposure (Savitzky and Golay 1964) averages it down; it takes samples from after the exposure, so stripes wait for them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/can/can_map.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/scan_messages.hpp"

namespace lf::scan {

class JointHistory {
 public:
  static constexpr std::size_t capacity = 128;    // 0.5 s of SYNCs: an image may come that late
  static constexpr std::int32_t half_window = 8;  // samples on either side

  enum class Outcome : std::uint8_t {
    done,
    wait,     // samples after the instant are still to come
    too_old,  // the instant lies before the history
    gap,      // more than 3 SYNCs without a sample about the instant
  };

  // Refused (false): a joint that is not a number, a time not after the newest one's.
  bool add(const JointSample& sample);

  // The joints at `t`. `final`: no more samples will come, those there are have to do (at least one after `t`).
  Outcome at(Time t, bool final, PerArmJoint<double>& q_rad) const;

  void clear() { size_ = 0; }

 private:
  const JointSample& sample(std::size_t age) const;  // 0 is the oldest
  void fit(std::size_t first, std::size_t last, Time t, PerArmJoint<double>& q_rad) const;

  std::array<JointSample, capacity> ring_{};
  std::size_t next_ = 0;
  std::size_t size_ = 0;
};

}  // namespace lf::scan
