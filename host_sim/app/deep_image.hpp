// One channel of an image in its full depth, 8 or 16 bits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/vision/image_file.hpp"

namespace lf::app {

struct DeepImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  bool deep = false;                  // 16 bits a pixel in the file
  std::vector<std::uint8_t> pixels8;  // one of the two is filled
  std::vector<std::uint16_t> pixels16;
};

// Throws InputError as vision::read_image_file.
DeepImage read_deep_image(const std::string& path, vision::Channel channel);

}  // namespace lf::app
