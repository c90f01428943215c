// Where on a scenario's panel the tool can work, and how squarely: over a grid, and at each target over the scenario's docking error.
#pragma once

#include <string>
#include <vector>

#include "firmware/arm/reach.hpp"
#include "host_sim/scenario/scenario.hpp"

namespace lf::app {

// How far the closed fingers reach beyond the tool point, along the tool axis.
double closed_tip_m(const arm::Arm& arm);

// The tool at a place in the panel frame: its point, or with `tip_m` the fingers' tips so far beyond it along the tool axis.
arm::Reach reach_of_tip(const arm::Arm& arm, const Pose& base_from_panel, const Vec3& panel_point_m, double tip_m,
                        const arm::JointVector& near_rad);

struct ReachGrid {
  static constexpr double step_m = 0.002;
  double height_m = 0;  // over the panel
  int columns = 0, rows = 0;
  std::vector<float> tilt_rad;  // row-major from the upper left corner; NaN where the tool cannot be

  // Of the plate's area, where the tilt is at most `limit_rad`.
  double area_m2(double limit_rad) const;
};

ReachGrid survey_grid(const scenario::Scenario& scenario, double height_m, double tip_m);

// A place that a task goes to.
struct ReachTarget {
  std::string name;
  arm::Reach nominal;
  int draws = 0, reached = 0;     // docking errors drawn by the seeds 1 to `draws`, and those at which the place is within reach
  double worst_tilt_rad = 0;      // among those reached
  double handle_clearance_m = 0;  // smallest distance of arm and handle at any handle angle; buttons only
};

std::vector<ReachTarget> survey_targets(const scenario::Scenario& scenario, int draws);

}  // namespace lf::app
