// Where the panel is and how a valve's handle stands: markers and plane make the frame, the proud points make the handle.
//
// The marker's pose from PnP alone tilts by degrees; its corners' rays crossed with the scanned plane do not.
#pragma once

#include <array>
#include <cstdint>

#include "shared/calibration/calibration.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::scan {

enum class PanelFrameOutcome : std::uint8_t {
  ok,
  no_plane,    // the fit is not valid, or edge-on to the camera
  no_marker,   // none of the panel's was found
  bad_marker,  // its corners on the plane are no square of the surveyed size, or two markers stand otherwise to each other than surveyed
  poses_disagree,  // plane and PnP put the marker's centre more than `max_disagreement_m` apart, or its normal more than `max_tilt_rad`
  not_a_number,
};

struct PanelFrame {
  PanelFrameOutcome outcome = PanelFrameOutcome::no_plane;
  Pose base_from_panel = Pose::Identity();
  std::size_t markers = 0;  // that the frame is made of
  // Of one of them, or, where there is none, of the first that was found.
  std::size_t marker = 0;              // which of PanelResult::markers
  double surveyed_size_m = 0;          // side of its black square; 0: no marker
  double marker_size_m = 0;            // the same, measured on the plane
  double marker_rms_m = 0;             // of its corners about that square
  double centre_disagreement_m = 0;    // between ray-and-plane and PnP
  double normal_disagreement_rad = 0;  // between plane and PnP
};

struct HandleObservation {
  bool found = false;
  double angle_rad = 0;          // about panel z from panel y, (-pi/2, pi/2]
  double sigma_rad = 0;          // of the angle, from the cluster's points and width
  Vec3 centre_m = Vec3::Zero();  // panel frame
  double length_m = 0;
  double height_m = 0;  // over the panel
};

struct ButtonObservation {
  bool found = false;
  Vec3 centre_m = Vec3::Zero();  // panel frame: of the cap's face
};

struct PanelFrameConfig {
  double max_disagreement_m =
      0.030;                     // PnP's range error at 3.4 px a tag cell is 5 mm, to which a mounting error of 0.2 mm / 0.05 deg adds 1 mm
  double max_tilt_rad = 0.35;    // PnP alone tilts a marker of 40 px by up to 10 degrees; twice that is another plane than the scanned one
  double max_size_error = 0.10;  // of the marker's side on the plane; half of it for the rms of its corners about a square
  double max_marker_shift_m =
      0.005;  // of a marker's centre from where the others say: a look's repeatability of a millimetre, and what fingers have bent
  // Of the markers' edges together against their common fit: what the mission keeps clear for. One marker alone errs by 0.4 degrees at worst.
  double max_marker_turn_rad = 0.0105;
  double max_handle_offset_m = 0.030;  // cluster's centre from the valve's axis
};

// The panel frame in the base frame, from one answer of the panel vision. Of several markers all corners count alike. One that does not stand where the others
// say is left out, as long as two are left that agree.
PanelFrame find_panel_frame(const PanelResult& result, const MarkerCalibrations& markers, const CameraCalibration& camera,
                            const PanelFrameConfig& config);

// A valve's handle among the proud clusters: at the height, of the length and near the axis that the layout says.
HandleObservation find_handle(const PanelResult& result, const PanelFrame& frame, const PanelLayout::Valve& valve,
                              const PanelFrameConfig& config);

// A button among the proud clusters, within half its width of its nominal place.
ButtonObservation find_button(const PanelResult& result, const PanelFrame& frame, const PanelLayout::Button& button);

}  // namespace lf::scan
