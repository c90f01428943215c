// Whether the volume that the arm sweeps on its way through joint space, at every opening of the jaw, keeps clear of its surroundings, a few poses at a time.
//
// Conservative advancement (Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems, 1996): a pose that is d off vouches for the next stretch of
// the way, as long as no point of the arm moves farther on it than d less the clearance wanted. So nothing slips between two poses, and far from
// everything few are needed. The jaw is swept in the same manner: half of d vouches for the jaw's next angles, the other half for the way.
#pragma once

#include <cstdint>

#include "firmware/arm/surroundings.hpp"

namespace lf::arm {

class ClearWay {
 public:
  enum class State : std::uint8_t { looking, clear, blocked };

  // Where a pose is just as far off as is wanted, the way is looked at in stretches of this, and the jaw as well: so much nearer it may come between two
  // poses.
  static constexpr double resolution_m = 0.002;
  // A way past which no arm of this size goes, at the resolution: 4 m with the jaw at rest. What takes more is blocked.
  static constexpr int max_poses = 2000;

  // Begins a way at `from_rad`, joint angles within their limits, in the room that `surroundings` is in. `wanted` is to be kept all along.
  void begin(const JointVector& from_rad, const Surroundings& surroundings, const Distances& wanted) {
    begin(from_rad, surroundings, wanted, wanted);
  }
  // A way out of a place that is too near: `at_first` is to be kept; of what the way gains it has to keep half, up to `wanted`.
  void begin(const JointVector& from_rad, const Surroundings& surroundings, const Distances& at_first, const Distances& wanted);
  // One more straight stretch, to be looked at from now on. Only once the way so far is clear, or straight after begin().
  void add(const JointVector& to_rad);

  // Looks at up to `poses` more poses; 1 us each. `surroundings` as in begin().
  State advance(const Surroundings& surroundings, int poses);

  State state() const { return state_; }
  Barrier barrier() const { return barrier_; }             // where it is blocked, or what came nearest to blocking it
  double least_slack_m() const { return least_slack_m_; }  // of the poses looked at: beyond what is wanted
  int poses() const { return poses_; }                     // looked at

 private:
  void look(const Surroundings& surroundings);
  double keep_half_of_what_is_gained();  // and returns what the pose has over that
  void move_on();

  JointVector from_rad_ = JointVector::Zero();
  JointVector way_rad_ = JointVector::Zero();
  JointVector reach_m_ = JointVector::Zero();  // how far a radian of each joint moves any point, at most
  double jaw_reach_m_ = 0;
  Distances at_first_, kept_;  // the latter by the next pose
  Distances wanted_;           // in the end
  Distances nearest_;          // of the pose at `fraction_`, over the jaw's angles so far
  double longest_m_ = 0;       // that any point of the arm moves on the whole stretch, at most
  double fraction_ = 0;        // of the next pose
  double jaw_rad_ = 0;         // of the next pose
  double budget_m_ = 0;        // how far any point may move before the next pose has to be looked at
  int poses_ = 0;
  State state_ = State::blocked;
  Barrier barrier_ = Barrier::none;
  double least_slack_m_ = 0;
};

}  // namespace lf::arm
