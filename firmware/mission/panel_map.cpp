#include "firmware/mission/panel_map.hpp"

#include <cmath>

namespace lf::mission {

namespace {

// A full sweep gives 80,000 points on the panel, the narrow one of a second look a fifth of it. Fewer than this is no scan.
constexpr std::uint32_t min_plane_points = 2000;
// Docked, the panel does not move: two looks agree to the marker's repeatability of a millimetre. More means that the docking slipped.
constexpr double max_panel_shift_m = 0.010;

}  // namespace

StepFailure PanelMap::update(const PanelResult& result, double expected_rad) {
  if (!result.fit.valid || !(result.confidence > 0)) return StepFailure::no_panel;
  if (result.fit.points < min_plane_points) return StepFailure::too_few_points;
  const scan::ValveFrameConfig config;
  const scan::ValveFrame frame = scan::find_valve_frame(result, marker_, camera_, config);
  if (frame.outcome == scan::ValveFrameOutcome::no_plane) return StepFailure::no_panel;
  if (frame.outcome != scan::ValveFrameOutcome::ok) return StepFailure::no_marker;
  const scan::HandleObservation handle = scan::find_handle(result, frame, layout_, config);
  if (!handle.found) return StepFailure::no_handle;
  const bool moved = known_ && (frame.base_from_panel.translation() - frame_.base_from_panel.translation()).norm() > max_panel_shift_m;
  frame_ = frame;
  handle_ = handle;
  plane_ = result.fit;
  known_ = true;
  handle_rad_ = expected_rad + wrap(handle.angle_rad - expected_rad, pi / 2);
  return moved ? StepFailure::panel_moved : StepFailure::none;
}

Vec3 PanelMap::button_m(std::size_t button) const {
  const Vec2& place = layout_.buttons_m[button < PanelLayout::button_count ? button : 0];
  return frame_.base_from_panel * Vec3(place.x(), place.y(), layout_.button_height_m);
}

}  // namespace lf::mission
