#include "firmware/mission/panel_map.hpp"

#include <algorithm>
#include <cmath>

namespace lf::mission {

namespace {

// A full sweep gives 80,000 points on the panel, the narrow one of a second look a fifth of it. Fewer than this is no scan.
constexpr std::uint32_t min_plane_points = 2000;
// Of the points, on the plane. Handle, buttons and marker plate cover a tenth of the panel; in a second look the handle has a third of the points.
constexpr double min_inlier_ratio = 0.4;
// Docked, the panel does not move: two looks agree to the marker's repeatability of a millimetre. More means that the docking slipped.
constexpr double max_panel_shift_m = 0.010;
// The sigma of find_handle() is cautious: at 100 points it is 1.5 degrees, where angles err by 0.6 at the 95th percentile. The second look accepts two
// degrees as turned and must know the angle to one: 40 points on a bar of the default size.
constexpr double max_handle_sigma_rad = 0.042;
// Half the sum of two readings' evidence: both together, or a single one without doubt.
constexpr float min_pointer_confidence = 0.3f;
// A handle at its stop may be seen so far beyond it: thrice the look's error of 0.6 degrees and the marker's own turn.
constexpr double stop_margin_rad = 0.052;
// After a turn the handle may be seen so far off its way: a detent pulls it, and a look errs.
constexpr double way_margin_rad = 0.2;

// Of the panel's frame as it is found, along or about any one axis. The worst of 64 looks were 1.9 mm, 0.14 degrees of tilt, and 0.4 degrees about the normal, of which
// half as much again is taken: neither bend nor shape comes on top of that one.
constexpr double calibration_shift_m = 0.0021;
// Those looks were the default machine's: up to 1.25 m of depth a radian (1.10 to 1.21 in six), and camera, laser and three joints that carry it.
constexpr double calibration_depth_m_per_rad = 1.25, calibration_parts = 5;
constexpr double calibration_turn_rad = 0.0026;
constexpr double marker_spin_rad = 0.0105;

// What the valve's base is asked to be known to.
constexpr double largest_shape_shift_m = 0.003;

}  // namespace

// The plane is the mean of thousands of points, and so far better known than one of them. An error that bends it shows in what neighbouring points have in common. The
// line's shape may shift the points by different amounts over the sweep. The worst is no shift at one border of what was seen and the full shift at the other: that turns the
// plane, and the more the less of the panel was seen.
arm::PanelDoubt PanelMap::doubt_where_touched() const {
  constexpr double least_seen_m = 0.01;
  const double plate_m = (layout_->plate_max_m - layout_->plate_min_m).minCoeff(), shape_m = plane_.shape_shift_m;
  const double seen_m = std::clamp(plane_.seen_m, least_seen_m, plate_m), bent_m = 2 * plane_.bend_m + shape_m;
  return {calibration_shift_m + bent_m + marker_spin_rad * markers_beyond_m_, calibration_turn_rad + bent_m / seen_m, marker_spin_rad};
}

arm::PanelDoubt PanelMap::doubt() const {
  arm::PanelDoubt doubt = doubt_where_touched();
  doubt.shift_m += deeper_m();
  return doubt;
}

double PanelMap::deeper_m() const { return (farther() - 1) * calibration_shift_m; }

// What camera, laser and joints are turned by against their calibration moves the plane by the more, the farther it is and the flatter they see it. At worst all of them
// err the same way.
double PanelMap::farther() const {
  return std::max(1.0, plane_.depth_m_per_rad * calibrated_parts_ / (calibration_depth_m_per_rad * calibration_parts));
}

// By the farthest, since it may be the only one that is seen. The docked mission's stands 185 mm from its valve.
double PanelMap::markers_beyond_m(const MarkerCalibrations& markers) {
  constexpr double measured_m = 0.185;
  double farthest_m = measured_m;
  for (const MarkerCalibration& marker : markers) farthest_m = std::max(farthest_m, marker.panel_from_tag.translation().head<2>().norm());
  return farthest_m - measured_m;
}

void PanelMap::expect_handle(std::size_t valve, double rad) {
  Handle& handle = handles_[valve];
  handle.angle_rad = rad;
  handle.way_rad.low = std::min(handle.way_rad.low, rad);
  handle.way_rad.high = std::max(handle.way_rad.high, rad);
}

StepFailure PanelMap::update(const PanelResult& result, Valves wanted) {
  fit_ = {};
  if (!result.fit.valid) return StepFailure::no_panel;
  if (result.fit.points < min_plane_points) return StepFailure::too_few_points;
  const scan::PanelFrame frame = scan::find_panel_frame(result, *markers_, *camera_, scan::PanelFrameConfig{});
  fit_ = fit_of(result, frame);
  const StepFailure failure = judge(result, frame);
  if (failure != StepFailure::none) return failure;
  Handles handles = handles_;
  // Where no valve is wanted one has to be at its place all the same: a marker at a wrong place would lead to the wrong button.
  const bool any_will_do = wanted == 0;
  bool found = false;
  StepFailure missed = StepFailure::none;
  for (std::size_t i = 0; i < layout_->valves.size(); ++i) {
    if (!any_will_do && (wanted & bit(i)) == 0) continue;
    if (!found && missed == StepFailure::none) told_valve_ = i;
    Handle handle = handles[i];
    const StepFailure unseen = look_at(i, result, frame, handle);
    if (unseen == StepFailure::none) {
      handles[i] = handle;
      found = true;
    } else if (missed == StepFailure::none) {
      missed = unseen;
      told_valve_ = i;
    }
  }
  if (missed != StepFailure::none && !(any_will_do && found)) return missed;
  if (!(result.confidence > 0)) return StepFailure::vision_failed;
  if (!known_) first_m_ = frame.base_from_panel.translation();
  frame_ = frame;
  handles_ = handles;
  plane_ = result.fit;
  known_ = true;
  return StepFailure::none;
}

CalibrationFit PanelMap::fit_of(const PanelResult& result, const scan::PanelFrame& frame) const {
  CalibrationFit fit;
  fit.known = frame.marker_size_m > 0 && frame.surveyed_size_m > 0;
  if (!fit.known) return fit;
  const std::array<Vec2, 4>& corners_px = result.markers[frame.marker].corners_px;
  double around_px = 0;
  for (std::size_t i = 0; i < 4; ++i) around_px += (corners_px[(i + 1) % 4] - corners_px[i]).norm();
  fit.marker_size_m = static_cast<float>(frame.surveyed_size_m);
  fit.marker_side_px = static_cast<float>(around_px / 4);
  fit.marker_side_error = static_cast<float>(frame.marker_size_m / frame.surveyed_size_m - 1);
  fit.marker_corners_m = static_cast<float>(frame.marker_rms_m);
  fit.plane_bend_m = static_cast<float>(result.fit.bend_m);
  if (known_) fit.panel_shift_m = static_cast<float>((frame.base_from_panel.translation() - frame_.base_from_panel.translation()).norm());
  return fit;
}

StepFailure PanelMap::judge(const PanelResult& result, const scan::PanelFrame& frame) const {
  switch (frame.outcome) {
    case scan::PanelFrameOutcome::ok: break;
    case scan::PanelFrameOutcome::no_marker: return StepFailure::no_marker;
    case scan::PanelFrameOutcome::bad_marker: return StepFailure::marker_wrong;
    case scan::PanelFrameOutcome::poses_disagree: return StepFailure::marker_disagrees;
    case scan::PanelFrameOutcome::no_plane:
    case scan::PanelFrameOutcome::not_a_number: return StepFailure::no_panel;
  }
  if (result.fit.inliers < min_inlier_ratio * result.fit.points) return StepFailure::plane_unsure;
  if (!(result.fit.shape_shift_m <= largest_shape_shift_m)) return StepFailure::line_misshapen;
  // The frame of the first look is what later ones are held against: a shift does not become the truth by being seen twice.
  if (known_ && (frame.base_from_panel.translation() - first_m_).norm() > max_panel_shift_m) return StepFailure::panel_moved;
  return StepFailure::none;
}

StepFailure PanelMap::look_at(std::size_t valve, const PanelResult& result, const scan::PanelFrame& frame, Handle& handle) const {
  handle.seen = scan::find_handle(result, frame, layout_->valves[valve], scan::PanelFrameConfig{});
  if (!handle.seen.found) return StepFailure::no_handle;
  if (!(handle.seen.sigma_rad <= max_handle_sigma_rad)) return StepFailure::handle_unsure;
  if (!(result.confidence > 0)) return StepFailure::vision_failed;
  return settle(valve, result, frame, handle);
}

// Of the angles that a bar may have, half a turn apart, the one that pointer, stops or the last turn leave.
StepFailure PanelMap::settle(std::size_t valve, const PanelResult& result, const scan::PanelFrame& frame, Handle& handle) const {
  const PanelLayout::Valve& layout = layout_->valves[valve];
  const PointerObservation pointer = result.pointer(valve);
  const bool pointed =
      layout.has_pointer() && pointer.seen && pointer.confidence >= min_pointer_confidence && pointer.direction.allFinite();
  const Vec3 mark = frame.base_from_panel.linear().transpose() * pointer.direction;
  const double marked_rad = std::atan2(-mark.x(), mark.y());
  Range where{layout.handle_min_rad - stop_margin_rad, layout.handle_max_rad + stop_margin_rad};
  if (!layout.has_pointer() && handles_[valve].seen.found) {
    where.low = std::max(where.low, handle.way_rad.low - way_margin_rad);
    where.high = std::min(where.high, handle.way_rad.high + way_margin_rad);
  }
  int possible = 0;
  constexpr int half_turns = 3;  // angles and stops lie within half a turn to either side of 0
  for (int i = -half_turns; i <= half_turns; ++i) {
    const double candidate_rad = handle.seen.angle_rad + i * pi;
    const bool inside = candidate_rad >= where.low && candidate_rad <= where.high;
    const bool as_marked = !pointed || std::abs(wrap(candidate_rad - marked_rad)) < pi / 2;
    if (!inside || !as_marked) continue;
    handle.angle_rad = candidate_rad;
    ++possible;
  }
  if (possible == 1) {
    handle.way_rad = {handle.angle_rad, handle.angle_rad};
    return StepFailure::none;
  }
  if (possible == 0) return StepFailure::beyond_stops;
  return layout.has_pointer() ? StepFailure::pointer_unsure : StepFailure::half_turn_open;
}

}  // namespace lf::mission
