// Plans how the arm moves the laser's stripe over the panel, from above to below, for arms of every form that jobs are planned for.
#pragma once

#include <variant>

#include "firmware/scan/planar_sweep.hpp"
#include "firmware/scan/pointed_sweep.hpp"

namespace lf::scan {

// Plans in shares, so that no control tick bears it all: begin(), then advance() until it is true.
class SweepPlanner {
 public:
  // `near_rad`: where the arm is; the planner of the planar form does not ask.
  void begin(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser, const arm::JointVector& near_rad);
  // True when plan() stands. `surroundings`: what an arm that points keeps clear of on the sweep; the planar form keeps its tool off the panel's plane.
  bool advance(const arm::Surroundings& surroundings);
  const SweepPlan& plan() const;

 private:
  std::variant<PlanarSweepPlanner, PointedSweepPlanner> planner_;
};

// All of it at once.
SweepPlan plan_sweep(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser, const arm::JointVector& near_rad,
                     const arm::Surroundings& surroundings);
// The same of an arm of the planar form, which asks for neither. A bad request of any other.
SweepPlan plan_sweep(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser);

}  // namespace lf::scan
