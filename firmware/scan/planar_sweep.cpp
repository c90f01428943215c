#include "firmware/scan/planar_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "firmware/arm/gripper.hpp"

namespace lf::scan {
namespace {

constexpr double no_motion_rad = 1e-6;
// The tool point to the panel's nominal plane, beyond what is proud of it and the fingers' tips: 33 mm of docking error there, 30 mm spare.
constexpr double tool_spare_m = 0.063;
// Of the shoulder angles tried: where their grid begins beyond the joint's limit, and its step, where it need not be wider to cover the range.
constexpr double grid_begins_rad = 0.05, finest_shoulder_rad = 0.10;
// Those from here on are tried first: lower ones lift the ARM 5E's stripe over no panel. All are where these give no sweep that is dense.
constexpr double first_share = 0.45;
constexpr int way_samples = 8;
// With less an elbow that can look at the panel does not look back anywhere.
constexpr double widest_elbow_rad = 2.3;

}  // namespace

LaserPlane PlanarSweepPlanner::at(double shoulder_rad, double elbow_rad) {
  ++poses_;
  const Pose base_from_laser = arm_->base_from_laser(arm::planar_joints(slew_rad_, shoulder_rad, elbow_rad, 0), region_.laser());
  return {base_from_laser.translation(), normal_up_ * base_from_laser.linear().col(0)};
}

// An elbow with a wide range turns the laser away from the panel at both its ends: draws them in to where it looks at it. False where it never does.
bool PlanarSweepPlanner::look_ahead(double shoulder_rad, double& from_rad, double& to_rad) {
  constexpr int steps = 32;
  constexpr double least_cosine = 0.1;
  const Vec3 inward = -region_.request().base_from_panel.linear().col(2);
  const double first_rad = from_rad, step_rad = (to_rad - from_rad) / steps;
  int first = -1, last = -1;
  for (int i = 0; i <= steps; ++i) {
    ++poses_;
    const arm::JointVector q = arm::planar_joints(slew_rad_, shoulder_rad, first_rad + i * step_rad, 0);
    if (arm_->base_from_laser(q, region_.laser()).linear().col(2).dot(inward) < least_cosine) {
      if (first >= 0) break;
      continue;
    }
    first = first < 0 ? i : first;
    last = i;
  }
  if (first < 0) return false;
  from_rad = first_rad + first * step_rad;
  to_rad = first_rad + last * step_rad;
  return true;
}

// The elbow that just puts the stripe beyond the points. NaN where no elbow does.
double PlanarSweepPlanner::elbow_for(double shoulder_rad, const Points& points, double side) {
  const bool at_upper = side * elbow_lifts_ < 0;
  double good = at_upper ? limits_.upper_rad[2] : limits_.lower_rad[2];
  double bad = at_upper ? limits_.lower_rad[2] : limits_.upper_rad[2];
  if (std::abs(good - bad) > widest_elbow_rad && !look_ahead(shoulder_rad, good, bad)) return std::numeric_limits<double>::quiet_NaN();
  if (!(region_.beyond(at(shoulder_rad, good), points, side) >= 0)) return std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 12; ++i) {  // to 0.5 mrad
    const double middle = 0.5 * (good + bad);
    (region_.beyond(at(shoulder_rad, middle), points, side) >= 0 ? good : bad) = middle;
  }
  return good;
}

void PlanarSweepPlanner::find_ends(std::size_t i) {
  ends_[i] = {elbow_for(shoulder(i), region_.above(), -1), elbow_for(shoulder(i), region_.below(), 1)};
}

bool PlanarSweepPlanner::have_ends() {
  const std::span<const Ends> tried = std::span(ends_).first(shoulders_);
  const bool top = std::any_of(tried.begin(), tried.end(), [](const Ends& ends) { return std::isfinite(ends.start); });
  const bool bottom = std::any_of(tried.begin(), tried.end(), [](const Ends& ends) { return std::isfinite(ends.end); });
  if (best_.outcome == SweepOutcome::top_unreachable || best_.outcome == SweepOutcome::bottom_unreachable)
    best_.outcome = !top ? SweepOutcome::top_unreachable : !bottom ? SweepOutcome::bottom_unreachable : SweepOutcome::no_way;
  return top && bottom;
}

