#include "firmware/scan/exposure_gain.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "shared/lanes/lanes.hpp"

namespace lf::scan {
namespace {

constexpr std::int32_t across = 64, down = 40;  // samples
constexpr float dark = 0.06f;                   // of full scale: below it the noise is the ratio's
constexpr float nearly_white = 0.97f;
constexpr std::int32_t least_samples = 200;  // of 2560: with a noise of 10 % each their mean is right to 1 %
constexpr std::int32_t bins = 280;           // of the ratio's logarithm, 1 % each
constexpr float bin_width = 0.01f;
constexpr std::int32_t half_window = 5;  // bins to either side of the commonest ratio

// Ratios of the samples that can tell, and where they lie.
struct Samples {
  static constexpr std::int32_t most = across * down;
  std::int32_t count = 0;
  std::array<float, most> on, off;
  std::array<std::int32_t, most> bin;
};

template <class Pixel>
void take(const PixelView<Pixel>& on, const PixelView<Pixel>& off, std::int32_t full_scale, bool on_its_side, Samples& samples) {
  const float least = dark * static_cast<float>(full_scale), most = nearly_white * static_cast<float>(full_scale);
  const std::int32_t width = on_its_side ? on.height : on.width, height = on_its_side ? on.width : on.height;
  const auto pixel = [on_its_side](const PixelView<Pixel>& image, std::int32_t u, std::int32_t v) {
    return static_cast<float>(on_its_side ? image.row(u)[v] : image.row(v)[u]);
  };
  for (std::int32_t row = 0; row < down; ++row) {
    const std::int32_t v = (2 * row + 1) * height / (2 * down);
    for (std::int32_t column = 0; column < across; ++column) {
      const std::int32_t u =
          (4 * column + 1 + 2 * (row % 2)) * width / (4 * across);  // every other row between the columns of the one before
      const float a = pixel(on, u, v), b = pixel(off, u, v);
      if (!(a > least && b > least && a < most && b < most)) continue;
      const auto i = static_cast<std::size_t>(samples.count++);
      samples.on[i] = a;
      samples.off[i] = b;
    }
  }
}

// The ratios' logarithms, within -1.4 to 1.4.
void sort_into_bins(Samples& samples) {
  for (std::int32_t first = 0; first < samples.count; first += lane_count) {
    Lanes a = all_lanes(1), b = a;
    for (int lane = 0; lane < lane_count; ++lane) {
      const auto i = static_cast<std::size_t>(std::min(first + lane, samples.count - 1));
      a[lane] = samples.on[i];
      b[lane] = samples.off[i];
    }
    const Lanes place = clamp(log(a / b) / bin_width + 0.5f * bins, 0, bins - 1);
    for (int lane = 0; lane < std::min<std::int32_t>(lane_count, samples.count - first); ++lane) {
      const std::int32_t at = first + lane;
      samples.bin[static_cast<std::size_t>(at)] = static_cast<std::int32_t>(place[lane]);
    }
  }
}

// The commonest ratio: the middle of the window of bins that has most. One bin alone is noise.
std::int32_t commonest(const Samples& samples) {
  std::array<std::int32_t, bins> counts{};
  for (std::int32_t i = 0; i < samples.count; ++i) ++counts[static_cast<std::size_t>(samples.bin[static_cast<std::size_t>(i)])];
  std::int32_t best = 0, most = -1;
  for (std::int32_t middle = half_window; middle < bins - half_window; ++middle) {
    const auto first = counts.begin() + middle - half_window;
    const std::int32_t within = std::accumulate(first, first + 2 * half_window + 1, std::int32_t{0});
    if (within <= most) continue;
    most = within;
    best = middle;
  }
  return best;
}

}  // namespace

template <class Pixel>
float gain_between(const PixelView<Pixel>& on, const PixelView<Pixel>& off, std::int32_t full_scale, bool on_its_side) {
  if (!on.valid() || !off.valid() || on.width != off.width || on.height != off.height) return 1;
  Samples samples;
  take(on, off, full_scale, on_its_side, samples);
  if (samples.count < least_samples) return 1;
  sort_into_bins(samples);
  const std::int32_t best = commonest(samples);
  float sum_on = 0, sum_off = 0;
  for (std::int32_t i = 0; i < samples.count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (std::abs(samples.bin[at] - best) > half_window) continue;
    sum_on += samples.on[at];
    sum_off += samples.off[at];
  }
  return sum_on / sum_off;
}

template float gain_between(const PixelView<std::uint8_t>&, const PixelView<std::uint8_t>&, std::int32_t, bool);
template float gain_between(const PixelView<std::uint16_t>&, const PixelView<std::uint16_t>&, std::int32_t, bool);

}  // namespace lf::scan
