// By how much a cloud bends off the plane that was fitted to it.
//
// The plane is the mean of thousands of points. What scatters each by itself, speckle and noise of the camera, averages out, and leaves the plane where it is. What moves
// neighbours alike, a bent panel or a camera that is not as calibrated, does not, and shows in the means of the points' distances over cells of the plane.
#pragma once

#include <span>

#include "shared/messages/panel_vision.hpp"

namespace lf::scan {

struct PlaneBend {
  double bend_m = 0;
  double seen_m = 0;  // shorter side of an evenly covered rectangle whose points spread as these do
};

// Of the points nearer than `threshold_m`. Bend: root mean square of their distances' means over a grid of 8 by 8 cells; a cell of fewer than 30 points does not count.
// Where less than nine tenths of the points lie in cells that count, it is that of the distances themselves: few points prove no plane. 0 without a point. No allocation,
// O(points).
PlaneBend plane_bend(std::span<const CloudPoint> points, const Plane& plane, double threshold_m);

}  // namespace lf::scan
