// What the newest look saw, in numbers: they tell why it failed. Published with the telemetry.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/mission/calibration_fit.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/scan_messages.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::mission {

struct Sight {
  std::uint32_t look = 0;  // which one; 0: none was answered yet
  // Of its sweep.
  std::uint32_t stripes = 0;            // images of the laser
  std::uint32_t images_missing = 0;     // that were ordered and did not come
  std::uint32_t images_refused = 0;     // malformed, of another size, or exposed without what was ordered
  std::uint32_t columns_found = 0;      // peaks in these images
  std::uint32_t columns_weak = 0;       // columns whose brightest place is no stripe
  std::uint32_t columns_saturated = 0;  // columns that are white over more than a stripe's width
  std::uint32_t columns_misfit = 0;     // peaks that have no stripe's shape, or stand where no part of a line goes on
  StripeForm stripe;                    // as its sweep has learned it
  std::uint32_t points = 0;             // of the cloud
  // Of its plane. `off` and `tilt` hold it against the panel where the vehicle is docked exactly, and count from there.
  bool plane_found = false;
  std::uint32_t inliers = 0;
  float plane_rms_m = 0;
  float plane_off_m = 0;  // at the nominal valve, away from the robot
  float plane_tilt_rad = 0;
  // Of its still.
  bool still_taken = false;
  PictureLight still;
  bool marker_found = false;
  float marker_cell_px = 0;  // side of one square of the marker's code in the picture, where the vehicle is docked exactly
  float marker_margin_grey = 0;
  // From the nominal marker's centre to the seen one's, by the marker's own pose; 0 without a marker.
  float marker_off_m = 0;
  // What stands proud: how many groups of points, and whether one of them has a handle's height and length. `handle_off_m`: from the nominal handle's centre to the
  // nearest one's.
  std::uint32_t proud_clusters = 0;
  bool handle_found = false;
  float handle_off_m = 0;
  CalibrationFit fit;
};

// `before`: as the sweep began. `now`: as its answer came. `valve`: the one whose handle is told of. Without the fit, which the panel's map knows.
Sight sight_of(const PanelResult& result, const ScanStats& before, const ScanStats& now, const PanelLayout& layout, std::size_t valve,
               const CameraCalibration& camera);

}  // namespace lf::mission
