#include "firmware/scan/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lf::scan {
namespace {

// The groups' own drivers stop the arm within 0.05 rad of a limit.
constexpr double soft_margin_rad = 0.05;
// Half the speed times a ramp of 0.18 s is 6 mrad at 0.065 rad/s and 0.8 rad/s^2; twice that for coordinated motions.
constexpr double run_up_s = 0.012 / 0.065;
constexpr double no_motion_rad = 1e-6;
// The tool point to the panel's nominal plane: the handle's 107 mm, 10 mm of fingers beyond the tool point, 35 mm of docking error there, 30 mm spare.
constexpr double tool_distance_m = 0.180;
constexpr double fan_spare_rad = 0.005;  // the line fades at its ends
constexpr double shoulder_first_rad = 0.75, shoulder_step_rad = 0.10;
constexpr int way_samples = 8;

bool valid(const SweepRequest& r, const LaserCalibration& laser) {
  const std::array values{r.top_m,           r.bottom_m,         r.left_m,         r.right_m,       r.margin_m,
                          r.docking_shift_m, r.docking_turn_rad, r.line_spacing_m, r.slowest_rad_s, laser.fan_half_angle_rad};
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return false;
  for (const SweepRequest::Handle& handle : r.handles) {
    if (!handle.at_m.allFinite() || !std::isfinite(handle.radius_m) || !std::isfinite(handle.height_m)) return false;
  }
  if (!r.base_from_panel.matrix().allFinite() || !laser.tool_from_laser.matrix().allFinite()) return false;
  return r.top_m > r.bottom_m && r.right_m > r.left_m && r.docking_shift_m >= 0 && r.docking_turn_rad >= 0 &&
         r.stripe_period > Duration() && r.slowest_rad_s > 0;
}

}  // namespace

double SweepPlanner::shoulder(std::size_t i) { return shoulder_first_rad + shoulder_step_rad * static_cast<double>(i); }

// Left and right border at the height of `border_m`, and the edge of each handle that the region reaches: points the stripe has to pass.
SweepPlanner::Points SweepPlanner::points_to_pass(double border_m, double outward) const {
  const SweepRequest& r = request_;
  Points points;
  const double y = border_m + outward * r.margin_m;
  (void)points.push_back(r.base_from_panel * Vec3(r.left_m - r.margin_m, y, 0));
  (void)points.push_back(r.base_from_panel * Vec3(r.right_m + r.margin_m, y, 0));
  for (const SweepRequest::Handle& handle : r.handles) {
    const double x = handle.at_m.x(), axis_y = handle.at_m.y();
    if (r.bottom_m < axis_y + handle.radius_m && r.top_m > axis_y - handle.radius_m)
      (void)points.push_back(r.base_from_panel * Vec3(x, axis_y + outward * handle.radius_m, handle.height_m));
  }
  return points;
}

SweepPlanner::Laser SweepPlanner::at(double shoulder_rad, double elbow_rad) {
  ++poses_;
  const Pose base_from_laser = arm_->base_from_laser(arm::JointVector(0, shoulder_rad, elbow_rad, 0), laser_);
  return {base_from_laser.translation(), base_from_laser.linear().col(0)};
}

// How far all the points are on the laser plane's lower side (`side` -1: they are still to be passed) or its upper (1: they have been), at the
// worst docking error: a plane's distance is linear in shift and small turn, so the worst is the sum of the worst of each.
double SweepPlanner::beyond(const Laser& laser, const Points& points, double side) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) {
    const Vec3 lever = (point - request_.base_from_panel.translation()).cross(laser.normal);
    const double doubt = request_.docking_shift_m * laser.normal.lpNorm<1>() + request_.docking_turn_rad * lever.lpNorm<1>();
    least = std::min(least, side * laser.normal.dot(point - laser.origin_m) - doubt);
  }
  return least;
}

