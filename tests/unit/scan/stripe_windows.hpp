// Columns of a formed picture as the fit takes them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "firmware/scan/haze.hpp"
#include "firmware/scan/stripe_fit.hpp"
#include "tests/unit/scan/formed_stripe.hpp"

namespace lf::test {

inline scan::StripeOptics optics_of(const FormedStripe& s) {
  return {static_cast<float>(s.beam_sigma_px), static_cast<float>(s.lens_sigma_px), static_cast<float>(s.scatter_to_camera)};
}

inline scan::PixelNoise noise_of(const FormedStripe& s) {
  if (!s.noise) return {0.3f, 1e6f, 0.0f};
  const double read = std::sqrt(s.read_noise_grey * s.read_noise_grey + 1.0 / 12);
  return {static_cast<float>(read), static_cast<float>(s.electrons_per_grey), static_cast<float>(s.speckle)};
}

// The haze of both pictures, of at most 160 by 480 pixels.
class PairHaze {
 public:
  explicit PairHaze(const FormedImage& image) {
    compute(image, image.on, *on_);
    compute(image, image.off, *off_);
  }
  float of_stripe(int u, int v) const { return on_->at(static_cast<float>(u), static_cast<float>(v)) - of_ambient(u, v); }
  float of_ambient(int u, int v) const { return off_->at(static_cast<float>(u), static_cast<float>(v)); }

 private:
  static void compute(const FormedImage& image, const std::vector<double>& plane, scan::Haze& haze) {
    std::vector<std::uint8_t> pixels;
    for (const double grey : plane) pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(grey), 0.0, 255.0)));
    haze.compute({pixels.data(), image.width, image.height, image.width});
  }
  std::unique_ptr<scan::Haze> on_ = std::make_unique<scan::Haze>(), off_ = std::make_unique<scan::Haze>();
};

// Column `u` of the image into `lane`, about `start_row`, as far as `optics` want it. Returns the image's row of the window's first.
inline int put(const FormedImage& image, const FormedStripe& s, const scan::StripeOptics& optics, int u, double start_row, int lane,
               scan::StripeWindows& windows, const PairHaze* haze = nullptr) {
  const int half = scan::reach_of_window(optics), first = static_cast<int>(std::lround(start_row)) - half;
  const double full_scale = s.noise ? std::exp2(s.bits) - 1 : 1e9;
  windows.count = 2 * half + 1;
  windows.hazy = haze != nullptr;
  windows.start[lane] = static_cast<float>(start_row - first);
  for (int i = 0; i < windows.count; ++i) {
    const int v = std::clamp(first + i, 0, image.height - 1);
    const double off = image.at(image.off, u, v);
    const auto row = static_cast<std::size_t>(i);
    windows.stripe[row][lane] = static_cast<float>(image.stripe(u, v));
    windows.ambient[row][lane] = static_cast<float>(off);
    windows.stripe_haze[row][lane] = haze != nullptr ? haze->of_stripe(u, v) : 0;
    windows.ambient_haze[row][lane] = haze != nullptr ? haze->of_ambient(u, v) : 0;
    windows.valid[row][lane] = image.at(image.on, u, v) < full_scale ? 1.0f : 0.0f;
  }
  return first;
}

}  // namespace lf::test
