// What the mission knows of the panel: where its frame is, how the valves' handles stand, and from these every point the tool has to go to.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/mission/calibration_fit.hpp"
#include "firmware/mission/mission_config.hpp"
#include "firmware/mission/step_failure.hpp"
#include "firmware/scan/panel_frame.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/panel_vision.hpp"

namespace lf::mission {

class PanelMap {
 public:
  // Without a pointer mark a longer turn would leave open which of two angles half a turn apart the handle has come to: half a turn less what a look and
  // a detent's pull add at both ends of the way.
  static constexpr double longest_blind_turn_rad = 2.6;

  // A bit for each valve of the layout (1 << index).
  using Valves = std::uint32_t;
  static_assert(PanelLayout::max_valves <= 32);
  static constexpr Valves bit(std::size_t valve) { return Valves{1} << valve; }

  // `layout`, `markers` and `camera` outlive the map. So many joints carry the laser.
  PanelMap(const PanelLayout& layout, const MarkerCalibrations& markers, const CameraCalibration& camera, std::size_t laser_joints)
      : layout_(&layout),
        markers_(&markers),
        camera_(&camera),
        markers_beyond_m_(markers_beyond_m(markers)),
        calibrated_parts_(static_cast<double>(2 + laser_joints)) {}

  PanelMap(const PanelLayout&, MarkerCalibrations&&, const CameraCalibration&, std::size_t) = delete;
  PanelMap(const PanelLayout&, const MarkerCalibrations&, CameraCalibration&&, std::size_t) = delete;

  // Takes an answer of panel vision: the panel's place, and how the handles of these valves stand; what is known of the others stays. With none wanted, the handle of any
  // one has to be seen at its place. On a failure what was known before stays.
  // Of the answer's confidence only 0 counts: it says that there is no answer. What makes a confidence low has a limit of its own each:
  //   the plane's inliers: two fifths of the points;
  //   the marker's margin: the detector finds no marker below MarkerDetectorConfig::min_margin;
  //   the ambiguity of the marker's pose: PanelFrameConfig bounds its corners on the plane, its distance and its tilt against the plane;
  //   the points of a cluster: the sigma of the handle's angle.
  // A bar looks the same after half a turn. Its pointer mark tells the two angles apart. Where the mark is missing or was not recognised, the handle's stops do, and
  // after a turn of our own without a mark the way of that turn. Where two angles stay possible, the look fails: nothing is guessed.
  StepFailure update(const PanelResult& result, Valves wanted);

  // Of the newest answer, taken or not.
  const CalibrationFit& fit() const { return fit_; }

  // The valve whose handle made the newest answer fail, or the first that was wanted.
  std::size_t told_valve() const { return told_valve_; }

  bool known() const { return known_; }
  const Pose& base_from_panel() const { return frame_.base_from_panel; }
  // By how much that may be wrong, once it is known: what the calibration errs by, the scatter of the points about the plane, and what
  // the laser line's shape leaves in doubt.
  arm::PanelDoubt doubt() const;
  // The same once a finger touches what stands on the panel: how far off the panel is does not matter any more.
  arm::PanelDoubt doubt_where_touched() const;
  // By how much farther than the default machine's panel this one may stand than it looks. A press finds it.
  double deeper_m() const;
  double handle_rad(std::size_t valve) const { return handles_[valve].angle_rad; }
  bool handle_seen(std::size_t valve) const { return handles_[valve].seen.found; }
  // The jaw has the handle here, if it holds it: until the next look the handle is on the way from where it was seen to here.
  void expect_handle(std::size_t valve, double rad);
  // How far the handle may be turned between two looks.
  double longest_turn_rad(std::size_t valve) const { return layout_->valves[valve].has_pointer() ? 2 * pi : longest_blind_turn_rad; }
  const scan::PanelFrame& frame() const { return frame_; }
  const scan::HandleObservation& handle(std::size_t valve) const { return handles_[valve].seen; }
  const PlaneFit& plane() const { return plane_; }

  Vec3 normal() const { return frame_.base_from_panel.linear().col(2); }  // base frame, toward the robot
  Vec3 handle_centre_m(std::size_t valve) const { return frame_.base_from_panel * layout_->valves[valve].handle_centre_m(); }
  // Centre of a button's face at rest.
  Vec3 button_m(std::size_t button) const { return frame_.base_from_panel * layout_->buttons[button].face_m(); }
  // Direction of the bar at an angle, unit, base frame.
  Vec3 bar(double handle_rad) const { return frame_.base_from_panel.linear() * Vec3(-std::sin(handle_rad), std::cos(handle_rad), 0); }

 private:
  struct Range {
    double low, high;
  };
  struct Handle {
    scan::HandleObservation seen;
    double angle_rad = 0;
    Range way_rad{0, 0};  // since it was last seen
  };
  using Handles = std::array<Handle, PanelLayout::max_valves>;

  CalibrationFit fit_of(const PanelResult& result, const scan::PanelFrame& frame) const;
  StepFailure judge(const PanelResult& result, const scan::PanelFrame& frame) const;
  StepFailure look_at(std::size_t valve, const PanelResult& result, const scan::PanelFrame& frame, Handle& handle) const;
  StepFailure settle(std::size_t valve, const PanelResult& result, const scan::PanelFrame& frame, Handle& handle) const;

  double farther() const;
  static double markers_beyond_m(const MarkerCalibrations& markers);

  const PanelLayout* layout_;
  const MarkerCalibrations* markers_;
  const CameraCalibration* camera_;
  CalibrationFit fit_;
  std::size_t told_valve_ = 0;
  // How much farther a marker is from the panel's origin than where the doubt was measured: what turns about the marker moves the origin.
  double markers_beyond_m_;
  double calibrated_parts_;      // whose calibration errs: camera, laser and the joints that carry it
  Vec3 first_m_ = Vec3::Zero();  // the panel's origin as it was first found
  bool known_ = false;
  scan::PanelFrame frame_;
  PlaneFit plane_;
  Handles handles_;
};

}  // namespace lf::mission