// The elbow that just puts the stripe beyond the points: the greater the elbow, the higher the stripe. NaN where no elbow does.
double SweepPlanner::elbow_for(double shoulder_rad, const Points& points, double side) {
  double good = side < 0 ? limits_.upper_rad[2] : limits_.lower_rad[2];
  double bad = side < 0 ? limits_.lower_rad[2] : limits_.upper_rad[2];
  if (!(beyond(at(shoulder_rad, good), points, side) >= 0)) return std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 12; ++i) {  // to 0.5 mrad
    const double middle = 0.5 * (good + bad);
    (beyond(at(shoulder_rad, middle), points, side) >= 0 ? good : bad) = middle;
  }
  return good;
}

// Panel y of the stripe above the panel's origin.
double SweepPlanner::height_m(const Laser& laser) const {
  const Vec3 up = request_.base_from_panel.linear().col(1);
  return (laser.origin_m - request_.base_from_panel.translation()).dot(laser.normal) / up.dot(laser.normal);
}

// The stripe's ends on a panel that the docking error has brought nearer and aside are inside the fan.
bool SweepPlanner::fan_reaches(const Laser& laser, double y_m) const {
  const double wide_m = std::max(std::abs(request_.left_m), std::abs(request_.right_m)) + request_.margin_m;
  // Half the turn: that all of shift, turn and margin fall on one corner is not asked for.
  const double nearer_m = request_.docking_shift_m + 0.5 * request_.docking_turn_rad * wide_m;
  const Vec3 middle = request_.base_from_panel * Vec3(0, y_m, nearer_m);
  const Vec3 across = request_.base_from_panel.linear().col(0);
  const Vec3 in_plane = middle - laser.normal * laser.normal.dot(middle - laser.origin_m);
  const double ahead_m = (in_plane - laser.origin_m - across * across.dot(in_plane - laser.origin_m)).norm();
  return std::atan2(wide_m + request_.docking_shift_m, ahead_m) <= laser_.fan_half_angle_rad - fan_spare_rad;
}

void SweepPlanner::find_ends(std::size_t i) { ends_[i] = {elbow_for(shoulder(i), above_, -1), elbow_for(shoulder(i), below_, 1)}; }

bool SweepPlanner::have_ends() {
  const bool top = std::any_of(ends_.begin(), ends_.end(), [](const Ends& ends) { return std::isfinite(ends.start); });
  const bool bottom = std::any_of(ends_.begin(), ends_.end(), [](const Ends& ends) { return std::isfinite(ends.end); });
  best_.outcome = !top ? SweepOutcome::top_unreachable : !bottom ? SweepOutcome::bottom_unreachable : SweepOutcome::no_way;
  return top && bottom;
}

// The longest sweep from one shoulder angle to the other in which no moving joint is below its slowest speed, but no denser than wanted.
bool SweepPlanner::candidate(std::size_t from, std::size_t to, Candidate& out) {
  const double elbow_way = std::abs(ends_[to].end - ends_[from].start), shoulder_way = std::abs(shoulder(to) - shoulder(from));
  if (!(elbow_way > no_motion_rad)) return false;
  double longest_s = elbow_way / request_.slowest_rad_s;
  if (shoulder_way > no_motion_rad) longest_s = std::min(longest_s, shoulder_way / request_.slowest_rad_s);
  const double shortest_s = std::max(elbow_way / limits_.velocity_rad_s[2], shoulder_way / limits_.velocity_rad_s[1]);
  if (longest_s < shortest_s) return false;
  const double height = height_m(at(shoulder(from), ends_[from].start)) - height_m(at(shoulder(to), ends_[to].end));
  out = {from, to, longest_s, height / longest_s * request_.stripe_period.s()};
  return height > 0;
}

