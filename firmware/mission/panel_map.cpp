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
constexpr double calibration_turn_rad = 0.0026;
constexpr double marker_spin_rad = 0.0105;

// What the valve's base is asked to be known to.
constexpr double largest_shape_shift_m = 0.003;

}  // namespace

// The plane is the mean of thousands of points, and so far better known than one of them. An error that bends it shows in what neighbouring points have in common. The
// line's shape may shift the points by different amounts over the sweep. The worst is no shift at one border of what was seen and the full shift at the other: that turns the
// plane, and the more the less of the panel was seen.
arm::PanelDoubt PanelMap::doubt() const {
  constexpr double least_seen_m = 0.01;
  const double plate_m = (layout_.plate_max_m - layout_.plate_min_m).minCoeff(), shape_m = plane_.shape_shift_m;
  const double seen_m = std::clamp(plane_.seen_m, least_seen_m, plate_m), bent_m = 2 * plane_.bend_m + shape_m;
  return {calibration_shift_m + bent_m, calibration_turn_rad + bent_m / seen_m, marker_spin_rad};
}

void PanelMap::expect_handle(double rad) {
  handle_rad_ = rad;
  way_.low_rad = std::min(way_.low_rad, rad);
  way_.high_rad = std::max(way_.high_rad, rad);
}

StepFailure PanelMap::update(const PanelResult& result) {
  fit_ = {};
  if (!result.fit.valid) return StepFailure::no_panel;
  if (result.fit.points < min_plane_points) return StepFailure::too_few_points;
  const scan::ValveFrameConfig config;
  const scan::ValveFrame frame = scan::find_valve_frame(result, marker_, camera_, config);
  fit_ = fit_of(result, frame);
  const scan::HandleObservation handle = scan::find_handle(result, frame, layout_, config);
  const StepFailure failure = judge(result, frame, handle);
  if (failure != StepFailure::none) return failure;
  double angle_rad = 0;
  const StepFailure unsettled = settle(result, frame, handle, angle_rad);
  if (unsettled != StepFailure::none) return unsettled;
  frame_ = frame;
  handle_ = handle;
  plane_ = result.fit;
  known_ = true;
  handle_rad_ = angle_rad;
  way_ = {angle_rad, angle_rad};
  return StepFailure::none;
}

CalibrationFit PanelMap::fit_of(const PanelResult& result, const scan::ValveFrame& frame) const {
  CalibrationFit fit;
  fit.known = frame.marker_size_m > 0 && marker_.size_m > 0;
  if (!fit.known) return fit;
  const std::array<Vec2, 4>& corners_px = result.marker.corners_px;
  double around_px = 0;
  for (std::size_t i = 0; i < 4; ++i) around_px += (corners_px[(i + 1) % 4] - corners_px[i]).norm();
  fit.marker_size_m = static_cast<float>(marker_.size_m);
  fit.marker_side_px = static_cast<float>(around_px / 4);
  fit.marker_side_error = static_cast<float>(frame.marker_size_m / marker_.size_m - 1);
  fit.marker_corners_m = static_cast<float>(frame.marker_rms_m);
  fit.plane_bend_m = static_cast<float>(result.fit.bend_m);
  if (known_) fit.panel_shift_m = static_cast<float>((frame.base_from_panel.translation() - frame_.base_from_panel.translation()).norm());
  return fit;
}

StepFailure PanelMap::judge(const PanelResult& result, const scan::ValveFrame& frame, const scan::HandleObservation& handle) const {
  switch (frame.outcome) {
    case scan::ValveFrameOutcome::ok: break;
    case scan::ValveFrameOutcome::no_marker: return StepFailure::no_marker;
    case scan::ValveFrameOutcome::bad_marker: return StepFailure::marker_wrong;
    case scan::ValveFrameOutcome::poses_disagree: return StepFailure::marker_disagrees;
    case scan::ValveFrameOutcome::no_plane:
    case scan::ValveFrameOutcome::not_a_number: return StepFailure::no_panel;
  }
  if (result.fit.inliers < min_inlier_ratio * result.fit.points) return StepFailure::plane_unsure;
  if (!(result.fit.shape_shift_m <= largest_shape_shift_m)) return StepFailure::line_misshapen;
  // The frame of the first look is what later ones are held against: a shift does not become the truth by being seen twice.
  if (known_ && (frame.base_from_panel.translation() - frame_.base_from_panel.translation()).norm() > max_panel_shift_m)
    return StepFailure::panel_moved;
  if (!handle.found) return StepFailure::no_handle;
  if (!(handle.sigma_rad <= max_handle_sigma_rad)) return StepFailure::handle_unsure;
  return result.confidence > 0 ? StepFailure::none : StepFailure::vision_failed;
}

// Of the angles that a bar may have, half a turn apart, the one that pointer, stops or the last turn leave.
StepFailure PanelMap::settle(const PanelResult& result, const scan::ValveFrame& frame, const scan::HandleObservation& handle,
                             double& angle_rad) const {
  const PointerObservation& pointer = result.pointer;
  const bool pointed = has_pointer() && pointer.seen && pointer.confidence >= min_pointer_confidence && pointer.direction.allFinite();
  const Vec3 mark = frame.base_from_panel.linear().transpose() * pointer.direction;
  const double marked_rad = std::atan2(-mark.x(), mark.y());
  Range where{layout_.handle_min_rad - stop_margin_rad, layout_.handle_max_rad + stop_margin_rad};
  if (!has_pointer() && known_) {
    where.low_rad = std::max(where.low_rad, way_.low_rad - way_margin_rad);
    where.high_rad = std::min(where.high_rad, way_.high_rad + way_margin_rad);
  }
  int possible = 0;
  constexpr int half_turns = 3;  // angles and stops lie within half a turn to either side of 0
  for (int i = -half_turns; i <= half_turns; ++i) {
    const double candidate_rad = handle.angle_rad + i * pi;
    const bool inside = candidate_rad >= where.low_rad && candidate_rad <= where.high_rad;
    const bool as_marked = !pointed || std::abs(wrap(candidate_rad - marked_rad)) < pi / 2;
    if (!inside || !as_marked) continue;
    angle_rad = candidate_rad;
    ++possible;
  }
  if (possible == 1) return StepFailure::none;
  if (possible == 0) return StepFailure::beyond_stops;
  return has_pointer() ? StepFailure::pointer_unsure : StepFailure::half_turn_open;
}

Vec3 PanelMap::button_m(std::size_t button) const {
  const Vec2& place = layout_.buttons_m[button < PanelLayout::button_count ? button : 0];
  return frame_.base_from_panel * Vec3(place.x(), place.y(), layout_.button_height_m);
}

}  // namespace lf::mission
