// By how much one picture is brighter than another of the same scene: an automatic exposure between the two, a lamp that flickers.
//
// The difference of two pictures shows the laser alone only where both are as bright. Real pairs differ by 3 to 7 %, and once by 2.6 times
// (a camera whose exposure follows the light).
#pragma once

#include "firmware/scan/pixel_view.hpp"

namespace lf::scan {

// `on` over `off`, 0.25 to 4, from a sample of 2560 of their pixels that are neither dark nor at `full_scale`: the mean ratio of those within 5 % of the commonest. The
// laser's stripe covers too little to be the commonest. `on_its_side`: the pictures are turned, and the sample with them.
// 1 where fewer than 200 pixels can tell, and of pictures of different sizes.
// O(1), no allocation.
template <class Pixel>
float gain_between(const PixelView<Pixel>& on, const PixelView<Pixel>& off, std::int32_t full_scale, bool on_its_side = false);

}  // namespace lf::scan
