// What a look leaves over that an exact calibration would explain: nothing but noise, where camera, laser, arm and marker are as the core was told.
//
// An error along the way from the laser to the camera shows in the marker's size on the scanned plane. One across it shifts marker and cloud alike
// and leaves nothing over.
#pragma once

#include <limits>

namespace lf::mission {

struct CalibrationFit {
  bool known = false;           // marker and plane were both found; if not, the rest says nothing
  float marker_size_m = 0;      // as surveyed
  float marker_side_px = 0;     // mean side of its square in the picture
  float marker_side_error = 0;  // side of the square in which its corners' rays meet the scanned plane, over the surveyed one, less 1
  float marker_corners_m = 0;   // rms of these corners about a square
  float plane_bend_m = 0;       // what neighbouring points of the plane err by together
  float panel_shift_m =
      std::numeric_limits<float>::quiet_NaN();  // of the panel's frame since the look before; not a number in the first one
};

}  // namespace lf::mission
