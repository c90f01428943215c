// `lanternfish markers`: markers in the user's images and videos. Hosted side only.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/vision/image_file.hpp"
#include "hal/vision/marker_detector.hpp"

namespace lf::vision {

struct MarkerFilesOptions {
  MarkerDetectorConfig detector;
  Channel channel = Channel::grey;
  std::optional<CameraIntrinsics> camera;  // with `size_m`, poses are computed
  double size_m = 0;                       // side of the black square
  std::string overlay_path;  // of a PNG of the first frame with a marker (the first frame without any), markers drawn in; empty: none
};

struct MarkerInFrame {
  DetectedMarker marker;
  std::optional<MarkerPose> pose;
};

struct MarkerFrame {
  std::string source;
  std::int64_t frame = 0;  // within its video; 0 for an image
  std::vector<MarkerInFrame> markers;
};

// Why the marker's pose is doubtful: another tilt explains its corners nearly as well. Empty: it is not, or there is no pose.
std::string doubt_of(const MarkerInFrame& found);

// One entry a frame, in the order of the files. Throws InputError for a file that is neither an image nor a video or is truncated, for a
// calibration of another image size, and for an overlay that cannot be written.
std::vector<MarkerFrame> find_markers_in_files(const std::vector<std::string>& paths, const MarkerFilesOptions& options);

// As a JSON array: source, frame, markers with id, corners, margin, pose or null, and `doubts`.
std::string marker_frames_json(const std::vector<MarkerFrame>& frames);

}  // namespace lf::vision
