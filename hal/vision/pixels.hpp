// OpenCV's images inside this folder: one channel of a decoded picture.
#pragma once

#include <opencv2/core.hpp>

#include "hal/vision/image_file.hpp"

namespace lf::vision {

// Of a BGR, BGRA or grey image of any depth; of a grey one every channel is the same.
cv::Mat one_channel(const cv::Mat& image, Channel channel);

}  // namespace lf::vision
