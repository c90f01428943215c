#include "host_sim/record/png.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "hal/vision/codecs/picture_codecs.hpp"
#include "shared/input_error.hpp"

namespace lf::record {
namespace {

std::vector<std::uint8_t> encode(const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  // A noisy camera frame takes 23 ms and 244 kB at level 3, 16 ms and 287 kB at 1, 68 ms and 258 kB at 6.
  if (!vision::picture_codecs().encode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1}))
    throw InputError("an image cannot be encoded as PNG");
  return bytes;
}

}  // namespace

RgbImage::RgbImage(std::int32_t width_px, std::int32_t height_px, std::array<std::uint8_t, 3> fill) : width(width_px), height(height_px) {
  const auto count = static_cast<std::size_t>(std::max(0, width_px)) * static_cast<std::size_t>(std::max(0, height_px));
  pixels.reserve(count * 3);
  for (std::size_t i = 0; i < count; ++i) pixels.insert(pixels.end(), fill.begin(), fill.end());
}

void RgbImage::set(std::int32_t u, std::int32_t v, std::array<std::uint8_t, 3> colour) {
  if (u < 0 || v < 0 || u >= width || v >= height) return;
  std::copy(colour.begin(), colour.end(), pixels.begin() + (static_cast<std::ptrdiff_t>(v) * width + u) * 3);
}

RgbImage rgb_from_grey(ImageView image) {
  RgbImage picture;
  if (!image.valid()) return picture;
  picture.width = image.width;
  picture.height = image.height;
  picture.pixels.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  for (std::int32_t v = 0; v < image.height; ++v) {
    for (std::int32_t u = 0; u < image.width; ++u) picture.pixels.insert(picture.pixels.end(), 3, image.at(u, v));
  }
  return picture;
}

RgbImage overlay_peaks(ImageView image, std::span<const PixelPoint> peaks, float gain) {
  RgbImage picture = rgb_from_grey(image);
  for (std::uint8_t& value : picture.pixels) value = static_cast<std::uint8_t>(std::clamp(gain * static_cast<float>(value), 0.f, 255.f));
  constexpr std::array<std::uint8_t, 3> red{255, 24, 24};
  for (const PixelPoint& peak : peaks) {
    if (!(std::abs(peak.u) < 1e6f && std::abs(peak.v) < 1e6f)) continue;
    const auto u = static_cast<std::int32_t>(std::lround(peak.u));
    const auto v = static_cast<std::int32_t>(std::lround(peak.v));
    picture.set(u, v, red);
    picture.set(u, v + (peak.v > static_cast<float>(v) ? 1 : -1), red);  // two pixels: seen also where the report scales the image down
  }
  return picture;
}

void draw_outline(RgbImage& image, std::span<const PixelPoint> corners, std::array<std::uint8_t, 3> colour) {
  if (image.pixels.empty() || corners.empty()) return;
  cv::Mat picture(image.height, image.width, CV_8UC3, image.pixels.data());
  std::vector<cv::Point> outline;
  for (const PixelPoint& corner : corners) {
    if (!(std::abs(corner.u) < 1e4f && std::abs(corner.v) < 1e4f)) return;
    outline.emplace_back(static_cast<int>(std::lround(corner.u)), static_cast<int>(std::lround(corner.v)));
  }
  cv::polylines(picture, outline, true, cv::Scalar(colour[0], colour[1], colour[2]), 1, cv::LINE_8);
}

std::vector<std::uint8_t> encode_png(ImageView image) {
  if (!image.valid()) throw InputError("an empty image cannot be written as PNG");
  return encode(cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data), static_cast<std::size_t>(image.stride)));
}

std::vector<std::uint8_t> encode_png(const RgbImage& image) {
  if (image.pixels.empty()) throw InputError("an empty image cannot be written as PNG");
  cv::Mat swapped;
  cv::cvtColor(cv::Mat(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.pixels.data())), swapped, cv::COLOR_RGB2BGR);
  return encode(swapped);
}

std::vector<std::uint8_t> encode_jpeg(const RgbImage& image, int quality) {
  if (image.pixels.empty()) throw InputError("an empty image cannot be written as JPEG");
  cv::Mat swapped;
  cv::cvtColor(cv::Mat(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.pixels.data())), swapped, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> file;
  if (!vision::picture_codecs().encode(".jpg", swapped, file, {cv::IMWRITE_JPEG_QUALITY, quality}))
    throw InputError("this OpenCV writes no JPEG");
  return file;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = static_cast<std::uint32_t>(bytes[i]) << 16;
    if (count > 1) group |= static_cast<std::uint32_t>(bytes[i + 1]) << 8;
    if (count > 2) group |= bytes[i + 2];
    text += digits[group >> 18];
    text += digits[group >> 12 & 63];
    text += count > 1 ? digits[group >> 6 & 63] : '=';
    text += count > 2 ? digits[group & 63] : '=';
  }
  return text;
}

}  // namespace lf::record
