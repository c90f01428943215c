#include "firmware/arm/give.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lf::arm {
namespace {

// What guards filter (12 ms) and wait for (three SYNCs), the SYNC with the answer, and the drive's own lag.
constexpr double notices_s = 0.04;

constexpr double slowest_m_s = 0.002;  // below that a slow rise of the torque is taken for free motion's

// How far the tool goes along `way` for a radian of each joint.
JointVector levers(const Arm& arm, const JointVector& q_rad, const Vec3& way) {
  return (way.transpose() * arm.jacobian(q_rad).topRows<3>()).transpose();
}

double gives_m_n(const Arm& arm, const JointVector& q_rad, const Vec3& way) {
  const JointVector levers_m = levers(arm, q_rad, way);
  double gives_m_n = 0;
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const double lever_m = levers_m[static_cast<Eigen::Index>(i)];
    gives_m_n += lever_m * lever_m / static_cast<double>(arm.joint(i).stiffness_nm_rad);
  }
  return gives_m_n;
}

}  // namespace

double tool_stiffness_n_m(const Arm& arm, const JointVector& q_rad, const Vec3& way) { return 1 / gives_m_n(arm, q_rad, way); }

double least_felt_n(const Arm& arm, const JointVector& q_rad, const Vec3& way, const JointVector& torques_nm) {
  const JointVector levers_m = levers(arm, q_rad, way);
  double least_n = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(arm.arm_joints()); ++i)
    if (levers_m[i] != 0) least_n = std::min(least_n, torques_nm[i] / std::abs(levers_m[i]));
  return least_n;
}

double gentle_speed_m_s(const Arm& arm, const JointVector& q_rad, const JointVector& rates, const Vec3& way, const JointLimits& limits,
                        double push_n) {
  const Jacobian jacobian = arm.jacobian(q_rad);
  double brakes_s2_m = 0;  // metres at 1 m/s, and by the speed's square at another
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(limits.joints); ++i)
    brakes_s2_m += rates[i] * rates[i] / (2 * limits.acceleration_rad_s2[i]) * std::abs(jacobian.col(i).head<3>().dot(way));
  const double goes_on_m = push_n * gives_m_n(arm, q_rad, way);
  // The speed whose way until it is noticed, and then to a stop, is goes_on_m: a root in the form that no small brakes_s2_m spoils.
  const double speed_m_s = 2 * goes_on_m / (notices_s + std::sqrt(notices_s * notices_s + 4 * brakes_s2_m * goes_on_m));
  return speed_m_s > slowest_m_s ? speed_m_s : slowest_m_s;
}

}  // namespace lf::arm
