// Camera calibrations as OpenCV's and ROS's calibration tools write them. Hosted side only.
#pragma once

#include <string>

#include "shared/calibration/calibration.hpp"

namespace lf::vision {

// Reads `image_width`, `image_height`, `camera_matrix`, `distortion_coefficients` and `distortion_model` from YAML; other keys are theirs.
// Without a size in the file it is 0 x 0: unknown. Throws InputError with file and line: unreadable or malformed file, a missing or
// misshapen matrix, numbers that are not finite, focal lengths that are not positive, a distortion model other than plumb_bob (no model is
// plumb_bob), or coefficients beyond k3 that are not zero.
CameraIntrinsics read_camera_calibration(const std::string& path);

}  // namespace lf::vision
