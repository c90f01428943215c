// Whether a straight way through joint space keeps clear of the panel, a few poses at a time.
//
// Conservative advancement (Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems, 1996): a pose that is d off the panel vouches for the next
// stretch of the way, as long as no point of the arm moves farther on it than d less the clearance wanted. So nothing slips between two poses, and far
// from the panel few are needed.
#pragma once

#include <cstdint>

#include "firmware/arm/collision.hpp"

namespace lf::arm {

class ClearWay {
 public:
  enum class State : std::uint8_t { looking, clear, blocked };

  // Where a pose is just as far off as is wanted, the way is looked at in stretches of this: so much nearer it may come between two poses.
  static constexpr double resolution_m = 0.002;
  // A way past which no arm of this size goes, at the resolution: 4 m. What is longer is blocked.
  static constexpr int max_poses = 2000;

  // From and to are joint angles within their limits, the jaw stays at `jaw_rad`.
  void begin(const JointVector& from_rad, const JointVector& to_rad, double jaw_rad, const Pose& base_from_panel, double wanted_m);

  // Looks at up to `poses` more poses; 1 us each.
  State advance(const PanelShape& panel, int poses);

  State state() const { return state_; }
  const Clearance& nearest() const { return nearest_; }  // of the poses looked at
  int poses() const { return poses_; }                   // looked at

 private:
  JointVector from_rad_ = JointVector::Zero();
  JointVector way_rad_ = JointVector::Zero();
  double jaw_rad_ = 0;
  Pose base_from_panel_ = Pose::Identity();
  double wanted_m_ = 0;
  double longest_m_ = 0;  // that any point of the arm moves on the whole way, at most
  double fraction_ = 0;   // of the next pose
  int poses_ = 0;
  State state_ = State::blocked;
  Clearance nearest_;
};

}  // namespace lf::arm