// Steps along the way: the stripe goes down all the time, the fan covers the region's width, the tool stays off the panel.
SweepOutcome SweepPlanner::check_way(const Candidate& c, double& widest_m) {
  const Vec3 out_of_panel = request_.base_from_panel.linear().col(2);
  const auto shoulder_at = [&](double f) { return shoulder(c.from) + f * (shoulder(c.to) - shoulder(c.from)); };
  const auto elbow_at = [&](double f) { return ends_[c.from].start + f * (ends_[c.to].end - ends_[c.from].start); };
  widest_m = 0;
  for (int i = 0; i <= way_samples; ++i) {
    const double f = static_cast<double>(i) / way_samples;
    const double f_next = f + request_.stripe_period.s() / c.duration_s;
    const Laser laser = at(shoulder_at(f), elbow_at(f));
    const double y_m = height_m(laser);
    const double spacing_m = y_m - height_m(at(shoulder_at(f_next), elbow_at(f_next)));
    if (!(spacing_m > 0)) return SweepOutcome::no_way;
    const Vec3 tool_m = arm_->base_from_tool(arm::JointVector(0, shoulder_at(f), elbow_at(f), 0)).translation();
    ++poses_;
    if (out_of_panel.dot(tool_m - request_.base_from_panel.translation()) < tool_distance_m) return SweepOutcome::no_way;
    if (y_m > request_.top_m + request_.margin_m || y_m < request_.bottom_m - request_.margin_m) continue;
    if (!fan_reaches(laser, y_m)) return SweepOutcome::fan_too_narrow;
    widest_m = std::max(widest_m, spacing_m);
  }
  return SweepOutcome::ok;
}

SweepPlan SweepPlanner::result(const Candidate& c, double widest_m) const {
  SweepPlan plan;
  plan.outcome = SweepOutcome::ok;
  plan.start_rad = {0, shoulder(c.from), ends_[c.from].start, 0};
  plan.end_rad = {0, shoulder(c.to), ends_[c.to].end, 0};
  for (std::size_t i = 0; i < arm_joint_count; ++i) plan.speed_rad_s[i] = (plan.end_rad[i] - plan.start_rad[i]) / c.duration_s;
  plan.duration = Duration::from_s(c.duration_s);
  plan.widest_spacing_m = widest_m;
  return plan;
}

// A sweep dense enough beats one that is not; of two dense ones the shorter, of two others the denser is better.
bool SweepPlanner::better(double widest_m, double duration_s) const {
  if (best_.outcome != SweepOutcome::ok) return true;
  const bool dense = widest_m <= request_.line_spacing_m, best_dense = best_.widest_spacing_m <= request_.line_spacing_m;
  if (dense != best_dense) return dense;
  return dense ? duration_s < best_.duration.s() : widest_m < best_.widest_spacing_m;
}

void SweepPlanner::consider(std::size_t from, std::size_t to) {
  Candidate c;
  if (!std::isfinite(ends_[from].start) || !std::isfinite(ends_[to].end) || !candidate(from, to, c)) return;
  if (!better(c.mean_spacing_m, c.duration_s)) return;
  double widest_m = 0;
  const SweepOutcome outcome = check_way(c, widest_m);
  if (outcome == SweepOutcome::ok && better(widest_m, c.duration_s)) best_ = result(c, widest_m);
  if (outcome == SweepOutcome::fan_too_narrow && best_.outcome != SweepOutcome::ok) best_.outcome = outcome;
}

void SweepPlanner::begin(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser) {
  best_ = SweepPlan{};
  next_ = 0;
  planned_ = !valid(request, laser);
  if (planned_) return;
  arm_ = &arm;
  request_ = request;
  laser_ = laser;
  limits_ = arm.limits(soft_margin_rad + run_up_s * request.slowest_rad_s);
  above_ = points_to_pass(request.top_m, 1);
  below_ = points_to_pass(request.bottom_m, -1);
}

bool SweepPlanner::advance() {
  constexpr std::size_t pairs = shoulder_steps * shoulder_steps;
  for (poses_ = 0; !planned_ && poses_ < poses_a_share; ++next_) {
    if (next_ < shoulder_steps) {
      find_ends(next_);
      if (next_ + 1 == shoulder_steps) planned_ = !have_ends();
    } else {
      const std::size_t pair = next_ - shoulder_steps;
      consider(pair / shoulder_steps, pair % shoulder_steps);
      planned_ = pair + 1 == pairs;
    }
  }
  return planned_;
}

SweepPlan plan_sweep(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser) {
  SweepPlanner planner;
  planner.begin(arm, request, laser);
  while (!planner.advance()) {
  }
  return planner.plan();
}

}  // namespace lf::scan
