#include "firmware/scan/pointed_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "shared/random.hpp"

namespace lf::scan {
namespace {

// The grid of places: distances from the nearest from which the fan covers the width, heights from below the region to above it.
constexpr int distances = 5, heights = 7;
constexpr double distance_step = 0.2, height_share = 0.75, least_height_m = 0.4;  // of the nearest distance, of the region's height
constexpr double nearest_of_any_m = 0.2;                                          // nearer the hand has no room
// From the last place's posture and from where the arm is; at random only where these lead nowhere.
constexpr int first_starts = 2, most_starts = 6;
constexpr int most_steps = 30;            // of a descent
constexpr double placed = 1e-3;           // m and rad: the laser need not stand more exactly
constexpr double longest_step_rad = 0.3;  // of a descent: farther the rates are others

constexpr int poses_a_share = 16, poses_a_sample = 6;
constexpr double least_cosine = 0.1;  // of the angle between the laser's axis and the panel's normal
// Of the joint that sweeps: steps of the search for its ends.
constexpr double end_step_rad = 0.06;
constexpr int most_end_steps = 30, bisections = 8;  // to 0.3 mrad
constexpr int way_samples = 6;

// The clearance that the arm keeps in motion, and what its way may bend nearer between two samples.
constexpr double clear_m = 0.015;

// What a sweep costs. A line too wide shows no handle; a stripe that is hidden is not seen; along the laser's plane the camera tells no depth. The rest decides between good ones.
constexpr double of_wide_lines = 100, of_hidden_share = 100, of_flat_angle = 50, of_second = 0.05, of_travel_rad = 0.3;
constexpr double steep_sine = 0.5;     // of the angle between a camera's ray and the laser plane: from here on it costs nothing
constexpr double flattest_sine = 0.1;  // below it a sweep is none: the triangulation takes no point at less than 0.1 rad
constexpr double good_cost = 1.5;      // of a sweep for which no better one is sought
constexpr double most_hidden = 0.25;   // of the stripe, over the whole way: the mark and the handles have to be among the rest
constexpr double ray_radius_m = 0.01;  // so far off a link's capsule a line of sight passes it

}  // namespace

void PointedSweepPlanner::begin(const arm::Arm& arm, const SweepRequest& request, const LaserCalibration& laser,
                                const arm::JointVector& near_rad) {
  *this = PointedSweepPlanner();
  planned_ = !region_.set(request, laser) || arm.is_planar() || !near_rad.allFinite();
  if (planned_) return;
  arm_ = &arm;
  limits_ = arm.limits(soft_margin_rad + run_up_s * request.slowest_rad_s);
  near_rad_ = near_rad.cwiseMax(limits_.lower_rad).cwiseMin(limits_.upper_rad);
  arm.set_roll(near_rad_, 0);
  const double wide_m = (request.right_m - request.left_m) / 2 + request.margin_m;
  nearest_m_ = (wide_m + request.docking_shift_m) / std::tan(std::min(1.4, laser.fan_half_angle_rad - fan_spare_rad)) +
               request.docking_shift_m + 0.5 * request.docking_turn_rad * wide_m;
  nearest_m_ = std::max(nearest_m_, nearest_of_any_m);
  random_ = 1;
  best_.outcome = SweepOutcome::top_unreachable;
}

double PointedSweepPlanner::uniform(double low, double high) {
  const double unit = static_cast<double>(splitmix64(random_) >> 11) * 0x1p-53;
  random_ += splitmix64_step;
  return low + unit * (high - low);
}

PointedSweepPlanner::Seen PointedSweepPlanner::see(const arm::JointVector& q_rad) {
  ++poses_;
  const Pose panel_from_laser = region_.request().base_from_panel.inverse() * arm_->base_from_laser(q_rad, region_.laser());
  const auto axes = panel_from_laser.linear();
  return {panel_from_laser.translation(), axes.col(1), axes.col(2)};
}

LaserPlane PointedSweepPlanner::plane_of(const arm::JointVector& q_rad) {
  ++poses_;
  const Pose base_from_laser = arm_->base_from_laser(q_rad, region_.laser());
  const Vec3 normal = base_from_laser.linear().col(0), up = region_.request().base_from_panel.linear().col(1);
  return {base_from_laser.translation(), normal.dot(up) < 0 ? Vec3(-normal) : normal};
}

bool PointedSweepPlanner::looks_at_panel(const arm::JointVector& q_rad) { return -see(q_rad).ahead.z() > least_cosine; }

// The next posture from which a place is looked for.
void PointedSweepPlanner::next_start() {
  const bool first = start_ < first_starts;
  if (start_ >= most_starts || (start_ == first_starts && solved_any_)) {
    planned_ = !next_cell();
    return;
  }
  steps_ = 0;
  work_ = Work::descend;
  q_rad_ = start_ == 0 ? solved_rad_ : near_rad_;
  const bool again = start_ == 0 && solved_rad_.isZero();
  if (!first) {
    for (std::size_t i = 0; i < arm_->pointing_joints(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      q_rad_[k] = uniform(limits_.lower_rad[k], limits_.upper_rad[k]);
    }
  }
  ++start_;
  if (again) next_start();
}

bool PointedSweepPlanner::next_cell() {
  work_ = Work::start;
  start_ = 0;
  solved_any_ = false;
  ++cell_;
  return cell_ < distances * heights && !(best_.outcome == SweepOutcome::ok && least_cost_ <= good_cost);
}

// One step toward the laser's place: its height and distance, its stripe level, its axis through the panel's middle.
void PointedSweepPlanner::descend() {
  using Rows = Eigen::Matrix<double, 5, capacity::arm_joints>;
  const SweepRequest& r = region_.request();
  const double middle_m = (r.top_m + r.bottom_m) / 2, height_m = r.top_m - r.bottom_m;
  const int row = cell_ / heights;
  const double distance_m = nearest_m_ * (1 + distance_step * row);
  const double off_m = std::max(least_height_m, height_share * height_m);
  const double y_m = middle_m + std::lerp(-off_m, off_m, static_cast<double>(cell_ % heights) / (heights - 1));
  const double sine = (middle_m - y_m) / std::hypot(middle_m - y_m, distance_m);

  const arm::LinkPoses links = arm_->base_from_links(q_rad_, 0);
  const Seen laser = see(q_rad_);
  Eigen::Matrix<double, 5, 1> missing;
  missing << y_m - laser.origin_m.y(), distance_m - laser.origin_m.z(), -laser.along.y(), -laser.along.z(), sine - laser.ahead.y();
  if (missing.cwiseAbs().maxCoeff() < placed && -laser.ahead.z() > least_cosine) {
    solved_rad_ = q_rad_;
    solved_any_ = true;
    work_ = Work::find_start;
    joint_ = 0;
    return;
  }
  if (++steps_ > most_steps) {
    work_ = Work::start;
    return;
  }
  Rows rows = Rows::Zero();
  const Pose panel_from_base = r.base_from_panel.inverse();
  for (std::size_t i = 0; i < arm_->pointing_joints(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Vec3 axis = panel_from_base.linear() * links[i].linear().col(2), at_m = panel_from_base * links[i].translation();
    const Vec3 motion = axis.cross(laser.origin_m - at_m), along = axis.cross(laser.along), ahead = axis.cross(laser.ahead);
    rows.col(k) << motion.y(), motion.z(), along.y(), along.z(), ahead.y();
  }
  Eigen::Matrix<double, 5, 5> square = rows * rows.transpose();
  square.diagonal().array() += 1e-6 + 0.05 * missing.squaredNorm();
  const arm::JointVector change = rows.transpose() * square.ldlt().solve(missing);
  const double longest_rad = change.cwiseAbs().maxCoeff();
  if (!std::isfinite(longest_rad)) {
    steps_ = most_steps;
    return;
  }
  q_rad_ += std::min(1.0, longest_step_rad / std::max(longest_rad, 1e-12)) * change;
  q_rad_ = q_rad_.cwiseMax(limits_.lower_rad).cwiseMin(limits_.upper_rad);
}

// Turns one joint until the stripe is beyond the region, as little as that takes. False where its limit comes first, or the laser looks away.
bool PointedSweepPlanner::find_end(Eigen::Index joint, double direction, double side, arm::JointVector& q_rad) {
  const SweepRegion::Points& points = side < 0 ? region_.above() : region_.below();
  const auto passed = [&](const arm::JointVector& q) { return region_.beyond(plane_of(q), points, side) >= 0; };
  arm::JointVector bad = q_rad, good = q_rad;
  int steps = 0;
  while (!passed(good)) {
    bad = good;
    good[joint] += direction * end_step_rad;
    const bool within = good[joint] >= limits_.lower_rad[joint] && good[joint] <= limits_.upper_rad[joint];
    if (!within || ++steps > most_end_steps || !looks_at_panel(good)) return false;
  }
  for (int i = 0; i < bisections; ++i) {
    const arm::JointVector middle = (bad + good) / 2;
    (passed(middle) ? good : bad) = middle;
  }
  q_rad = good;
  return true;
}

// Of five places along the stripe, those that the arm hides from the camera; and the flattest angle between a camera's ray and the laser's plane.
double PointedSweepPlanner::hidden_share(const arm::LinkCapsules& capsules, const LaserPlane& laser, double y_m, double& least_sine) const {
  constexpr int places = 5;
  const SweepRequest& r = region_.request();
  const Vec3 across = r.base_from_panel.linear().col(0), up = r.base_from_panel.linear().col(1);
  int hidden = 0;
  for (int i = 0; i < places; ++i) {
    const double x_m = std::lerp(r.left_m, r.right_m, static_cast<double>(i) / (places - 1));
    const double there_m = y_m - x_m * across.dot(laser.normal) / up.dot(laser.normal);
    const Vec3 seen_m = r.base_from_panel * Vec3(x_m, there_m, 0);
    const arm::Capsule ray{0, r.camera_m, seen_m, ray_radius_m};
    least_sine = std::min(least_sine, std::abs((seen_m - r.camera_m).normalized().dot(laser.normal)));
    hidden += std::any_of(capsules.begin(), capsules.end(), [&](const arm::Capsule& c) { return arm::clearance_between(c, ray) < 0; });
  }
  return static_cast<double>(hidden) / places;
}

// Between stripes on the region; infinite where the stripe does not go down all the way.
double PointedSweepPlanner::widest_spacing_m(double duration_s) {
  constexpr int samples = 24;
  const SweepRequest& r = region_.request();
  const auto height_at = [&](double share) { return region_.height_m(plane_of(ends_.from + share * (ends_.to - ends_.from))); };
  const double step = r.stripe_period.s() / duration_s;
  double widest_m = 0;
  for (int i = 0; i <= samples; ++i) {
    const double share = static_cast<double>(i) / samples, y_m = height_at(share), spacing_m = y_m - height_at(share + step);
    if (!(spacing_m > 0)) return HUGE_VAL;
    if (y_m <= r.top_m + r.margin_m && y_m >= r.bottom_m - r.margin_m) widest_m = std::max(widest_m, spacing_m);
  }
  return widest_m;
}

// How near the arm comes to something on its way, how much of the stripe it hides, and whether the fan is wide enough. False where the sweep is none.
bool PointedSweepPlanner::look_at_sample(const arm::Surroundings& surroundings) {
  const SweepRequest& r = region_.request();
  const arm::JointVector q = ends_.from + static_cast<double>(trial_.sample) / way_samples * (ends_.to - ends_.from);
  const double jaw_rad = surroundings.room().jaw.low_rad;
  const LaserPlane laser = plane_of(q);
  poses_ += poses_a_sample;
  if (!looks_at_panel(q)) return false;
  const arm::Distances here = surroundings.distances(q, jaw_rad);
  if (!(std::min({here.panel_m, here.vehicle_m, here.itself_m}) > clear_m)) return false;
  const double y_m = region_.height_m(laser);
  if (y_m > r.top_m + r.margin_m || y_m < r.bottom_m - r.margin_m) return true;
  const double aside_m = (r.base_from_panel.inverse() * laser.origin_m).x();
  if (!region_.fan_reaches(laser, y_m, aside_m)) {
    if (best_.outcome != SweepOutcome::ok) best_.outcome = SweepOutcome::fan_too_narrow;
    return false;
  }
  trial_.hidden += hidden_share(arm_->link_capsules(q, jaw_rad), laser, y_m, trial_.least_sine);
  ++trial_.seen;
  return true;
}

double PointedSweepPlanner::cost() const {
  const SweepRequest& r = region_.request();
  if (trial_.seen == 0 || trial_.least_sine < flattest_sine || trial_.hidden > most_hidden * trial_.seen) return HUGE_VAL;
  return of_wide_lines * std::max(0.0, trial_.widest_m / r.line_spacing_m - 1) + of_hidden_share * trial_.hidden / trial_.seen +
         of_flat_angle * std::max(0.0, steep_sine - trial_.least_sine) + of_second * trial_.duration_s +
         of_travel_rad * (ends_.from - near_rad_).cwiseAbs().maxCoeff();
}

SweepPlan PointedSweepPlanner::result() const {
  SweepPlan plan;
  plan.outcome = SweepOutcome::ok;
  for (std::size_t i = 0; i < arm_->arm_joints(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    plan.start_rad[i] = ends_.from[k];
    plan.end_rad[i] = ends_.to[k];
    plan.speed_rad_s[i] = (ends_.to[k] - ends_.from[k]) / trial_.duration_s;
  }
  plan.duration = Duration::from_s(trial_.duration_s);
  plan.widest_spacing_m = trial_.widest_m;
  return plan;
}

void PointedSweepPlanner::next_joint() {
  ++joint_;
  work_ = joint_ < static_cast<Eigen::Index>(arm_->pointing_joints()) ? Work::find_start : Work::start;
}

// Of the sweep by one joint of the posture that was found.
void PointedSweepPlanner::find_start() {
  constexpr double probe_rad = 0.01, least_m_rad = 0.05;
  arm::JointVector probe = q_rad_;
  probe[joint_] += probe_rad;
  const double lift_m_rad = (region_.height_m(plane_of(probe)) - region_.height_m(plane_of(q_rad_))) / probe_rad;
  if (!(std::abs(lift_m_rad) > least_m_rad)) return next_joint();
  up_ = lift_m_rad > 0 ? 1 : -1;
  ends_ = {q_rad_, q_rad_};
  if (!find_end(joint_, up_, -1, ends_.from)) return next_joint();
  if (best_.outcome == SweepOutcome::top_unreachable) best_.outcome = SweepOutcome::bottom_unreachable;
  work_ = Work::find_finish;
}

void PointedSweepPlanner::find_finish() {
  if (!find_end(joint_, -up_, 1, ends_.to)) return next_joint();
  if (best_.outcome == SweepOutcome::bottom_unreachable) best_.outcome = SweepOutcome::no_way;
  work_ = Work::judge;
  trial_ = Trial();
}

// A part of it at a time: how long it takes and how far apart its lines lie, then one sample of the way after the other.
void PointedSweepPlanner::judge(const arm::Surroundings& surroundings) {
  if (trial_.sample < 0) {
    const double way_rad = std::abs(ends_.to[joint_] - ends_.from[joint_]);
    trial_.duration_s = way_rad / region_.request().slowest_rad_s;
    if (!(way_rad > 0) || region_.request().slowest_rad_s > limits_.velocity_rad_s[joint_]) return next_joint();
    trial_.widest_m = widest_spacing_m(trial_.duration_s);
    if (!std::isfinite(trial_.widest_m)) return next_joint();
  } else if (!look_at_sample(surroundings)) {
    return next_joint();
  }
  if (++trial_.sample <= way_samples) return;
  const double of_this = cost();
  if (std::isfinite(of_this) && (best_.outcome != SweepOutcome::ok || of_this < least_cost_)) {
    best_ = result();
    least_cost_ = of_this;
  }
  next_joint();
}

bool PointedSweepPlanner::advance(const arm::Surroundings& surroundings) {
  for (poses_ = 0; !planned_ && poses_ < poses_a_share;) {
    switch (work_) {
      case Work::start: next_start(); break;
      case Work::descend: descend(); break;
      case Work::find_start: find_start(); break;
      case Work::find_finish: find_finish(); break;
      case Work::judge: judge(surroundings); break;
    }
  }
  return planned_;
}

}  // namespace lf::scan
