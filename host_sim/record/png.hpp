// Pictures for the run folder and the report.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/messages/image.hpp"

namespace lf::record {

// 8-bit RGB, rows without padding.
struct RgbImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<std::uint8_t> pixels;

  RgbImage() = default;
  RgbImage(std::int32_t width_px, std::int32_t height_px, std::array<std::uint8_t, 3> fill = {0, 0, 0});
  void set(std::int32_t u, std::int32_t v, std::array<std::uint8_t, 3> colour);  // outside the image: nothing
};

struct PixelPoint {
  float u = 0, v = 0;  // pixel centres at integers
};

RgbImage rgb_from_grey(ImageView image);

// The image in grey with each peak as a red dot, as in the paper's Fig. 12. `gain` brightens the background, 1 leaves it.
RgbImage overlay_peaks(ImageView image, std::span<const PixelPoint> peaks, float gain = 1);

// A closed polygon, one pixel wide.
void draw_outline(RgbImage& image, std::span<const PixelPoint> corners, std::array<std::uint8_t, 3> colour);

// PNG files in memory. Throw InputError when the image is empty.
std::vector<std::uint8_t> encode_png(ImageView image);
std::vector<std::uint8_t> encode_png(const RgbImage& image);

// A JPEG file in memory, for the report: a noisy picture takes a fifth of its PNG. `quality` of 0 to 100. Throws InputError when the image is empty.
std::vector<std::uint8_t> encode_jpeg(const RgbImage& image, int quality = 85);

// RFC 4648 with padding, one line.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace lf::record
