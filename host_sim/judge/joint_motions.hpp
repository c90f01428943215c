// Which joints move in what was seen, and which only quiver, settle or give way: a joint is not its motor, from which a gear with play parts it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/judge/verdict.hpp"

namespace lf::judge {

// Each `moment` is one of the vector's own. What it is made from has to outlive it.
class JointMotions {
 public:
  JointMotions(const std::vector<Moment>& moments, const Situation& situation, const SafetyFigures& figures)
      : moments_(moments), situation_(situation), figures_(figures) {}

  double time_s(const Moment& moment) const;
  // A motor that runs through its gear's play is faster than its joint, and it is what brakes.
  double motor_speed_rad_s(std::size_t index, std::size_t joint) const;
  // A joint whose motor stands may be pulled through its gear's play, or unwind it, as by a bar in the jaw: until `unwound_s`, and by what the gear gives. Who
  // is pushed winds it up by as much as the push.
  bool moves(const Moment& moment, std::size_t joint, double unwound_s) const;
  // The handle slips in the jaw's pads when it likes, and lets a joint without power unwind: the motor stands, and since `unwound_s` the joint has travelled no
  // farther than its gear gives.
  bool gives_way(const Moment& moment, std::size_t joint, double unwound_s) const;
  // One of the joints, a bit each, is faster than what stands, and does not only quiver.
  bool swings(const Moment& moment, JointBits joints) const;
  // From a moment to the last one, by more than a joint that stands.
  bool travels(std::size_t from) const;

 private:
  // By more than what stands, in so many milliseconds to either side of it.
  bool travels_in(const Moment& moment, std::ptrdiff_t around_ms, const PerJoint<float> Moment::*rad, std::size_t joint) const;
  bool motor_moves(const Moment& moment, std::size_t joint) const;
  // A screw that stands under a load settles when its drive lets go of it: at that moment, and by no more than it slips.
  bool settles_without_power(const Moment& moment, std::size_t joint) const;
  // A screw that stood when its power went, and has settled, gives way under a push: by no more than bodies quiver.
  bool pushed_without_power(const Moment& moment, std::size_t joint) const;
  bool stood_before(const Moment& moment, std::size_t joint) const;
  // By the obstacle: it is there, and the arm touches it.
  bool pushed_at(const Moment& moment) const;

  const std::vector<Moment>& moments_;
  const Situation& situation_;
  const SafetyFigures& figures_;
};

}  // namespace lf::judge
