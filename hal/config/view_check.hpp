// Whether the camera can see the panel where it nominally is, and whether its lens can be reckoned with.
#pragma once

#include <string>
#include <vector>

#include "hal/config/machine.hpp"
#include "shared/calibration/calibration.hpp"

namespace lf::config {

// A sentence for each corner, marker or valve that is out of view, and one for a lens whose picture folds over, each with the keys that it comes of.
std::vector<std::string> view_problems(const Machine& machine, const CameraCalibration& camera);

}  // namespace lf::config
