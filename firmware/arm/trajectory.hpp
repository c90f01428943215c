// Joint motions: point to point, through via points, along a Cartesian line, at constant speed, and to a stop. All are planned once and sampled by time.
//
// Every motion but a stop starts and ends at rest and moves all joints in step: they start and arrive together. Speeds, accelerations and jerks stay
// within JointLimits; along a Cartesian line the jerk that the arm's curvature adds, of the order of its square of speed, is not bounded.
// Times are seconds from the motion's start: the caller subtracts two lf::Time. Before 0 a motion stands at its start, after its duration at its goal.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "firmware/arm/inverse_kinematics.hpp"
#include "firmware/arm/kinematics.hpp"
#include "firmware/arm/s_curve.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf::arm {

struct JointState {
  JointVector q_rad = JointVector::Zero();
  JointVector qd_rad_s = JointVector::Zero();
  JointVector qdd_rad_s2 = JointVector::Zero();
};

enum class PlanOutcome : std::uint8_t {
  ok,
  not_a_number,  // in the arguments, or limits that are not positive
  outside,       // an end or a via point is outside of the position limits
  too_many,      // via points
  unreachable,   // a point of the line has no solution; see LinePlan
};

// A straight line in joint space.
class JointTrajectory {
 public:
  PlanOutcome plan(const JointVector& start_rad, const JointVector& goal_rad, const JointLimits& limits);
  double duration_s() const { return curve_.duration_s(); }
  JointState sample(double t_s) const;
  const JointVector& goal_rad() const { return goal_rad_; }

 private:
  JointVector start_rad_ = JointVector::Zero(), goal_rad_ = JointVector::Zero();
  SCurve curve_;  // of the fraction of the way
};

// Straight lines in joint space through via points, at rest in each.
class JointPath {
 public:
  static constexpr std::size_t max_points = 8;  // after the start

  PlanOutcome plan(const JointVector& start_rad, std::span<const JointVector> points_rad, const JointLimits& limits);
  double duration_s() const { return duration_s_; }
  JointState sample(double t_s) const;

 private:
  StaticVector<JointTrajectory, max_points> legs_;
  double duration_s_ = 0;
};

struct LineLimits {
  double speed_m_s = 0.04;
  double acceleration_m_s2 = 0.2;
  double jerk_m_s3 = 2.0;
  // By how much harder something may be pressed that is met on the line, once it is felt, until the arm stands (give.hpp).
  double push_n = std::numeric_limits<double>::infinity();
};

struct LinePlan {
  PlanOutcome outcome = PlanOutcome::not_a_number;
  IkOutcome ik = IkOutcome::ok;  // why, when unreachable
  double fraction = 0;           // of the way to the first point without a solution, when unreachable
  double speed_m_s = 0;          // that will be reached: lower than asked for where a joint's limit, or the way's shortness, says so
};

// The tool point along a straight line, the roll from start to goal in proportion. Of an arm that can point its tool the approach axis keeps its direction; of the
// planar form it follows from the place. Checked along the whole way before it starts: every point has joint
// angles within the limits, and the speed is lowered until no joint passes its own.
class CartesianLine {
 public:
  static constexpr int checks = 64;  // points at which reach and joint rates are checked; 80 mm of way are 1.25 mm apart

  // Plans in one go. The line knows `arm` by its place. `limits` holds the joints' positions, too: draw them in for a margin.
  LinePlan plan(const Arm& arm, const JointVector& start_rad, const Vec3& goal_m, double goal_roll_rad, const LineLimits& line,
                const JointLimits& limits);

  // Plans in shares: begin(), then advance() until it is true; each of its checks takes 0.2 us on a desktop, 6 us of an arm that points. Until then the motion stands at its start.
  void begin(const Arm& arm, const JointVector& start_rad, const Vec3& goal_m, double goal_roll_rad, const LineLimits& line,
             const JointLimits& limits);
  bool advance(int checks);
  bool planned() const { return planned_; }
  const LinePlan& result() const { return result_; }
  // The joints at the last point checked that has a solution.
  const JointVector& checked_rad() const { return last_rad_; }

  double duration_s() const { return curve_.duration_s(); }
  double length_m() const { return (goal_m_ - start_m_).norm(); }
  // Times must not go backwards: an arm that points is led from the sample before. 4 us of such an arm.
  JointState sample(double t_s);
  // The tool point on the line, base frame.
  Vec3 tool_m(double t_s) const;

 private:
  bool check();
  bool finish(PlanOutcome outcome, IkOutcome ik);
  IkResult at(double fraction, double roll_rad) const;
  JointVector solved(double fraction, double roll_rad);

  const Arm* arm_ = nullptr;
  IkPosture posture_;  // kept all along
  Vec3 start_m_ = Vec3::Zero(), goal_m_ = Vec3::Zero();
  JointVector start_rad_ = JointVector::Zero();
  double goal_roll_rad_ = 0;
  Vec3 way_m_ = Vec3::Zero();
  SCurve curve_;  // of the fraction of the way
  // While it is planned:
  JointLimits limits_;
  double velocity_ = 0, acceleration_ = 0, jerk_ = 0;  // of the fraction, that all checks so far allow
  double push_n_ = 0, gentle_velocity_ = 0;            // of the fraction, at which the arm presses no harder
  int next_check_ = 0;
  bool planned_ = true;
  LinePlan result_;
  JointVector last_rad_ = JointVector::Zero();  // of the check before; and then of the sample before
};

// All joints at constant speed from `from_rad` to `to_rad` within `cruise_s`, with a run-up before and a run-out behind: for the laser's sweep,
// which must be above the joints' stiction all the way.
class ConstantSpeedSweep {
 public:
  PlanOutcome plan(const JointVector& from_rad, const JointVector& to_rad, double cruise_s, const JointLimits& limits);
  double duration_s() const { return 2 * ramp_s_ + cruise_s_; }
  double cruise_start_s() const { return ramp_s_; }  // at from_rad, at full speed
  double cruise_end_s() const { return ramp_s_ + cruise_s_; }
  JointVector start_rad() const { return sample(0).q_rad; }  // at rest, where the run-up begins
  JointState sample(double t_s) const;

 private:
  PathState fraction(double t_s) const;  // of the way: negative in the run-up, beyond 1 in the run-out

  JointVector from_rad_ = JointVector::Zero(), to_rad_ = JointVector::Zero();
  double cruise_s_ = 0, ramp_s_ = 0, jerk_time_s_ = 0;
};

// Each joint to rest as fast as its own limits allow, from wherever and however fast it moves. Joints do not wait for each other.
// Position limits cannot be kept by a stop: it ends where it ends.
class JointStop {
 public:
  JointStop() = default;
  // What is not a number in `from` is taken as rest, at its position where that is one.
  JointStop(const JointState& from, const JointLimits& limits);
  double duration_s() const;
  JointState sample(double t_s) const;

 private:
  PerArmJoint<StopCurve> joints_;
};

}  // namespace lf::arm
