#include "firmware/scan/pixel_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace lf::scan {
namespace {

constexpr std::int32_t across = 160, down = 120;  // places at most, so that 16 bits count them
constexpr std::uint32_t fewest = 200;             // of a brightness
constexpr std::int32_t brightnesses = 8;
constexpr std::int32_t bins = 512;
constexpr float quartile_of_sigma = 0.3186f * 2.4495f;
constexpr float lit_grey = 4;  // more than the other picture has: the stripe, which is speckled

// Second differences by their size, up to half of full scale: noise is far below it. A whole number stands for what was rounded to it.
class Differences {
 public:
  void add(std::int32_t size, std::int32_t bin_width) {
    ++count_[static_cast<std::size_t>(std::min(size / bin_width, bins - 1))];
    ++all_;
  }
  std::uint32_t all() const { return all_; }
  float quartile(std::int32_t bin_width) const {
    std::uint32_t below = 0;
    for (std::int32_t bin = 0; bin < bins; ++bin) {
      const std::uint32_t here = count_[static_cast<std::size_t>(bin)];
      if (4 * (below + here) >= all_ && here > 0) {
        const float first = std::max(0.0f, static_cast<float>(bin * bin_width) - 0.5f),
                    end = static_cast<float>((bin + 1) * bin_width) - 0.5f;
        const float part = (0.25f * static_cast<float>(all_) - static_cast<float>(below)) / static_cast<float>(here);
        return first + part * (end - first);
      }
      below += here;
    }
    return 0;
  }

 private:
  std::array<std::uint16_t, bins> count_{};
  std::uint32_t all_ = 0;
};

struct Brightness {
  Differences differences;
  std::uint64_t sum = 0;
};

// What the places of a picture, or of a difference of two, say.
class Places {
 public:
  explicit Places(std::int32_t full_scale) : full_scale_(full_scale), bin_width_(std::max<std::int32_t>(1, full_scale / (2 * bins))) {}

  void add(std::int32_t brightness, std::int32_t difference) {
    Brightness& of = of_[static_cast<std::size_t>(brightness * brightnesses / (full_scale_ + 1))];
    of.differences.add(difference < 0 ? -difference : difference, bin_width_);
    of.sum += static_cast<std::uint64_t>(brightness);
  }
  // Squared grey levels, less `shot` of a grey level: each brightness counts by how well it tells, since a variance is known to its square over their number.
  float variance(float shot) const {
    const float grey = 255.0f / static_cast<float>(full_scale_);
    float sum = 0, weights = 0;
    for (const Brightness& of : of_) {
      if (of.differences.all() < fewest) continue;
      const auto count = static_cast<float>(of.differences.all());
      const float sigma = grey * of.differences.quartile(bin_width_) / quartile_of_sigma, mean = grey * static_cast<float>(of.sum) / count;
      const float weight = count / std::max(sigma * sigma * sigma * sigma, 1e-4f);
      sum += weight * (sigma * sigma - shot * mean);
      weights += weight;
    }
    return weights > 0 ? std::max(sum / weights, 0.0f) : 0;
  }

 private:
  std::int32_t full_scale_, bin_width_;
  std::array<Brightness, brightnesses> of_{};  // 8 kB of stack
};

// Calls `take` with each place's row and column.
template <class Pixel, class Take>
void at_places(const PixelView<Pixel>& picture, Take take) {
  const std::int32_t column_step = (picture.width + across - 1) / across, row_step = (picture.height + down - 1) / down;
  for (std::int32_t v = 1; v + 1 < picture.height; v += row_step) {
    for (std::int32_t u = 1; u + 1 < picture.width; u += column_step) take(v, u);
  }
}

struct Three {
  std::int32_t a, b, c;
  bool clipped(std::int32_t full_scale) const { return std::min({a, b, c}) == 0 || std::max({a, b, c}) >= full_scale; }
  std::int32_t mean() const { return (a + b + c) / 3; }
  std::int32_t difference() const { return a - 2 * b + c; }
};

template <class Pixel>
Three three_at(const PixelView<Pixel>& picture, std::int32_t v, std::int32_t u, NoiseAlong along) {
  const std::ptrdiff_t step = along == NoiseAlong::rows ? 1 : picture.stride;
  const Pixel* at = picture.row(v) + u;
  return {at[-step], at[0], at[step]};
}

template <class Pixel>
bool large_enough(const PixelView<Pixel>& picture) {
  return picture.valid() && picture.width >= 3 && picture.height >= 3;
}

}  // namespace

template <class Pixel>
float pixel_noise_grey(const PixelView<Pixel>& picture, std::int32_t full_scale, NoiseAlong along) {
  return read_noise_grey(picture, 0, full_scale, along);
}

template <class Pixel>
float read_noise_grey(const PixelView<Pixel>& picture, float electrons_per_grey, std::int32_t full_scale, NoiseAlong along) {
  if (!large_enough(picture)) return 0;
  Places places(full_scale);
  at_places(picture, [&](std::int32_t v, std::int32_t u) {
    const Three three = three_at(picture, v, u, along);
    if (!three.clipped(full_scale)) places.add(three.mean(), three.difference());
  });
  return std::sqrt(places.variance(electrons_per_grey > 0 ? 1 / electrons_per_grey : 0));
}

template <class Pixel>
float read_noise_grey(const PixelView<Pixel>& on, const PixelView<Pixel>& off, float gain, float electrons_per_grey,
                      std::int32_t full_scale, NoiseAlong along) {
  if (!large_enough(on) || !off.valid() || off.width != on.width || off.height != on.height) return 0;
  Places places(full_scale);
  // The sum of three neighbours tells nothing of their second difference: places are left out by it without a bias.
  const float lit_levels = lit_grey * static_cast<float>(full_scale) / 255;
  at_places(on, [&](std::int32_t v, std::int32_t u) {
    const Three lit = three_at(on, v, u, along), dark = three_at(off, v, u, along);
    if (lit.clipped(full_scale) || dark.clipped(full_scale)) return;
    if (static_cast<float>(lit.mean()) - gain * static_cast<float>(dark.mean()) > lit_levels) return;
    const float difference = static_cast<float>(lit.difference()) - gain * static_cast<float>(dark.difference());
    places.add(dark.mean(), static_cast<std::int32_t>(std::lround(difference)));
  });
  // Of `off` grey levels one picture has gain * off over the electrons, the other gain^2 * off.
  const float shot = electrons_per_grey > 0 ? gain * (1 + gain) / electrons_per_grey : 0;
  return std::sqrt(places.variance(shot) / (1 + gain * gain));
}

template float pixel_noise_grey(const PixelView<std::uint8_t>&, std::int32_t, NoiseAlong);
template float pixel_noise_grey(const PixelView<std::uint16_t>&, std::int32_t, NoiseAlong);
template float read_noise_grey(const PixelView<std::uint8_t>&, float, std::int32_t, NoiseAlong);
template float read_noise_grey(const PixelView<std::uint16_t>&, float, std::int32_t, NoiseAlong);
template float read_noise_grey(const PixelView<std::uint8_t>&, const PixelView<std::uint8_t>&, float, float, std::int32_t, NoiseAlong);
template float read_noise_grey(const PixelView<std::uint16_t>&, const PixelView<std::uint16_t>&, float, float, std::int32_t, NoiseAlong);

}  // namespace lf::scan
