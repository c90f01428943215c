#include "firmware/scan/picture_light.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware/scan/pixel_noise.hpp"

namespace lf::scan {
namespace {

constexpr std::int32_t side = 8;  // px of a square: noise of 3 grey levels leaves 0.4 in its mean
constexpr std::int32_t pixels_a_square = side * side;
constexpr std::uint8_t white = 255;
constexpr std::int32_t steps_a_grey = 4;  // resolution of the steps' histogram
constexpr std::uint32_t one_in = 100;

std::int32_t sum_of_square(ImageView image, std::int32_t u0, std::int32_t v0) {
  std::int32_t sum = 0;
  for (std::int32_t v = v0; v < v0 + side; ++v) {
    const std::uint8_t* row = image.row(v) + u0;
    for (std::int32_t u = 0; u < side; ++u) sum += row[u];
  }
  return sum;
}

// Steps between neighbouring squares, counted by their size.
class Steps {
 public:
  void add(std::int32_t sum_a, std::int32_t sum_b) {
    const std::int32_t step = (std::max(sum_a, sum_b) - std::min(sum_a, sum_b)) * steps_a_grey / pixels_a_square;
    ++count_[static_cast<std::size_t>(std::min<std::int32_t>(step, last))];
    ++all_;
  }
  // The size that one in `one_in` exceeds.
  float rare() const {
    std::uint32_t above = 0;
    for (std::int32_t step = last; step > 0; --step) {
      above += count_[static_cast<std::size_t>(step)];
      if (above * one_in >= all_ && above > 0) return static_cast<float>(step) / steps_a_grey;
    }
    return 0;
  }

 private:
  static constexpr std::int32_t last = 255 * steps_a_grey;
  std::array<std::uint16_t, last + 1> count_{};  // 2 kB of stack; a picture of 1080p has 32,000 steps
  std::uint32_t all_ = 0;
};

}  // namespace

PictureLight picture_light(ImageView image) {
  PictureLight light;
  if (!image.valid()) return light;
  std::uint64_t sum = 0;
  std::uint32_t whites = 0;
  for (std::int32_t v = 0; v < image.height; ++v) {
    const std::uint8_t* row = image.row(v);
    for (std::int32_t u = 0; u < image.width; ++u) {
      sum += row[u];
      whites += row[u] == white ? 1 : 0;
    }
  }
  Steps steps;
  for (std::int32_t v = 0; v + side <= image.height; v += side) {
    std::int32_t before = 0;
    for (std::int32_t u = 0; u + side <= image.width; u += side) {
      const std::int32_t square = sum_of_square(image, u, v);
      if (u > 0) steps.add(square, before);
      before = square;
    }
  }
  const float pixels = static_cast<float>(image.width) * static_cast<float>(image.height);
  light.mean_grey = static_cast<float>(sum) / pixels;
  light.white_share = static_cast<float>(whites) / pixels;
  light.contrast_grey = steps.rare();
  light.noise_grey = pixel_noise_grey(PixelView<std::uint8_t>(image), white, NoiseAlong::rows);
  return light;
}

}  // namespace lf::scan
