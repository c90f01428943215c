#include "host_sim/app/deep_image.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "shared/input_error.hpp"

namespace lf::app {

namespace {

cv::Mat one_channel(const cv::Mat& image, vision::Channel channel) {
  cv::Mat grey;
  if (image.channels() == 1) return image;
  if (channel == vision::Channel::grey) {
    cv::cvtColor(image, grey, image.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  } else {
    cv::extractChannel(image, grey, channel == vision::Channel::blue ? 0 : channel == vision::Channel::green ? 1 : 2);
  }
  return grey;
}

}  // namespace

DeepImage read_deep_image(const std::string& path, vision::Channel channel) {
  const vision::GreyImage checked = vision::read_image_file(path, channel);  // refuses what is missing, truncated or no image
  DeepImage image;
  image.width = checked.width;
  image.height = checked.height;
  const cv::Mat whole = cv::imread(path, cv::IMREAD_UNCHANGED);
  if (whole.empty() || whole.depth() != CV_16U) {
    image.pixels8 = checked.pixels;
    return image;
  }
  const cv::Mat grey = one_channel(whole, channel);
  image.deep = true;
  for (int v = 0; v < grey.rows; ++v)
    image.pixels16.insert(image.pixels16.end(), grey.ptr<std::uint16_t>(v), grey.ptr<std::uint16_t>(v) + grey.cols);
  return image;
}

}  // namespace lf::app
