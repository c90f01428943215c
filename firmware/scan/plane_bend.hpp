// By how much a cloud bends off the plane that was fitted to it.
//
// The plane is the mean of thousands of points. What scatters each by itself, speckle and noise of the camera, averages out, and leaves the plane where it is. What moves
// neighbours alike, a bent panel or a camera that is not as calibrated, does not, and shows in the means of the points' distances over cells of the plane.
#pragma once

#include <span>

#include "shared/messages/panel_vision.hpp"

namespace lf::scan {

// Root mean square of the distances' means, metres, over a grid of 8 by 8 cells that holds the points nearer than `threshold_m`; a cell of fewer than 30 such points does
// not count. Where less than half of the points lie in cells that count, of the distances themselves: few points prove no plane. 0 without a point. No allocation,
// O(points).
double plane_bend_m(std::span<const CloudPoint> points, const Plane& plane, double threshold_m);

}  // namespace lf::scan
