// A drive's friction from slow motions both ways over the same stretch, at two speeds: least squares.
//
// At a place the motor's torque is load x gain + way x (Coulomb + viscous |speed|); the gain is 1 / efficiency where the motor drives the load and the back
// efficiency where the load drives the motor. The load (weight, buoyancy) over the stretch is taken for a parabola. Load and friction come apart because each place
// is passed both ways; which gain holds depends on the load's sign, so a few rounds settle it. The efficiencies themselves need known loads, and are given.
// No heap: samples are kept as means over equal parts of the stretch.
#pragma once

#include <array>
#include <cstddef>

namespace lf::hal {

// In the drive's units: torques in thousandths of the rated torque, speeds in 1000 counts/s.
struct FoundFriction {
  bool valid = false;
  double coulomb = 0;
  double viscous = 0;  // per 1000 counts/s
  double rms = 0;      // of what the fit leaves of the parts' mean torques
};

class FrictionFit {
 public:
  static constexpr std::size_t passes = 4;  // there and back, slow and fast
  static constexpr std::size_t parts = 24;

  void reset() { *this = FrictionFit(); }
  // `place`: 0 to 1 along the stretch; anything else is left out. `speed` with its sign.
  void add(std::size_t pass, double place, double speed, double torque);
  // Not valid when a pass has too few places, or when what comes out is no friction: negative, or not a number.
  FoundFriction solve(double efficiency, double back_efficiency) const;

 private:
  struct Part {
    int count = 0;
    double place = 0, speed = 0, torque = 0;  // sums
  };
  std::array<std::array<Part, parts>, passes> sums_{};
};

}  // namespace lf::hal