// The longest sweep from one shoulder angle to the other in which no moving joint is below its slowest speed, but no denser than wanted.
bool PlanarSweepPlanner::candidate(std::size_t from, std::size_t to, Candidate& out) {
  const double elbow_way = std::abs(ends_[to].end - ends_[from].start), shoulder_way = std::abs(shoulder(to) - shoulder(from));
  if (!(elbow_way > no_motion_rad)) return false;
  double longest_s = elbow_way / region_.request().slowest_rad_s;
  if (shoulder_way > no_motion_rad) longest_s = std::min(longest_s, shoulder_way / region_.request().slowest_rad_s);
  const double shortest_s = std::max(elbow_way / limits_.velocity_rad_s[2], shoulder_way / limits_.velocity_rad_s[1]);
  if (longest_s < shortest_s) return false;
  const double height = region_.height_m(at(shoulder(from), ends_[from].start)) - region_.height_m(at(shoulder(to), ends_[to].end));
  out = {from, to, longest_s, height / longest_s * region_.request().stripe_period.s()};
  return height > 0;
}

// Steps along the way: the stripe goes down all the time, the fan covers the region's width, the tool stays off the panel.
SweepOutcome PlanarSweepPlanner::check_way(const Candidate& c, double& widest_m) {
  const Vec3 out_of_panel = region_.request().base_from_panel.linear().col(2);
  const double tool_distance_m =
      region_.request().proud_m + arm::tip_beyond_tool_m(arm_->jaw(), arm::jaw_from_gap(arm_->jaw(), 0)) + tool_spare_m;
  const auto shoulder_at = [&](double f) { return shoulder(c.from) + f * (shoulder(c.to) - shoulder(c.from)); };
  const auto elbow_at = [&](double f) { return ends_[c.from].start + f * (ends_[c.to].end - ends_[c.from].start); };
  widest_m = 0;
  for (int i = 0; i <= way_samples; ++i) {
    const double f = static_cast<double>(i) / way_samples;
    const double f_next = f + region_.request().stripe_period.s() / c.duration_s;
    const LaserPlane laser = at(shoulder_at(f), elbow_at(f));
    const double y_m = region_.height_m(laser);
    const double spacing_m = y_m - region_.height_m(at(shoulder_at(f_next), elbow_at(f_next)));
    if (!(spacing_m > 0)) return SweepOutcome::no_way;
    const Vec3 tool_m = arm_->base_from_tool(arm::planar_joints(slew_rad_, shoulder_at(f), elbow_at(f), 0)).translation();
    ++poses_;
    if (out_of_panel.dot(tool_m - region_.request().base_from_panel.translation()) < tool_distance_m) return SweepOutcome::no_way;
    if (y_m > region_.request().top_m + region_.request().margin_m || y_m < region_.request().bottom_m - region_.request().margin_m)
      continue;
    if (!region_.fan_reaches(laser, y_m)) return SweepOutcome::fan_too_narrow;
    widest_m = std::max(widest_m, spacing_m);
  }
  return SweepOutcome::ok;
}

SweepPlan PlanarSweepPlanner::result(const Candidate& c, double widest_m) const {
  SweepPlan plan;
  plan.outcome = SweepOutcome::ok;
  plan.start_rad = {slew_rad_, shoulder(c.from), ends_[c.from].start, 0};
  plan.end_rad = {slew_rad_, shoulder(c.to), ends_[c.to].end, 0};
  for (std::size_t i = 0; i < plan.speed_rad_s.size(); ++i) plan.speed_rad_s[i] = (plan.end_rad[i] - plan.start_rad[i]) / c.duration_s;
  plan.duration = Duration::from_s(c.duration_s);
  plan.widest_spacing_m = widest_m;
  return plan;
}

// A sweep dense enough beats one that is not; of two dense ones the shorter, of two others the denser is better.
bool PlanarSweepPlanner::better(double widest_m, double duration_s) const {
  if (best_.outcome != SweepOutcome::ok) return true;
  const bool dense = widest_m <= region_.request().line_spacing_m, best_dense = best_.widest_spacing_m <= region_.request().line_spacing_m;
  if (dense != best_dense) return dense;
  return dense ? duration_s < best_.duration.s() : widest_m < best_.widest_spacing_m;
}

