// A picture file as it is stored; of several channels blue, green, red.
#pragma once

#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "hal/vision/codecs/picture_codecs.hpp"

namespace lf {

inline cv::Mat read_picture(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  return bytes.empty() ? cv::Mat() : vision::picture_codecs().decode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, bytes.data()));
}

}  // namespace lf
