// What the mission knows of the panel: where its frame is, how the handle stands, and from these every point the tool has to go to.
#pragma once

#include "firmware/mission/calibration_fit.hpp"
#include "firmware/mission/mission_config.hpp"
#include "firmware/mission/step_failure.hpp"
#include "firmware/scan/valve_frame.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/panel_vision.hpp"

namespace lf::mission {

class PanelMap {
 public:
  // Without a pointer mark a longer turn would leave open which of two angles half a turn apart the handle has come to: half a turn less what a look and
  // a detent's pull add at both ends of the way.
  static constexpr double longest_blind_turn_rad = 2.6;

  PanelMap(const PanelLayout& layout, const MarkerCalibration& marker, const CameraCalibration& camera)
      : layout_(layout), marker_(marker), camera_(camera) {}

  // Takes an answer of panel vision. On a failure what was known before stays.
  // Of the answer's confidence only 0 counts: it says that there is no answer. What makes a confidence low has a limit of its own each:
  //   the plane's inliers: two fifths of the points;
  //   the marker's margin: the detector finds no marker below MarkerDetectorConfig::min_margin;
  //   the ambiguity of the marker's pose: ValveFrameConfig bounds its corners on the plane, its distance and its tilt against the plane;
  //   the points of a cluster: the sigma of the handle's angle.
  // A bar looks the same after half a turn. Its pointer mark tells the two angles apart. Where the mark is missing or was not recognised, the handle's stops do, and
  // after a turn of our own without a mark the way of that turn. Where two angles stay possible, the look fails: nothing is guessed.
  StepFailure update(const PanelResult& result);

  // Of the newest answer, taken or not.
  const CalibrationFit& fit() const { return fit_; }

  bool known() const { return known_; }
  const Pose& base_from_panel() const { return frame_.base_from_panel; }
  // By how much that may be wrong, once it is known: what the calibration errs by, the scatter of the points about the plane, and what
  // the laser line's shape leaves in doubt.
  arm::PanelDoubt doubt() const;
  double handle_rad() const { return handle_rad_; }
  // The jaw has the handle here, if it holds it: until the next look the handle is on the way from where it was seen to here.
  void expect_handle(double rad);
  // How far the handle may be turned between two looks.
  double longest_turn_rad() const { return has_pointer() ? 2 * pi : longest_blind_turn_rad; }
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
  struct Range {
    double low_rad, high_rad;
  };
  bool has_pointer() const { return layout_.pointer != PanelLayout::Pointer::none; }
  CalibrationFit fit_of(const PanelResult& result, const scan::ValveFrame& frame) const;
  StepFailure judge(const PanelResult& result, const scan::ValveFrame& frame, const scan::HandleObservation& handle) const;
  StepFailure settle(const PanelResult& result, const scan::ValveFrame& frame, const scan::HandleObservation& handle,
                     double& angle_rad) const;

  PanelLayout layout_;
  MarkerCalibration marker_;
  CameraCalibration camera_;
  CalibrationFit fit_;
  bool known_ = false;
  scan::ValveFrame frame_;
  scan::HandleObservation handle_;
  PlaneFit plane_;
  double handle_rad_ = 0;
  Range way_{0, 0};  // of the handle since it was last seen
};

}  // namespace lf::mission