void PlanarSweepPlanner::consider(std::size_t from, std::size_t to) {
  Candidate c;
  if (!std::isfinite(ends_[from].start) || !std::isfinite(ends_[to].end) || !candidate(from, to, c)) return;
  if (!better(c.mean_spacing_m, c.duration_s)) return;
  double widest_m = 0;
  const SweepOutcome outcome = check_way(c, widest_m);
  if (outcome == SweepOutcome::ok && better(widest_m, c.duration_s)) best_ = result(c, widest_m);
  if (outcome == SweepOutcome::fan_too_narrow && best_.outcome != SweepOutcome::ok) best_.outcome = outcome;
}

void PlanarSweepPlanner::begin(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser) {
  best_ = SweepPlan{};
  next_ = 0;
  planned_ = !region_.set(request, laser) || !arm.is_planar();
  if (planned_) return;
  arm_ = &arm;
  limits_ = arm.limits(soft_margin_rad + run_up_s * request.slowest_rad_s);
  facing_ = 0;
  best_.outcome = SweepOutcome::top_unreachable;  // until an end is found
  planned_ = !face();
}

void PlanarSweepPlanner::try_shoulders(double least_share) {
  const ArmModel::Joint& shoulder = arm_->joint(1);
  const double from_rad = shoulder.lower_rad + grid_begins_rad, to_rad = limits_.upper_rad[1];
  shoulder_step_rad_ = std::max(finest_shoulder_rad, (to_rad - from_rad) / (most_shoulders - 1));
  const double least_rad = std::max(limits_.lower_rad[1], std::lerp(shoulder.lower_rad, shoulder.upper_rad, least_share));
  const double skipped = std::max(0.0, std::ceil((least_rad - from_rad) / shoulder_step_rad_));
  first_shoulder_rad_ = from_rad + skipped * shoulder_step_rad_;
  shoulders_ = first_shoulder_rad_ > to_rad ? 0 : 1 + static_cast<std::size_t>((to_rad - first_shoulder_rad_) / shoulder_step_rad_);
  next_ = 0;
}

bool PlanarSweepPlanner::face() {
  for (; facing_ < 2; ++facing_) {
    const double plane_rad = facing_ == 0 ? pi : 0;  // the arm's plane, from the base's x
    slew_rad_ = wrap(plane_rad - arm_->planar().mount_yaw_rad);
    // The elbow turns about the plane's normal, -y of the base where the arm looks ahead; a laser that looks ahead, along x, is then turned down.
    elbow_lifts_ = facing_ == 0 ? 1 : -1;
    // The tool's x axis points up where the arm is folded back and the tool looks ahead, and down where the arm looks ahead.
    normal_up_ = elbow_lifts_ * std::copysign(1.0, region_.laser().tool_from_laser.linear()(0, 0));
    if (slew_rad_ < limits_.lower_rad[0] || slew_rad_ > limits_.upper_rad[0]) continue;
    whole_range_ = false;
    try_shoulders(first_share);
    if (shoulders_ > 0) return true;
  }
  return false;
}

bool PlanarSweepPlanner::search_on() {
  if (best_.outcome == SweepOutcome::ok && best_.widest_spacing_m <= region_.request().line_spacing_m) return false;
  if (!whole_range_) {
    whole_range_ = true;
    try_shoulders(0);
    return true;
  }
  ++facing_;
  return face();
}

bool PlanarSweepPlanner::advance() {
  const std::size_t pairs = shoulders_ * shoulders_;
  for (poses_ = 0; !planned_ && poses_ < poses_a_share;) {
    bool over = false;  // with this way of facing the panel
    if (next_ < shoulders_) {
      find_ends(next_);
      over = next_ + 1 == shoulders_ && !have_ends();
    } else {
      const std::size_t pair = next_ - shoulders_;
      consider(pair / shoulders_, pair % shoulders_);
      over = pair + 1 == pairs;
    }
    ++next_;
    if (over) planned_ = !search_on();
  }
  return planned_;
}

}  // namespace lf::scan
