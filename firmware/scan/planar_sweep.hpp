// Plans the sweep of an arm of the planar form: from above to below, all joints at constant speed between run-up and run-out.
//
// The slew holds the arm's plane along the base's x axis, facing the panel or folded back under the arm. Candidates start and end at shoulder angles of
// a grid, each with the elbow that puts the stripe just beyond the region for the whole docking error; shoulder and elbow move together in proportion. Joints
// do not move below their stiction, so a sweep lasts no longer than its joints' ways allow, and of all sweeps the one with the wanted density, or else the
// densest, is taken. For the ARM 5E that is nearly always the elbow alone, at the shoulder angle the fan's width permits: with the shoulder going along,
// its shorter way has to be over sooner.
#pragma once

#include <array>

#include "firmware/arm/kinematics.hpp"
#include "firmware/scan/sweep_region.hpp"

namespace lf::scan {

// Plans in shares, so that no control tick bears it all: begin(), then advance() until it is true.
// Start and end stay 0.05 rad and the run-up inside the URDF's limits. Some 300 poses of the arm, 0.1 us each on a desktop; where the whole of the
// shoulder's range is tried, up to some thousands.
class PlanarSweepPlanner {
 public:
  void begin(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser);
  // Looks at some 25 poses more, at most 120. True when plan() stands.
  bool advance();
  const SweepPlan& plan() const { return best_; }

 private:
  static constexpr std::size_t most_shoulders = 32;
  static constexpr int poses_a_share = 25;

  using Points = SweepRegion::Points;
  struct Ends {
    double start = 0, end = 0;  // the elbow at the start and the end for a shoulder angle; NaN where there is none
  };
  struct Candidate {
    std::size_t from = 0, to = 0;
    double duration_s = 0;
    double mean_spacing_m = 0;
  };

  // The next shoulder angles to try; false when the search is over.
  bool search_on();
  bool face();
  void try_shoulders(double least_share);
  double shoulder(std::size_t i) const { return first_shoulder_rad_ + shoulder_step_rad_ * static_cast<double>(i); }
  LaserPlane at(double shoulder_rad, double elbow_rad);
  bool look_ahead(double shoulder_rad, double& from_rad, double& to_rad);
  double elbow_for(double shoulder_rad, const Points& points, double side);
  void find_ends(std::size_t i);
  bool have_ends();
  bool candidate(std::size_t from, std::size_t to, Candidate& out);
  bool better(double widest_m, double duration_s) const;
  void consider(std::size_t from, std::size_t to);
  SweepOutcome check_way(const Candidate& c, double& widest_m);
  SweepPlan result(const Candidate& c, double widest_m) const;

  const arm::Arm* arm_ = nullptr;
  SweepRegion region_;
  arm::JointLimits limits_;
  int facing_ = 0;  // of two: folded back, then ahead
  bool whole_range_ = false;
  double slew_rad_ = 0;     // and the slew that it takes
  double elbow_lifts_ = 1;  // 1: the greater the elbow, the higher the stripe; -1: the other way round
  double normal_up_ = 1;    // times the laser's x: the plane's normal that points up where the laser looks ahead
  double first_shoulder_rad_ = 0, shoulder_step_rad_ = 0;
  std::size_t shoulders_ = 0;
  std::array<Ends, most_shoulders> ends_{};
  std::size_t next_ = 0;  // shoulder angles first, then pairs of them
  int poses_ = 0;         // of this share
  bool planned_ = true;
  SweepPlan best_;
};

}  // namespace lf::scan
