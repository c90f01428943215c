#include "host_sim/app/reach_survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/arm/collision.hpp"
#include "firmware/arm/gripper.hpp"
#include "hal/config/park_pose.hpp"
#include "host_sim/scenario/instance.hpp"

namespace lf::app {

namespace {

// Everything of the panel but its handles and their stems: a pressing tool touches the rest on purpose.
arm::PanelParts all_but_handles(const PanelLayout& layout) {
  arm::PanelParts parts = arm::bit(arm::PanelPart::plate());
  for (std::size_t i = 0; i < layout.markers.size(); ++i)
    parts |= arm::bit({arm::PanelPart::Kind::marker_plate, static_cast<std::uint8_t>(i)});
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) parts |= arm::bit(arm::PanelPart::button(i));
  return parts;
}

ReachTarget survey_target(const scenario::Scenario& scenario, const std::string& name, const Vec3& point_m, double tip_m, bool is_button,
                          int draws) {
  const arm::JointVector near_rad = config::as_folded(scenario.told_arm, scenario.arm.park_rad);
  ReachTarget target;
  target.name = name;
  target.nominal = reach_of_tip(scenario.told_arm, scenario.panel.nominal_base_from_panel(), point_m, tip_m, near_rad);
  target.handle_clearance_m = std::numeric_limits<double>::infinity();
  target.draws = draws;
  const arm::PanelShape shape(scenario.panel);
  for (int seed = 1; seed <= draws; ++seed) {
    const Pose base_from_panel = scenario::true_base_from_panel(scenario.panel, scenario::draw(scenario, static_cast<std::uint64_t>(seed)));
    const arm::Reach reach = reach_of_tip(scenario.told_arm, base_from_panel, point_m, tip_m, near_rad);
    if (reach.outcome != arm::IkOutcome::ok) continue;
    ++target.reached;
    target.worst_tilt_rad = std::max(target.worst_tilt_rad, reach.tilt_rad);
    if (!is_button) continue;
    const arm::Clearance clearance =
        shape.clearance(scenario.told_arm.link_capsules(reach.q_rad, arm::jaw_from_gap(scenario.told_arm.jaw(), 0)), base_from_panel,
                        all_but_handles(scenario.panel));
    target.handle_clearance_m = std::min(target.handle_clearance_m, clearance.distance_m);
  }
  return target;
}

}  // namespace

double closed_tip_m(const arm::Arm& arm) { return arm::tip_beyond_tool_m(arm.jaw(), arm::jaw_from_gap(arm.jaw(), 0)); }

arm::Reach reach_of_tip(const arm::Arm& arm, const Pose& base_from_panel, const Vec3& panel_point_m, double tip_m,
                        const arm::JointVector& near_rad) {
  if (!arm.is_planar()) return arm::reach(arm, base_from_panel, panel_point_m + Vec3(0, 0, tip_m), arm::default_limit_margin_rad, near_rad);
  arm::Reach reach = arm::reach(arm, base_from_panel, panel_point_m);
  // The approach turns by a few degrees as the point draws back by the tip's length: each round leaves a twentieth of the error.
  for (int round = 0; round < 6 && tip_m > 0 && reach.outcome == arm::IkOutcome::ok; ++round) {
    const Vec3 approach = base_from_panel.linear().transpose() * arm.approach_axis(reach.q_rad);
    reach = arm::reach(arm, base_from_panel, panel_point_m - tip_m * approach);
  }
  return reach;
}

double ReachGrid::area_m2(double limit_rad) const {
  const auto within = std::count_if(tilt_rad.begin(), tilt_rad.end(), [limit_rad](float tilt) { return double(tilt) <= limit_rad; });
  return static_cast<double>(within) * step_m * step_m;
}

ReachGrid survey_grid(const scenario::Scenario& scenario, double height_m, double tip_m) {
  const PanelLayout& layout = scenario.panel;
  const arm::JointVector near_rad = config::as_folded(scenario.told_arm, scenario.arm.park_rad);
  ReachGrid grid;
  grid.height_m = height_m;
  const Vec2 size = layout.plate_max_m - layout.plate_min_m;
  grid.columns = static_cast<int>(std::lround(size.x() / ReachGrid::step_m));
  grid.rows = static_cast<int>(std::lround(size.y() / ReachGrid::step_m));
  const Pose base_from_panel = layout.nominal_base_from_panel();
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Vec3 point(layout.plate_min_m.x() + (column + 0.5) * ReachGrid::step_m,
                       layout.plate_max_m.y() - (row + 0.5) * ReachGrid::step_m, height_m);
      const arm::Reach reach = reach_of_tip(scenario.told_arm, base_from_panel, point, tip_m, near_rad);
      grid.tilt_rad.push_back(reach.outcome == arm::IkOutcome::ok ? static_cast<float>(reach.tilt_rad)
                                                                  : std::numeric_limits<float>::quiet_NaN());
    }
  }
  return grid;
}

std::vector<ReachTarget> survey_targets(const scenario::Scenario& scenario, int draws) {
  const PanelLayout& panel = scenario.panel;
  const double tip_m = closed_tip_m(scenario.told_arm);
  const PanelNames& names = scenario.survey.names;
  std::vector<ReachTarget> targets;
  for (std::size_t i = 0; i < panel.valves.size(); ++i)
    targets.push_back(survey_target(scenario, names.valves.at(i), panel.valves[i].handle_centre_m(), 0, false, draws));
  for (std::size_t i = 0; i < panel.buttons.size(); ++i)
    targets.push_back(survey_target(scenario, names.buttons.at(i) + " button", panel.buttons[i].face_m(), tip_m, true, draws));
  return targets;
}

}  // namespace lf::app
