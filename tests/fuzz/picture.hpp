// A grey picture of any size out of a fuzz input, its pixels in memory of exactly their number.
#pragma once

#include <algorithm>
#include <vector>

#include "tests/fuzz/input.hpp"

namespace lf::fuzz {

template <class Pixel>
struct Picture {
  std::int32_t width = 0, height = 0, stride = 0;
  std::vector<Pixel> pixels;

  Pixel& at(std::int32_t u, std::int32_t v) {
    return pixels[static_cast<std::size_t>(v) * static_cast<std::size_t>(stride) + static_cast<std::size_t>(u)];
  }
};

// The last row ends with its last pixel. Filled with noise about a level.
template <class Pixel>
Picture<Pixel> blank(Input& in, std::int32_t width, std::int32_t height) {
  Picture<Pixel> picture;
  picture.width = width;
  picture.height = height;
  picture.stride = width + in.byte() % 8;
  if (width > 0 && height > 0)
    picture.pixels.resize(static_cast<std::size_t>(picture.stride) * static_cast<std::size_t>(height - 1) +
                          static_cast<std::size_t>(width));
  const std::uint32_t level = in.byte(), noise = in.byte() & 63U;
  std::uint32_t state = in.byte();
  for (Pixel& pixel : picture.pixels) {
    state = state * 1664525U + 1013904223U;
    pixel = static_cast<Pixel>(level + (noise > 0 ? (state >> 24U) % noise : 0U));
  }
  return picture;
}

// Boxes, lines and single pixels, each of eight bytes of the input, until it ends.
template <class Pixel>
void draw(Input& in, Picture<Pixel>& picture) {
  if (picture.pixels.empty()) return;
  while (!in.empty()) {
    const std::uint8_t what = in.byte();
    const std::int32_t u = in.byte() * picture.width / 256, v = in.byte() * picture.height / 256;
    const std::int32_t width = std::min<std::int32_t>(1 + in.byte() % 64, picture.width - u),
                       height = std::min<std::int32_t>(1 + in.byte() % 64, picture.height - v);
    const std::int32_t slope = static_cast<std::int8_t>(in.byte());
    const auto value = in.take<std::uint16_t>();
    for (std::int32_t j = 0; j < height; ++j) {
      for (std::int32_t i = 0; i < width; ++i) {
        const std::int32_t row = (what & 1U) != 0 ? std::clamp(v + j + i * slope / 64, 0, picture.height - 1) : v + j;
        Pixel& pixel = picture.at(u + i, row);
        pixel = static_cast<Pixel>((what & 2U) != 0 ? pixel + value : (what & 4U) != 0 ? value + j * slope : value);
      }
    }
  }
}

}  // namespace lf::fuzz
