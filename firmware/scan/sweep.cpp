#include "firmware/scan/sweep.hpp"

namespace lf::scan {

void SweepPlanner::begin(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser,
                         const arm::JointVector& near_rad) {
  if (arm.is_planar()) return planner_.emplace<PlanarSweepPlanner>().begin(arm, request, laser);
  planner_.emplace<PointedSweepPlanner>().begin(arm, request, laser, near_rad);
}

bool SweepPlanner::advance(const arm::Surroundings& surroundings) {
  if (auto* pointed = std::get_if<PointedSweepPlanner>(&planner_)) return pointed->advance(surroundings);
  return std::get_if<PlanarSweepPlanner>(&planner_)->advance();
}

const SweepPlan& SweepPlanner::plan() const {
  if (const auto* pointed = std::get_if<PointedSweepPlanner>(&planner_)) return pointed->plan();
  return std::get_if<PlanarSweepPlanner>(&planner_)->plan();
}

SweepPlan plan_sweep(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser, const arm::JointVector& near_rad,
                     const arm::Surroundings& surroundings) {
  SweepPlanner planner;
  planner.begin(arm, request, laser, near_rad);
  while (!planner.advance(surroundings)) {
  }
  return planner.plan();
}

SweepPlan plan_sweep(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser) {
  PlanarSweepPlanner planner;
  planner.begin(arm, request, laser);
  while (!planner.advance()) {
  }
  return planner.plan();
}

}  // namespace lf::scan
