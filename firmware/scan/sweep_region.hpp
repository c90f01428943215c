// What the laser's stripe has to pass on its way down the panel, and how a laser stands to it, whoever carries it. Internal to the sweep's planners.
#pragma once

#include <cstddef>

#include "firmware/scan/sweep_request.hpp"
#include "shared/calibration/calibration.hpp"

namespace lf::scan {

// The groups' own drivers stop the arm within 0.05 rad of a limit.
inline constexpr double soft_margin_rad = 0.05;
// Half the speed times a ramp of 0.18 s is 6 mrad at 0.065 rad/s and 0.8 rad/s^2; twice that for coordinated motions.
inline constexpr double run_up_s = 0.012 / 0.065;
inline constexpr double fan_spare_rad = 0.005;  // the line fades at its ends

// The laser's plane; its normal points up.
struct LaserPlane {
  Vec3 origin_m, normal;
};

class SweepRegion {
 public:
  using Points = StaticVector<Vec3, 2 + PanelLayout::max_valves>;  // base frame

  // False where the request has what is not a number, or is empty.
  bool set(const SweepRequest& request, const LaserCalibration& laser);

  const SweepRequest& request() const { return request_; }
  const LaserCalibration& laser() const { return laser_; }
  const Points& above() const { return above_; }  // that the stripe has to be above of at its start
  const Points& below() const { return below_; }  // and below of at its end

  // How far all the points are on the laser plane's lower side (`side` -1: they are still to be passed) or its upper (1: they have been), at the
  // worst docking error.
  double beyond(const LaserPlane& laser, const Points& points, double side) const;
  // Panel y of the stripe above the panel's origin.
  double height_m(const LaserPlane& laser) const;
  // The stripe's ends on a panel that the docking error has brought nearer and aside are inside the fan of a laser so far aside of the panel's origin.
  bool fan_reaches(const LaserPlane& laser, double y_m, double aside_m = 0) const;

 private:
  Points points_to_pass(double border_m, double outward) const;

  SweepRequest request_;
  LaserCalibration laser_;
  Points above_, below_;
};

}  // namespace lf::scan
