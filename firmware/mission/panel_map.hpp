// What the mission knows of the panel: where its frame is, how the handle stands, and from these every point the tool has to go to.
#pragma once

#include "firmware/mission/mission_config.hpp"
#include "firmware/scan/valve_frame.hpp"
#include "firmware/telemetry.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/panel_vision.hpp"

namespace lf::mission {

class PanelMap {
 public:
  PanelMap(const PanelLayout& layout, const MarkerCalibration& marker, const CameraCalibration& camera)
      : layout_(layout), marker_(marker), camera_(camera) {}

  // Takes an answer of panel vision. On a failure what was known before stays.
  // `expected_rad` settles which way round the bar is: a bar looks the same after half a turn.
  StepFailure update(const PanelResult& result, double expected_rad);

  bool known() const { return known_; }
  const Pose& base_from_panel() const { return frame_.base_from_panel; }
  double handle_rad() const { return handle_rad_; }
  void expect_handle(double rad) { handle_rad_ = rad; }  // after a turn, until the next look
  const scan::ValveFrame& frame() const { return frame_; }
  const scan::HandleObservation& handle() const { return handle_; }
  const PlaneFit& plane() const { return plane_; }

  Vec3 normal() const { return frame_.base_from_panel.linear().col(2); }  // base frame, toward the robot
  Vec3 handle_centre_m() const { return frame_.base_from_panel * Vec3(0, 0, layout_.handle_height_m); }
  // Centre of a button's face at rest.
  Vec3 button_m(std::size_t button) const;
  // Direction of the bar at an angle, unit, base frame.
  Vec3 bar(double handle_rad) const { return frame_.base_from_panel.linear() * Vec3(-std::sin(handle_rad), std::cos(handle_rad), 0); }

 private:
  PanelLayout layout_;
  MarkerCalibration marker_;
  CameraCalibration camera_;
  bool known_ = false;
  scan::ValveFrame frame_;
  scan::HandleObservation handle_;
  PlaneFit plane_;
  double handle_rad_ = 0;
};

}  // namespace lf::mission
