#include "hal/vision/marker_files.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>

#include "hal/vision/codecs/picture_codecs.hpp"
#include "hal/vision/panel_vision.hpp"
#include "hal/vision/pixels.hpp"
#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf::vision {
namespace {

class MarkerFinder {
 public:
  explicit MarkerFinder(const MarkerFilesOptions& options) : options_(options), detector_(options.detector) {}

  void look_in(const std::string& path) {
    if (picture_codecs().has_reader(path)) {
      const GreyImage image = read_image_file(path, options_.channel);
      look_at(path, 0, image.view());
    } else {
      look_in_video(path);
    }
  }

  void write_overlay() const {
    if (options_.overlay_path.empty() || overlay_image_.empty()) return;
    cv::Mat picture;
    cv::cvtColor(overlay_image_, picture, cv::COLOR_GRAY2BGR);
    for (const MarkerInFrame& found : frames_[overlay_frame_].markers) draw(picture, found.marker);
    bool written = false;
    try {
      written = picture_codecs().write(options_.overlay_path, picture);
    } catch (const cv::Exception&) {
      written = false;  // no encoder for that ending
    }
    if (!written) throw InputError(options_.overlay_path, 0, "cannot be written as a PNG");
  }

  std::vector<MarkerFrame> take() { return std::move(frames_); }

 private:
  void look_in_video(const std::string& path) {
    const std::unique_ptr<Video> video = picture_codecs().open_video(path);
    const auto refuse = [&] { throw InputError(path, 0, "is neither an image nor a video that can be decoded, or it is truncated"); };
    if (!video) refuse();
    const std::int64_t announced = video->announced_frames();
    std::int64_t frame = 0;
    for (cv::Mat picture; video->read(picture); ++frame) {
      const cv::Mat grey = one_channel(picture, options_.channel);
      look_at(path, frame, {grey.data, grey.cols, grey.rows, static_cast<std::int32_t>(grey.step)});
    }
    if (frame == 0) refuse();
    // Containers without an index only estimate their count, by duration times rate: one frame more or less.
    if (frame + 1 < announced) {
      throw InputError(path, 0, "the video is truncated: " + std::to_string(frame) + " of " + std::to_string(announced) + " frames");
    }
  }

  void look_at(const std::string& source, std::int64_t index, ImageView image) {
    const bool posed = options_.camera && options_.size_m > 0;
    if (posed && options_.camera->width > 0 && (options_.camera->width != image.width || options_.camera->height != image.height)) {
      throw InputError(source, 0,
                       "is " + std::to_string(image.width) + " x " + std::to_string(image.height) + " px, but the calibration is for " +
                           std::to_string(options_.camera->width) + " x " + std::to_string(options_.camera->height));
    }
    MarkerFrame frame{source, index, {}};
    for (const DetectedMarker& marker : detector_.detect(image)) {
      frame.markers.push_back({marker, posed ? marker_pose(marker.corners_px, options_.size_m, *options_.camera) : std::nullopt});
    }
    frames_.push_back(std::move(frame));
    keep_for_overlay(image);
  }

  // The first frame with a marker, else the first.
  void keep_for_overlay(ImageView image) {
    if (options_.overlay_path.empty()) return;
    const bool better = !frames_.back().markers.empty() && (overlay_image_.empty() || frames_[overlay_frame_].markers.empty());
    if (!overlay_image_.empty() && !better) return;
    overlay_frame_ = frames_.size() - 1;
    overlay_image_.create(image.height, image.width, CV_8U);
    for (int v = 0; v < image.height; ++v) std::copy_n(image.row(v), image.width, overlay_image_.ptr(v));
  }

  static void draw(cv::Mat& picture, const DetectedMarker& marker) {
    constexpr int shift = 4;  // sixteenths of a pixel
    std::vector<cv::Point> outline;
    for (const Vec2& corner : marker.corners_px) {
      outline.emplace_back(static_cast<int>(std::lround(corner.x() * (1 << shift))),
                           static_cast<int>(std::lround(corner.y() * (1 << shift))));
    }
    const cv::Scalar red(40, 40, 230);
    cv::polylines(picture, outline, true, red, 2, cv::LINE_AA, shift);
    cv::circle(picture, outline[0], 4 << shift, red, cv::FILLED, cv::LINE_AA, shift);  // the bottom left corner: which way is up
    const cv::Point centre(static_cast<int>(marker.centre_px.x()), static_cast<int>(marker.centre_px.y()));
    cv::putText(picture, std::to_string(marker.id), centre, cv::FONT_HERSHEY_SIMPLEX, 0.7, cv::Scalar(60, 220, 60), 2, cv::LINE_AA);
  }

  const MarkerFilesOptions& options_;
  MarkerDetector detector_;
  std::vector<MarkerFrame> frames_;
  std::size_t overlay_frame_ = 0;
  cv::Mat overlay_image_;
};

nlohmann::ordered_json to_json(const MarkerInFrame& found) {
  nlohmann::ordered_json marker{{"id", found.marker.id}, {"corners", nlohmann::ordered_json::array()}, {"margin", found.marker.margin}};
  for (const Vec2& corner : found.marker.corners_px) marker["corners"].push_back({corner.x(), corner.y()});
  marker["pose"] = nullptr;
  if (found.pose) {
    const Vec3 t = found.pose->camera_from_tag.translation();
    const Eigen::Quaterniond q(found.pose->camera_from_tag.linear());
    marker["pose"] = {{"translation_m", {t.x(), t.y(), t.z()}},
                      {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}},
                      {"reprojection_rms_px", found.pose->reprojection_rms_px},
                      {"ambiguity", found.pose->ambiguity()}};
  }
  marker["doubts"] = nlohmann::ordered_json::array();
  if (const std::string doubt = doubt_of(found); !doubt.empty()) marker["doubts"].push_back(doubt);
  return marker;
}

// What FFmpeg and OpenCV would print about a broken file beside our one line.
void silence_decoders() {
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

}  // namespace

std::string doubt_of(const MarkerInFrame& found) {
  constexpr double alike_rad = rad_from_deg(1);  // no other tilt
  if (!found.pose || found.pose->ambiguity() >= PanelVisionConfig().full_ambiguity || found.pose->second_angle_rad() < alike_rad) return "";
  std::array<char, 240> text;
  (void)std::snprintf(
      text.data(), text.size(),
      "of id %d a second pose, %.0f deg from the first, explains the corners with %.1f times the error: its tilt is unsure. "
      "Take the picture from nearer by, with a wider lens, or sharper",
      found.marker.id, deg_from_rad(found.pose->second_angle_rad()), found.pose->ambiguity());
  return text.data();
}

std::vector<MarkerFrame> find_markers_in_files(const std::vector<std::string>& paths, const MarkerFilesOptions& options) {
  silence_decoders();
  MarkerFinder finder(options);
  for (const std::string& path : paths) {
    if (!std::filesystem::exists(path)) throw unreadable(path);
    if (std::filesystem::is_directory(path)) throw InputError(path, 0, "is a folder, not an image or a video");
    finder.look_in(path);
  }
  finder.write_overlay();
  return finder.take();
}

std::string marker_frames_json(const std::vector<MarkerFrame>& frames) {
  auto document = nlohmann::ordered_json::array();
  for (const MarkerFrame& frame : frames) {
    auto markers = nlohmann::ordered_json::array();
    for (const MarkerInFrame& found : frame.markers) markers.push_back(to_json(found));
    document.push_back({{"source", frame.source}, {"frame", frame.frame}, {"markers", std::move(markers)}});
  }
  return document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace lf::vision
