// Picture files and videos, by OpenCV's codecs.
//
// These bring some two hundred libraries along, which would take every start of a program 0.4 s. So they are a library of their own, loaded when the first picture is
// read or written.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace lf::vision {

class Video {
 public:
  virtual ~Video() = default;
  virtual bool read(cv::Mat& picture) = 0;            // false at its end
  virtual std::int64_t announced_frames() const = 0;  // by the container, which may only estimate them
};

// Of this table: a library of another edition is refused.
inline constexpr std::uint32_t codecs_edition = 1;

// As OpenCV's functions: pictures of several channels are blue, green, red.
struct PictureCodecs {
  std::uint32_t edition, size;
  bool (*encode)(const std::string& ending, const cv::Mat& picture, std::vector<std::uint8_t>& bytes, const std::vector<int>& parameters);
  cv::Mat (*decode)(const cv::Mat& bytes);  // as it is stored, not turned; empty where that fails
  bool (*write)(const std::string& path, const cv::Mat& picture);
  bool (*has_reader)(const std::string& path);                    // for a picture
  std::unique_ptr<Video> (*open_video)(const std::string& path);  // null where that fails, and in a build without the simulator
};

// Loads them at the first call, from ../lib/lanternfish or ../lib beside the program's folder. Throws InputError when the library is not there, is cut off, or is of
// another edition.
const PictureCodecs& picture_codecs();

}  // namespace lf::vision
