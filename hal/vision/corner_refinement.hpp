// Corners of a marker's black square, from lines fitted to its four edges.
//
// libapriltag places corners to 0.05 px in the middle and 0.15 px at the 95th percentile (rendered 36h11 tags at 0.5-0.9 m, 361.7 px focal
// length); the valve's base lies 0.19 m beside the tag, and four times the tag's half side multiplies a corner's error by as much.
#pragma once

#include <array>

#include "shared/geometry/pose.hpp"
#include "shared/messages/image.hpp"

namespace lf::vision {

// `corners_px` in order around the square, pixel centres at integers; `cells` the square's width in cells: there is no other edge within one
// cell of these. Each edge is found on many short profiles across it, as the centroid of their gradient, which a symmetric blur leaves in place.
// Gives the corners back unchanged when an edge has too little contrast or leaves the image, or a corner would move by more than 1.5 px.
std::array<Vec2, 4> refine_corners(ImageView image, const std::array<Vec2, 4>& corners_px, int cells);

}  // namespace lf::vision
