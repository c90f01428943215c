// Columns of a formed picture as the fit takes them.
#pragma once

#include <algorithm>
#include <cmath>

#include "firmware/scan/stripe_fit.hpp"
#include "tests/unit/scan/formed_stripe.hpp"

namespace lf::test {

inline scan::StripeOptics optics_of(const FormedStripe& s) {
  return {static_cast<float>(s.beam_sigma_px), static_cast<float>(s.lens_sigma_px)};
}

inline scan::PixelNoise noise_of(const FormedStripe& s) {
  if (!s.noise) return {0.3f, 1e6f, 0.0f};
  const double read = std::sqrt(s.read_noise_grey * s.read_noise_grey + 1.0 / 12);
  return {static_cast<float>(read), static_cast<float>(s.electrons_per_grey), static_cast<float>(s.speckle)};
}

// Column `u` of the image into `lane`, about `start_row`, as far as `optics` want it. Returns the image's row of the window's first.
inline int put(const FormedImage& image, const FormedStripe& s, const scan::StripeOptics& optics, int u, double start_row, int lane,
               scan::StripeWindows& windows) {
  const int half = scan::reach_of_window(optics), first = static_cast<int>(std::lround(start_row)) - half;
  const double full_scale = s.noise ? std::exp2(s.bits) - 1 : 1e9;
  windows.count = 2 * half + 1;
  windows.start[lane] = static_cast<float>(start_row - first);
  for (int i = 0; i < windows.count; ++i) {
    const int v = std::clamp(first + i, 0, image.height - 1);
    const double off = image.at(image.off, u, v);
    const auto row = static_cast<std::size_t>(i);
    windows.stripe[row][lane] = static_cast<float>(image.stripe(u, v));
    windows.paint[row][lane] = static_cast<float>(std::max(1.0, off));
    windows.ambient[row][lane] = static_cast<float>(off);
    windows.valid[row][lane] = image.at(image.on, u, v) < full_scale ? 1.0f : 0.0f;
  }
  return first;
}

}  // namespace lf::test
