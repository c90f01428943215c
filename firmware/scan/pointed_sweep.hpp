// Plans the sweep of an arm that can point its tool: one joint alone turns the laser from above the panel to below it.
//
// Joints do not move below their stiction, and several would have to move in proportion: a sweep by one joint is the slowest and so the densest. Where the others
// hold the laser is tried over a grid of places before the panel, the stripe level and the laser looking at the panel's middle. Levenberg and Marquardt's method
// finds the joints for a place, from where the arm is, from the place before, and from postures drawn at random with a fixed seed. Of each posture every joint is
// tried that moves the stripe, and of all sweeps the best is taken: lines as dense as wanted, little hidden from the camera by the arm, a steep angle between camera and laser plane,
// a short way to where it begins.
#pragma once

#include <cstdint>

#include "firmware/arm/kinematics.hpp"
#include "firmware/arm/surroundings.hpp"
#include "firmware/scan/sweep_region.hpp"

namespace lf::scan {

class PointedSweepPlanner {
 public:
  // `near_rad`: where the arm is; the nearer a sweep begins the better.
  void begin(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser, const arm::JointVector& near_rad);
  // Works on for 20 us on a desktop, 60 at most. A sweep that comes too near to the surroundings is none. True when plan() stands.
  bool advance(const arm::Surroundings& surroundings);
  const SweepPlan& plan() const { return best_; }

 private:
  // The laser in the panel's frame: where it is, along which line its sheet is spread, and where it looks.
  struct Seen {
    Vec3 origin_m, along, ahead;
  };
  struct Ends {
    arm::JointVector from = arm::JointVector::Zero(), to = arm::JointVector::Zero();
  };
  // A sweep that is being judged.
  struct Trial {
    int sample = -1;  // of its way, the next to look at
    double duration_s = 0, widest_m = 0;
    double hidden = 0, least_sine = 1;
    int seen = 0;  // samples with the stripe on the region
  };
  enum class Work : std::uint8_t { start, descend, find_start, find_finish, judge };

  void next_start();
  void descend();
  void find_start();
  void find_finish();
  void judge(const arm::Surroundings& surroundings);
  bool next_cell();
  void next_joint();

  Seen see(const arm::JointVector& q_rad);
  LaserPlane plane_of(const arm::JointVector& q_rad);
  bool looks_at_panel(const arm::JointVector& q_rad);
  bool find_end(Eigen::Index joint, double direction, double side, arm::JointVector& q_rad);
  double widest_spacing_m(double duration_s);
  bool look_at_sample(const arm::Surroundings& surroundings);
  double cost() const;
  SweepPlan result() const;
  double hidden_share(const arm::LinkCapsules& capsules, const LaserPlane& laser, double y_m, double& least_sine) const;
  double uniform(double low, double high);

  const arm::Arm* arm_ = nullptr;
  SweepRegion region_;
  arm::JointLimits limits_;
  arm::JointVector near_rad_ = arm::JointVector::Zero();
  arm::JointVector solved_rad_ = arm::JointVector::Zero();  // of the last place that had a solution
  arm::JointVector q_rad_ = arm::JointVector::Zero();       // of the search under way
  double nearest_m_ = 0;                                    // of the grid's distances
  int cell_ = 0, start_ = 0, steps_ = 0;
  Eigen::Index joint_ = 0;  // that is tried, and its sweep
  Ends ends_;
  double up_ = 1;  // the way in which the joint lifts the stripe
  Trial trial_;
  Work work_ = Work::start;
  std::uint64_t random_ = 0;
  int poses_ = 0;  // of this share
  bool solved_any_ = false;
  bool planned_ = true;
  double least_cost_ = 0;
  SweepPlan best_;
};

}  // namespace lf::scan
