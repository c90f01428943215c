// Where the valve is and how its handle stands: marker and plane make the frame, the proud points make the handle.
//
// The marker's pose from PnP alone tilts by degrees; its corners' rays crossed with the scanned plane do not.
#pragma once

#include <array>
#include <cstdint>

#include "shared/calibration/calibration.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::scan {

enum class ValveFrameOutcome : std::uint8_t {
  ok,
  no_plane,        // the fit is not valid, or edge-on to the camera
  no_marker,       // none found, or another id than the calibration's
  bad_marker,      // its corners on the plane are no square of the surveyed size
  poses_disagree,  // plane and PnP put the marker's centre more than `max_disagreement_m` apart, or its normal more than `max_tilt_rad`
  not_a_number,
};

struct ValveFrame {
  ValveFrameOutcome outcome = ValveFrameOutcome::no_plane;
  Pose base_from_panel = Pose::Identity();
  double marker_size_m = 0;            // side of the square measured on the plane, against the surveyed one
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

struct ValveFrameConfig {
  double max_disagreement_m =
      0.030;                     // PnP's range error at 3.4 px a tag cell is 5 mm, to which a mounting error of 0.2 mm / 0.05 deg adds 1 mm
  double max_tilt_rad = 0.35;    // PnP alone tilts a marker of 40 px by up to 10 degrees; twice that is another plane than the scanned one
  double max_size_error = 0.10;  // of the marker's side on the plane; half of it for the rms of its corners about a square
  double max_handle_offset_m = 0.030;  // cluster's centre from the valve's axis
};

// The panel frame in the base frame, from one answer of the panel vision.
ValveFrame find_valve_frame(const PanelResult& result, const MarkerCalibration& marker, const CameraCalibration& camera,
                            const ValveFrameConfig& config);

// The handle among the proud clusters: at the height, of the length and near the axis that the layout says.
HandleObservation find_handle(const PanelResult& result, const ValveFrame& frame, const PanelLayout& layout,
                              const ValveFrameConfig& config);

// The buttons among the proud clusters, each within half its width of its nominal place.
std::array<ButtonObservation, PanelLayout::button_count> find_buttons(const PanelResult& result, const ValveFrame& frame,
                                                                      const PanelLayout& layout);

}  // namespace lf::scan
