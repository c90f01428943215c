#include "firmware/arm/transmission.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lf::arm {
namespace {

// Of a motor that turns forward: the joint's torque that is in balance with the motor's torque less friction.
double load_nm(double ratio, double efficiency, double back_efficiency, double net_nm) {
  if (net_nm >= 0) return ratio * efficiency * net_nm;
  return back_efficiency > 0 ? std::max(ratio / back_efficiency * net_nm, -Transmission::breaking_nm) : -Transmission::breaking_nm;
}

struct Bounds {
  double low_nm, high_nm;
};

// The same with everything that is not known for sure: `net_nm` within `doubt_nm`, the efficiencies within their doubts.
Bounds load_bounds(double ratio, const Friction& friction, double net_nm, double doubt_nm) {
  const double better = 1 + friction.efficiency_doubt, worse = std::max(0.0, 1 - friction.efficiency_doubt);
  const double low = net_nm - doubt_nm, high = net_nm + doubt_nm;
  const double low_nm = load_nm(ratio, friction.efficiency * worse, friction.back_efficiency * worse, low);
  // A screw that locks itself turns against no load and with any load at the same torque: the load is bounded above only.
  const double high_nm = load_nm(ratio, std::min(1.0, friction.efficiency * better),
                                 friction.back_efficiency > 0 ? std::min(1.0, friction.back_efficiency * better) : HUGE_VAL, high);
  return {low_nm, high_nm};
}

}  // namespace

double Transmission::ratio(double q_rad) const { return 2 * std::numbers::pi / (setup_.counts_per_rev * rad_per_count(joint_, q_rad)); }

double Transmission::motor_torque_nm(double q_rad, double speed_rad_s, double joint_nm) const {
  const double n = ratio(q_rad);
  if (speed_rad_s == 0) return joint_nm / n;
  const Friction& friction = setup_.friction;
  const double way = std::copysign(1.0, speed_rad_s);
  const bool drives = joint_nm * way >= 0;
  const double share = drives ? 1 / friction.efficiency : std::max(0.0, friction.back_efficiency);
  return joint_nm / n * share + way * friction.coulomb_nm + friction.viscous_nm_s * n * speed_rad_s;
}

TorqueEstimate Transmission::joint_torque(double q_rad, double speed_rad_s, int direction, bool standing, double motor_nm,
                                          double motor_doubt_nm) const {
  const Friction& friction = setup_.friction;
  const double n = ratio(q_rad);
  const double viscous_nm = friction.viscous_nm_s * n * speed_rad_s;
  const double rubbing_nm = friction.coulomb_nm + std::abs(viscous_nm);
  const double doubt_nm = motor_doubt_nm + friction.doubt * rubbing_nm;
  const auto moving = [&](int way) {
    const double net_nm = way * (motor_nm - viscous_nm) - friction.coulomb_nm;
    const double back = friction.back_efficiency > 0 ? friction.back_efficiency : HUGE_VAL;
    const double nm = way * load_nm(n, friction.efficiency, back, net_nm);
    const Bounds bounds = load_bounds(n, friction, net_nm, doubt_nm);
    return way > 0 ? TorqueEstimate{nm, bounds.low_nm, bounds.high_nm} : TorqueEstimate{nm, -bounds.high_nm, -bounds.low_nm};
  };
  if (!standing && direction != 0) return moving(direction);
  const TorqueEstimate forward = moving(1), backward = moving(-1);
  TorqueEstimate estimate = direction > 0 ? forward : direction < 0 ? backward : TorqueEstimate{n * motor_nm, 0, 0};
  estimate.low_nm = forward.low_nm;     // less, and the motor would raise it
  estimate.high_nm = backward.high_nm;  // more, and it would push the motor back
  return estimate;
}

TorqueEstimate TorqueObserver::update(const Transmission& transmission, double rad_per_count, double q_rad, double speed_rad_s,
                                      double motor_nm, double motor_doubt_nm) {
  const bool standing = std::abs(speed_rad_s) < standing_counts_s * rad_per_count;
  if (!standing) direction_ = speed_rad_s > 0 ? 1 : -1;
  return transmission.joint_torque(q_rad, speed_rad_s, direction_, standing, motor_nm, motor_doubt_nm);
}

}  // namespace lf::arm
