#include "hal/vision/image_file.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <string>
#include <string_view>

#include "hal/vision/codecs/picture_codecs.hpp"
#include "hal/vision/pixels.hpp"
#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf::vision {
namespace {

std::vector<char> read_bytes(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw InputError(path, 0, "is a folder, not an image");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw unreadable(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// A JPEG's scan ends with the marker FF D9, and its data cannot contain it (T.81, B.1.1.5): without it the file was cut off.
// libjpeg only warns and fills up with grey.
bool truncated_jpeg(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (!bytes.starts_with("\xFF\xD8"sv)) return false;
  const auto scan = bytes.rfind("\xFF\xDA"sv);
  const auto end = bytes.rfind("\xFF\xD9"sv);
  return scan == bytes.npos || end == bytes.npos || end < scan;
}

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(0, 4)) value = value << 8 | static_cast<std::uint8_t>(byte);
  return value;
}

// CRC-32 as PNG has it (ISO 3309).
std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

// What is wrong with a PNG, chunk by chunk up to IEND; nothing when it is sound, or none. libpng would say it in its own words, on stderr.
std::string fault_of_png(std::string_view bytes) {
  constexpr std::size_t signature = 8, around = 12;  // length, name, CRC
  constexpr std::uint32_t longest_side = 1'000'000;  // libpng's
  if (!bytes.starts_with("\x89PNG")) return "";
  for (std::size_t at = signature; at + around <= bytes.size();) {
    const std::size_t length = big_endian(bytes.substr(at));
    if (length > bytes.size() - at - around) break;
    const std::string_view chunk = bytes.substr(at + 4, 4 + length);
    if (crc32(chunk) != big_endian(bytes.substr(at + 8 + length))) return "the image is damaged: a checksum in it is wrong";
    if (chunk.starts_with("IHDR") && length >= 8) {
      const std::uint32_t width = big_endian(chunk.substr(4)), height = big_endian(chunk.substr(8));
      if (width > longest_side || height > longest_side)
        return "is an image of " + std::to_string(width) + "x" + std::to_string(height) + " pixels, more than can be decoded";
    }
    if (chunk.starts_with("IEND")) return "";
    at += around + length;
  }
  return "the image is truncated";
}

cv::Mat decode(const std::string& path, Channel channel) {
  const std::vector<char> bytes = read_bytes(path);
  const std::string_view text(bytes.data(), bytes.size());
  if (truncated_jpeg(text)) throw InputError(path, 0, "the image is truncated");
  if (const std::string fault = fault_of_png(text); !fault.empty()) throw InputError(path, 0, fault);
  cv::Mat image;
  try {
    const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    // The pixels as the sensor had them: no rotation by EXIF, which would contradict the calibration.
    if (!bytes.empty()) image = picture_codecs().decode(buffer);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) throw InputError(path, 0, "is no image that can be decoded");
  if (image.depth() != CV_8U && image.depth() != CV_16U) throw InputError(path, 0, "has neither 8 nor 16 bits a channel");
  return one_channel(image, channel);
}

// Bits in use, in steps of two: 8, 10, 12, 14 or 16.
int used_bits(const cv::Mat& image) {
  double largest = 0;
  cv::minMaxIdx(image, nullptr, &largest);
  int bits = 8;
  while (bits < 16 && largest >= (1 << bits)) bits += 2;
  return bits;
}

}  // namespace

namespace {

template <class Pixel>
void take_excess(const cv::Mat& image, int own, cv::Mat& excess) {
  const int channels = image.channels(), first = (own + 1) % 3, second = (own + 2) % 3;
  for (int v = 0; v < image.rows; ++v) {
    const Pixel* from = image.ptr<Pixel>(v);
    Pixel* to = excess.ptr<Pixel>(v);
    for (int u = 0; u < image.cols; ++u, from += channels)
      to[u] = static_cast<Pixel>(std::max(0, (2 * from[own] - from[first] - from[second] + 1) / 2));
  }
}

// `own`: OpenCV's place of the channel, blue 0 to red 2.
cv::Mat excess_of(const cv::Mat& image, int own) {
  cv::Mat excess(image.size(), CV_MAKETYPE(image.depth(), 1), cv::Scalar(0));
  if (image.channels() < 3) return excess;
  if (image.depth() == CV_16U) {
    take_excess<std::uint16_t>(image, own, excess);
  } else {
    take_excess<std::uint8_t>(image, own, excess);
  }
  return excess;
}

}  // namespace

cv::Mat one_channel(const cv::Mat& image, Channel channel) {
  if (channel == Channel::red_excess) return excess_of(image, 2);
  if (channel == Channel::green_excess) return excess_of(image, 1);
  if (channel == Channel::blue_excess) return excess_of(image, 0);
  cv::Mat grey;
  const int channels = image.channels();
  if (channels < 3) {
    cv::extractChannel(image, grey, 0);
  } else if (channel == Channel::grey) {
    cv::cvtColor(image, grey, channels == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  } else {
    cv::extractChannel(image, grey, channel == Channel::blue ? 0 : channel == Channel::green ? 1 : 2);
  }
  return grey;
}

Channel channel_from_name(const std::string& name) {
  if (name == "grey") return Channel::grey;
  if (name == "red" || name == "r") return Channel::red;
  if (name == "green" || name == "g") return Channel::green;
  if (name == "blue" || name == "b") return Channel::blue;
  if (name == "red-excess") return Channel::red_excess;
  if (name == "green-excess") return Channel::green_excess;
  if (name == "blue-excess") return Channel::blue_excess;
  throw InputError("unknown channel '" + name + "': " + channel_names);
}

GreyImage read_image_file(const std::string& path, Channel channel) {
  cv::Mat grey = decode(path, channel);
  if (grey.depth() == CV_16U) {
    const int shift = used_bits(grey) - 8;
    cv::Mat upper(grey.size(), CV_8U);
    std::transform(grey.begin<std::uint16_t>(), grey.end<std::uint16_t>(), upper.begin<std::uint8_t>(),
                   [shift](std::uint16_t value) { return static_cast<std::uint8_t>(value >> shift); });
    grey = upper;
  }
  return {grey.cols, grey.rows, {grey.begin<std::uint8_t>(), grey.end<std::uint8_t>()}};
}

DeepImage read_deep_image(const std::string& path, Channel channel) {
  const cv::Mat grey = decode(path, channel);
  DeepImage image{grey.cols, grey.rows, grey.depth() == CV_16U, {}, {}};
  if (image.deep) {
    image.pixels16.assign(grey.begin<std::uint16_t>(), grey.end<std::uint16_t>());
  } else {
    image.pixels8.assign(grey.begin<std::uint8_t>(), grey.end<std::uint8_t>());
  }
  return image;
}

}  // namespace lf::vision
