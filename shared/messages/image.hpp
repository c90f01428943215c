// Camera images as the core sees them: borrowed 8-bit grey pixels with the instant of their exposure.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/messages/time.hpp"

namespace lf {

// 8-bit grey, row-major, not owned. Pixel centres are at integer coordinates: (0, 0) is the centre of the top left pixel.
struct ImageView {
  const std::uint8_t* data = nullptr;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int32_t stride = 0;  // bytes from one row to the next

  const std::uint8_t* row(std::int32_t v) const { return data + static_cast<std::ptrdiff_t>(v) * stride; }
  std::uint8_t at(std::int32_t u, std::int32_t v) const { return row(v)[u]; }
  bool valid() const { return data != nullptr && width > 0 && height > 0 && stride >= width; }
};

// A triggered image: the camera stamps the start of the exposure on the platform's clock.
struct Image {
  ImageView view;
  Time exposure_start;
  Duration exposure;
  std::uint32_t sequence = 0;  // counts the camera's exposures; a gap is a lost frame
  // Trigger counter of the output node that asked for this exposure, where the platform knows it: then it names the exposure, and its time is the one
  // that was ordered, whatever the camera's clock says. -1: known by its time alone.
  std::int32_t trigger = -1;

  Time mid_exposure() const { return exposure_start + exposure / 2; }
};

}  // namespace lf
