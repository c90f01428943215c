// How much a picture's pixels differ from their neighbours by noise alone.
//
// From the quartiles of second differences, a - 2 b + c of three neighbours: slopes leave them alone, and shapes' edges hardly move them. Those of noise have sqrt(6)
// of its standard deviation, and a quarter of them are below 0.3186 of that (after the median absolute deviation; Immerkaer, Fast Noise Variance Estimation, 1996,
// takes the mean of a like difference). Pixels of like brightness are taken together, since bright ones have more shot noise than dark ones.
#pragma once

#include "firmware/scan/pixel_view.hpp"

namespace lf::scan {

enum class NoiseAlong : std::uint8_t { rows, columns };  // along columns a sensor's row noise counts

// The noise's standard deviation in grey levels of 0 to 255; 0 where nothing tells. From 19,200 places at most, less those with a clipped pixel: right to 2 % in even
// pictures. O(1), no allocation.
template <class Pixel>
float pixel_noise_grey(const PixelView<Pixel>& picture, std::int32_t full_scale, NoiseAlong along);

// The same without the shot noise, from two pictures of a scene, `on` brighter by the factor `gain`: their difference has no paint, and no fixed pattern.
template <class Pixel>
float read_noise_grey(const PixelView<Pixel>& on, const PixelView<Pixel>& off, float gain, float electrons_per_grey,
                      std::int32_t full_scale, NoiseAlong along);

// The same from one picture: fine paint counts as noise.
template <class Pixel>
float read_noise_grey(const PixelView<Pixel>& picture, float electrons_per_grey, std::int32_t full_scale, NoiseAlong along);

}  // namespace lf::scan
