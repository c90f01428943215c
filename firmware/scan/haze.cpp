#include "firmware/scan/haze.hpp"

#include <algorithm>
#include <cmath>

namespace lf::scan {
namespace {

constexpr float wider = 4.0f;  // from each Gaussian to the next
// What cells do to a picture by themselves, in cells^2: the box of one, the kernel's integrals over one, the straight lines between two.
constexpr float own_variance = 1.0f / 12 + 1.0f / 12 + 1.0f / 6;
constexpr float least_variance = 0.01f;
constexpr std::int32_t most_reach = 48;  // cells
constexpr float reach_in_sigmas = 3.0f;

using Taps = std::array<float, most_reach + 1>;

// Half of a Gaussian's integrals over cells. With its mirror they add up to 1.
std::int32_t make_taps(float sigma, Taps& taps) {
  const std::int32_t reach = std::clamp<std::int32_t>(static_cast<std::int32_t>(std::ceil(reach_in_sigmas * sigma)), 1, most_reach);
  const float scale = 1 / (sigma * std::sqrt(2.0f));
  float sum = 0;
  for (std::int32_t i = 0; i <= reach; ++i) {
    const auto at = static_cast<float>(i);
    float& tap = taps[static_cast<std::size_t>(i)];
    tap = std::erf((at + 0.5f) * scale) - std::erf((at - 0.5f) * scale);
    sum += i == 0 ? tap : 2 * tap;
  }
  for (float& tap : taps) tap /= sum;
  return reach;
}

float sigma_in_cells(float sigma_px, std::int32_t cell_px) {
  const float cells = sigma_px / static_cast<float>(cell_px);
  return std::sqrt(std::max(cells * cells - own_variance, least_variance));
}

}  // namespace

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
void BasicHaze<Pixel, MaxWidth, MaxHeight>::compute(const PixelView<Pixel>& picture, float near_px) {
  fine_.resize(0, 0);
  if (!picture.valid() || picture.width > MaxWidth || picture.height > MaxHeight) return;
  add_up(picture);
  add_up_cells();
  fine_.blur(sigma_in_cells(near_px, cell), near_haze, fine_scratch_);
  widest_ = coarse_;
  coarse_.blur(sigma_in_cells(wider * near_px, cell * coarse), far_haze, coarse_scratch_);
  widest_.blur(sigma_in_cells(wider * wider * near_px, cell * coarse), farthest_haze, coarse_scratch_);
  for (std::int32_t row = 0; row < fine_.rows; ++row) {
    for (std::int32_t column = 0; column < fine_.columns; ++column) {
      const auto in_coarse = [](std::int32_t at) { return (static_cast<float>(at) + 0.5f) / coarse - 0.5f; };
      const float x = in_coarse(column), y = in_coarse(row);
      fine_.row(row)[column] += coarse_.at(x, y) + widest_.at(x, y);
    }
  }
}

// The mean of each cell's pixels; at the picture's borders of those that it has.
template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
void BasicHaze<Pixel, MaxWidth, MaxHeight>::add_up(const PixelView<Pixel>& picture) {
  fine_.resize(cells_of(picture.width, cell), cells_of(picture.height, cell));
  const std::int32_t whole = picture.width / cell;
  for (std::int32_t row = 0; row < fine_.rows; ++row) {
    float* out = fine_.row(row);
    std::fill_n(out, fine_.columns, 0.0f);
    const std::int32_t first = row * cell, last = std::min(first + cell, picture.height);
    for (std::int32_t v = first; v < last; ++v) {
      const Pixel* pixels = picture.row(v);
      for (std::int32_t column = 0; column < whole; ++column) {
        std::uint32_t sum = 0;
        for (std::int32_t i = 0; i < cell; ++i) sum += pixels[column * cell + i];
        out[column] += static_cast<float>(sum);
      }
      for (std::int32_t u = whole * cell; u < picture.width; ++u) out[whole] += static_cast<float>(pixels[u]);
    }
    for (std::int32_t column = 0; column < fine_.columns; ++column) {
      const std::int32_t wide = std::min(cell, picture.width - column * cell);
      out[column] /= static_cast<float>(wide * (last - first));
    }
  }
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
void BasicHaze<Pixel, MaxWidth, MaxHeight>::add_up_cells() {
  coarse_.resize(cells_of(fine_.columns, coarse), cells_of(fine_.rows, coarse));
  for (std::int32_t row = 0; row < coarse_.rows; ++row) {
    for (std::int32_t column = 0; column < coarse_.columns; ++column) {
      const std::int32_t right = std::min((column + 1) * coarse, fine_.columns), bottom = std::min((row + 1) * coarse, fine_.rows);
      float sum = 0;
      for (std::int32_t r = row * coarse; r < bottom; ++r) {
        for (std::int32_t c = column * coarse; c < right; ++c) sum += fine_.row(r)[c];
      }
      coarse_.row(row)[column] = sum / static_cast<float>((right - column * coarse) * (bottom - row * coarse));
    }
  }
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
template <std::int32_t Columns, std::int32_t Rows>
void BasicHaze<Pixel, MaxWidth, MaxHeight>::Plane<Columns, Rows>::blur(float sigma, float share, Plane& scratch) {
  Taps taps{};
  const std::int32_t reach = make_taps(sigma, taps);
  std::array<float, static_cast<std::size_t>(Columns) + 2 * most_reach> line;
  for (std::int32_t r = 0; r < rows; ++r) {
    const float* in = row(r);
    for (std::int32_t i = 0; i < columns + 2 * reach; ++i)
      line[static_cast<std::size_t>(i)] = in[std::clamp<std::int32_t>(i - reach, 0, columns - 1)];
    float* out = scratch.row(r);
    std::fill_n(out, columns, 0.0f);
    for (std::int32_t i = -reach; i <= reach; ++i) {
      const float tap = taps[static_cast<std::size_t>(std::abs(i))];
      const float* shifted = line.data() + reach + i;
      for (std::int32_t column = 0; column < columns; ++column) out[column] += tap * shifted[column];
    }
  }
  for (std::int32_t r = 0; r < rows; ++r) {
    float* out = row(r);
    std::fill_n(out, columns, 0.0f);
    for (std::int32_t i = -reach; i <= reach; ++i) {
      const float tap = share * taps[static_cast<std::size_t>(std::abs(i))];
      const float* in = scratch.row(std::clamp<std::int32_t>(r + i, 0, rows - 1));
      for (std::int32_t column = 0; column < columns; ++column) out[column] += tap * in[column];
    }
  }
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
template <std::int32_t Columns, std::int32_t Rows>
float BasicHaze<Pixel, MaxWidth, MaxHeight>::Plane<Columns, Rows>::at(float x, float y) const {
  const float across = std::clamp(x, 0.0f, static_cast<float>(columns - 1)), down = std::clamp(y, 0.0f, static_cast<float>(rows - 1));
  const std::int32_t left = std::min(static_cast<std::int32_t>(across), std::max<std::int32_t>(columns - 2, 0)),
                     right = std::min(left + 1, columns - 1);
  const std::int32_t top = std::min(static_cast<std::int32_t>(down), std::max<std::int32_t>(rows - 2, 0)),
                     bottom = std::min(top + 1, rows - 1);
  const float to_right = across - static_cast<float>(left), to_bottom = down - static_cast<float>(top);
  const float above = row(top)[left] * (1 - to_right) + row(top)[right] * to_right;
  const float below = row(bottom)[left] * (1 - to_right) + row(bottom)[right] * to_right;
  return above * (1 - to_bottom) + below * to_bottom;
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
float BasicHaze<Pixel, MaxWidth, MaxHeight>::at(float u, float v) const {
  return fine_.columns == 0 ? 0 : fine_.at((u + 0.5f) / cell - 0.5f, (v + 0.5f) / cell - 0.5f);
}

template class BasicHaze<std::uint8_t, 320, 240>;
template class BasicHaze<std::uint8_t, 640, 480>;
template class BasicHaze<std::uint8_t, 4096, 4096>;
template class BasicHaze<std::uint16_t, 4096, 4096>;

}  // namespace lf::scan
