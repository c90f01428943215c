// A picture's grey levels, of 8 or 16 bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/messages/image.hpp"

namespace lf::scan {

// Grey pixels, row-major, not owned; `stride` in pixels.
template <class Pixel>
struct PixelView {
  const Pixel* data = nullptr;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int32_t stride = 0;

  PixelView() = default;
  PixelView(const Pixel* first, std::int32_t w, std::int32_t h, std::int32_t pixels_a_row)
      : data(first), width(w), height(h), stride(pixels_a_row) {}
  PixelView(const ImageView& image)
      : data(image.data), width(image.width), height(image.height), stride(image.stride) {}  // NOLINT: same thing
  bool valid() const { return data != nullptr && width > 0 && height > 0 && stride >= width; }
  const Pixel* row(std::int32_t v) const { return data + static_cast<std::ptrdiff_t>(v) * stride; }
};

}  // namespace lf::scan
