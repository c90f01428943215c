// Plans how the arm moves the laser's stripe over the panel: from above to below, all joints at constant speed between run-up and run-out.
//
// The slew holds the arm's plane along the base's x axis, facing the panel or folded back under the arm. Candidates start and end at shoulder angles of
// a grid, each with the elbow that puts the stripe just beyond the region for the whole docking error; shoulder and elbow move together in proportion. Joints
// do not move below their stiction, so a sweep lasts no longer than its joints' ways allow, and of all sweeps the one with the wanted density, or else the
// densest, is taken. For the ARM 5E that is nearly always the elbow alone, at the shoulder angle the fan's width permits: with the shoulder going along,
// its shorter way has to be over sooner.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/arm/kinematics.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::scan {

struct SweepRequest {
  Pose base_from_panel = Pose::Identity();  // nominal, or as found by an earlier scan
  double top_m = 0.222;                     // panel y from which ...
  double bottom_m = -0.378;                 // ... down to which the stripe has to pass
  double left_m = -0.400, right_m = 0.400;  // panel x
  double margin_m = 0.025;                  // beyond all four
  // The stripe falls on the panel at up to 31 degrees: what stands proud is passed at another time. Where the region reaches a valve, the circle
  // of its turning handle is covered at its own height.
  struct Handle {
    Vec2 at_m{0, 0};
    double radius_m = 0.055;
    double height_m = 0.107;
  };
  StaticVector<Handle, PanelLayout::max_valves> handles;
  double proud_m = 0.107;            // what the panel carries stands up to this high: the hand keeps beyond it
  double docking_shift_m = 0.020;    // either way along each of the base's axes: what `base_from_panel` may be wrong by
  double docking_turn_rad = 0.0349;  // either way about each of them, at the panel's origin
  double line_spacing_m = 0.0026;    // wanted between stripes
  Duration stripe_period = Duration::from_ms(40);
  double slowest_rad_s = 0.065;  // of a joint that moves: below 0.06 rad/s the arm's real joints stick (ARM 5E, UJI's drivers)
};

enum class SweepOutcome : std::uint8_t {
  ok,
  top_unreachable,     // no pose inside the soft limits puts the stripe above the region
  bottom_unreachable,  // nor below it
  fan_too_narrow,      // the stripe is shorter than the region is wide
  no_way,              // between the ends the tool comes too near to the panel, or the stripe turns back
  bad_request,         // not a number, an empty region, or an arm of another form than the planar one
};

struct SweepPlan {
  SweepOutcome outcome = SweepOutcome::bad_request;
  PerArmJoint<double> start_rad{};
  PerArmJoint<double> end_rad{};
  PerArmJoint<double> speed_rad_s{};  // signed; 0 for joints at rest, else at or above `slowest_rad_s`
  Duration duration;                  // start to end at that speed; run-up and run-out come on top
  double widest_spacing_m = 0;        // between stripes on the region at `stripe_period`
};

// Plans in shares, so that no control tick bears it all: begin(), then advance() until it is true.
// Start and end stay 0.05 rad and the run-up inside the URDF's limits. Some 300 poses of the arm, 0.1 us each on a desktop; where the whole of the
// shoulder's range is tried, up to some thousands.
class SweepPlanner {
 public:
  void begin(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser);
  // Looks at some 25 poses more, at most 120. True when plan() stands.
  bool advance();
  const SweepPlan& plan() const { return best_; }

 private:
  static constexpr std::size_t most_shoulders = 32;
  static constexpr int poses_a_share = 25;

  struct Laser {
    Vec3 origin_m, normal;
  };
  using Points = StaticVector<Vec3, 2 + PanelLayout::max_valves>;  // base frame
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
  Points points_to_pass(double border_m, double outward) const;
  Laser at(double shoulder_rad, double elbow_rad);
  double beyond(const Laser& laser, const Points& points, double side) const;
  bool look_ahead(double shoulder_rad, double& from_rad, double& to_rad);
  double elbow_for(double shoulder_rad, const Points& points, double side);
  double height_m(const Laser& laser) const;
  bool fan_reaches(const Laser& laser, double y_m) const;
  void find_ends(std::size_t i);
  bool have_ends();
  bool candidate(std::size_t from, std::size_t to, Candidate& out);
  bool better(double widest_m, double duration_s) const;
  void consider(std::size_t from, std::size_t to);
  SweepOutcome check_way(const Candidate& c, double& widest_m);
  SweepPlan result(const Candidate& c, double widest_m) const;

  const arm::Arm* arm_ = nullptr;
  SweepRequest request_;
  LaserCalibration laser_;
  arm::JointLimits limits_;
  Points above_, below_;
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

// All of it at once.
SweepPlan plan_sweep(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser);

}  // namespace lf::scan
