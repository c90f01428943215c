#include "firmware/scan/exposure_gain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace lf::scan {
namespace {

constexpr std::int32_t step_u = 8, step_v = 4;  // pixels from one sample to the next
constexpr float dark = 0.06f;                   // of full scale: below it the noise is the ratio's
constexpr float nearly_white = 0.97f;
constexpr std::int32_t least_samples = 200;
constexpr std::int32_t bins = 280;  // of the ratio's logarithm, 1 % each
constexpr float bin_width = 0.01f;
constexpr std::int32_t half_window = 5;  // bins to either side of the commonest ratio

// The bin of a ratio within e^-1.4 to e^1.4.
std::int32_t bin_of(float ratio) {
  return std::clamp<std::int32_t>(static_cast<std::int32_t>(std::floor(std::log(ratio) / bin_width)) + bins / 2, 0, bins - 1);
}

// Calls take(on, off) for each sample that can tell.
template <class Pixel, class Take>
void for_samples(const PixelView<Pixel>& on, const PixelView<Pixel>& off, std::int32_t full_scale, Take take) {
  const float least = dark * static_cast<float>(full_scale), most = nearly_white * static_cast<float>(full_scale);
  for (std::int32_t v = step_v / 2; v < on.height; v += step_v) {
    for (std::int32_t u = (v / step_v % 2) * step_u / 2; u < on.width; u += step_u) {
      const auto a = static_cast<float>(on.row(v)[u]), b = static_cast<float>(off.row(v)[u]);
      if (a > least && b > least && a < most && b < most) take(a, b);
    }
  }
}

}  // namespace

template <class Pixel>
float gain_between(const PixelView<Pixel>& on, const PixelView<Pixel>& off, std::int32_t full_scale) {
  if (!on.valid() || !off.valid() || on.width != off.width || on.height != off.height) return 1;
  std::array<std::int32_t, bins> counts{};
  std::int32_t samples = 0;
  for_samples(on, off, full_scale, [&](float a, float b) {
    ++counts[static_cast<std::size_t>(bin_of(a / b))];
    ++samples;
  });
  if (samples < least_samples) return 1;
  // The commonest ratio: of a window of bins, since one alone is noise.
  std::int32_t best = 0, most = -1;
  for (std::int32_t middle = half_window; middle < bins - half_window; ++middle) {
    const auto first = counts.begin() + middle - half_window;
    const std::int32_t within = std::accumulate(first, first + 2 * half_window + 1, 0);
    if (within > most) {
      most = within;
      best = middle;
    }
  }
  float sum_on = 0, sum_off = 0;
  for_samples(on, off, full_scale, [&](float a, float b) {
    if (std::abs(bin_of(a / b) - best) > half_window) return;
    sum_on += a;
    sum_off += b;
  });
  return sum_off > 0 ? sum_on / sum_off : 1;
}

template float gain_between(const PixelView<std::uint8_t>&, const PixelView<std::uint8_t>&, std::int32_t);
template float gain_between(const PixelView<std::uint16_t>&, const PixelView<std::uint16_t>&, std::int32_t);

}  // namespace lf::scan
