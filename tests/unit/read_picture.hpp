// A picture file in blue, green and red.
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
  if (bytes.empty()) return {};
  const cv::Mat stored = vision::picture_codecs().decode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, bytes.data()));
  std::vector<cv::Mat> channels;
  cv::split(stored, channels);
  if (channels.size() < 3) channels.assign(3, channels.front());
  channels.resize(3);  // no transparency
  cv::Mat picture;
  cv::merge(channels, picture);
  return picture;
}

}  // namespace lf
