#include "host_sim/app/observers/motion_observer.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include "firmware/arm/kinematics.hpp"
#include "host_sim/app/observers/curve_observer.hpp"
#include "host_sim/app/report_parts_of.hpp"

namespace lf::app {

void MotionObserver::on_telemetry(const Telemetry& telemetry) {
  if (ticks_++ % ticks_a_sample != 0 || world_ == nullptr) return;
  t_s_.push_back(telemetry.t.s());
  const JointReadings readings = world_->readings();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    position_rad_[i].push_back(readings[i].position_rad);
    speed_rad_s_[i].push_back(readings[i].velocity_rad_s);
  }
  // Before the drives have answered nothing is asked of them: the targets are zeros.
  const bool asked = telemetry.step != mission::Step::idle && telemetry.step != mission::Step::boot;
  arm::JointVector asked_rad = arm::JointVector::Zero();
  for (std::size_t i = 0; i < arm_.arm_joints(); ++i) asked_rad[static_cast<Eigen::Index>(i)] = telemetry.target_rad[i];
  const Vec3 tool_m = world_->base_from_tool().translation(), asked_m = arm_.base_from_tool(asked_rad).translation();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    tool_mm_[axis].push_back(1000 * tool_m[static_cast<Eigen::Index>(axis)]);
    asked_tool_mm_[axis].push_back(asked ? 1000 * asked_m[static_cast<Eigen::Index>(axis)] : record::unknown);
  }
  tool_error_mm_.push_back(asked ? 1000 * (tool_m - asked_m).norm() : record::unknown);
  valves_rad_.resize(world_->valve_count());
  for (std::size_t i = 0; i < valves_rad_.size(); ++i) valves_rad_[i].push_back(world_->valve_angle_rad(i));
  button_depth_m_.resize(world_->button_count());
  for (std::size_t i = 0; i < button_depth_m_.size(); ++i) button_depth_m_[i].push_back(world_->button(i).depth_m);
  const world::ContactReport contacts = world_->contacts();
  contact_n_.push_back(contacts.largest_force_n);
  grip_n_.push_back(contacts.grip_force_n);
}

std::vector<record::ReportChart> MotionObserver::charts() const {
  record::ReportChart speeds{"Joint speeds, truth", "rad/s", {}}, tool{"Tool's place in the base frame, truth, and asked", "mm", {}};
  for (std::size_t i = 0; i < joints_.size(); ++i) speeds.series.push_back({joints_[i], t_s_, speed_rad_s_[i], false});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    tool.series.push_back({name, t_s_, tool_mm_[axis], false});
    tool.series.push_back({name + ", asked", t_s_, asked_tool_mm_[axis], true});
  }
  record::ReportChart valves{valves_rad_.size() > 1 ? "Valves' angles, truth" : "Valve's angle, truth", "deg", {}};
  for (std::size_t i = 0; i < valves_rad_.size(); ++i) {
    std::vector<double> deg;
    std::transform(valves_rad_[i].begin(), valves_rad_[i].end(), std::back_inserter(deg), deg_from_rad);
    valves.series.push_back({names_.valves.at(i), t_s_, std::move(deg), false});
  }
  std::vector<record::ReportChart> charts{
      speeds, tool, {"Tool's distance from where it is asked to be, truth", "mm", {{"distance", t_s_, tool_error_mm_, false}}}};
  if (!valves.series.empty()) charts.push_back(std::move(valves));
  charts.push_back({"Contact force, truth", "N", {{"largest", t_s_, contact_n_, false}, {"grip on the handle", t_s_, grip_n_, false}}});
  return charts;
}

record::ReportMotion MotionObserver::motion(const world::WorldConfig& config) const {
  record::ReportMotion motion;
  motion.parts = report_parts_of(config);
  motion.t_s = t_s_;
  for (std::size_t i = 0; i < joints_.size(); ++i) motion.coordinates.push_back({joints_[i], position_rad_[i]});
  for (std::size_t i = 0; i < valves_rad_.size(); ++i) motion.coordinates.push_back({names_.valves.at(i), valves_rad_[i]});
  for (std::size_t i = 0; i < button_depth_m_.size(); ++i)
    motion.coordinates.push_back({names_.buttons.at(i) + " button", button_depth_m_[i]});
  motion.tool_part = scene::OwnBodies(config.arm.arm_joints()).hand;
  motion.tool_m = config.arm.wrist_from_tool.translation();
  motion.base_from_panel = config.base_from_panel;
  return motion;
}

}  // namespace lf::app
