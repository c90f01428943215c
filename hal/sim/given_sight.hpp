// Sight that is given, not rendered: what panel vision would answer, made of the world's truth. For everything that is not about seeing, since a mission
// without rendering takes a tenth of the time.
#pragma once

#include <cstdint>
#include <span>

#include "host_sim/optics/optics.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::hal {

// What panel vision would say, without error, of a panel that stands so. `handles_rad`: of the layout's valves.
PanelResult panel_as_it_is(const Pose& base_from_panel, std::span<const double> handles_rad, const PanelLayout& layout,
                           const MarkerCalibrations& markers, const CameraCalibration& camera);

// A picture with nothing in it, which differs from one exposure to the next as a camera's does. It is too small for the core to look for peaks in.
void blank_picture(std::uint32_t sequence, optics::Frame& frame);

}  // namespace lf::hal
