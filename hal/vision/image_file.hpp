// Grey images from the files users have: PNG, JPEG and what else OpenCV reads, 8 or 16 bit. Hosted side only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/messages/image.hpp"

namespace lf::vision {

// An excess is a channel less the mean of the other two, at least 0: of one colour picture what has the laser's colour. A grey picture has none.
enum class Channel { grey, red, green, blue, red_excess, green_excess, blue_excess };

// "grey", "red", "green", "blue", their first letters, "red-excess" and so on. Throws InputError for anything else.
inline constexpr const char* channel_names = "grey, red, green, blue (or r, g, b), red-excess, green-excess, blue-excess";
Channel channel_from_name(const std::string& name);

// 8-bit grey pixels that own their storage, rows without padding.
struct GreyImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<std::uint8_t> pixels;

  ImageView view() const { return {pixels.data(), width, height, width}; }
};

// Reads one image. Of 16-bit images the 8 bits below the highest used one are kept, counted in steps of two from 8 (10-, 12- and 14-bit cameras).
// Throws InputError for a file that is missing, no image, or truncated (also where the decoder would have filled up with grey).
GreyImage read_image_file(const std::string& path, Channel channel = Channel::grey);

// The same with all its bits, 8 or 16.
struct DeepImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  bool deep = false;                  // 16 bits a pixel in the file
  std::vector<std::uint8_t> pixels8;  // one of the two is filled
  std::vector<std::uint16_t> pixels16;
};
DeepImage read_deep_image(const std::string& path, Channel channel = Channel::grey);

}  // namespace lf::vision
