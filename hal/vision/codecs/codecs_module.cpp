// What picture_codecs() loads.
#include <opencv2/imgcodecs.hpp>

#include "hal/vision/codecs/picture_codecs.hpp"
#ifdef LANTERNFISH_VIDEO
#include <opencv2/videoio.hpp>
#endif

namespace lf::vision {
namespace {

bool encode(const std::string& ending, const cv::Mat& picture, std::vector<std::uint8_t>& bytes, const std::vector<int>& parameters) {
  return cv::imencode(ending, picture, bytes, parameters);
}

cv::Mat decode(const cv::Mat& bytes) { return cv::imdecode(bytes, cv::IMREAD_UNCHANGED | cv::IMREAD_IGNORE_ORIENTATION); }

bool write(const std::string& path, const cv::Mat& picture) { return cv::imwrite(path, picture); }

bool has_reader(const std::string& path) { return cv::haveImageReader(path); }

#ifdef LANTERNFISH_VIDEO
class FfmpegVideo : public Video {
 public:
  explicit FfmpegVideo(const std::string& path) : video_(path, cv::CAP_FFMPEG) {}
  bool is_open() const { return video_.isOpened(); }
  bool read(cv::Mat& picture) override { return video_.read(picture); }
  std::int64_t announced_frames() const override { return static_cast<std::int64_t>(video_.get(cv::CAP_PROP_FRAME_COUNT)); }

 private:
  cv::VideoCapture video_;
};

std::unique_ptr<Video> open_video(const std::string& path) {
  auto video = std::make_unique<FfmpegVideo>(path);
  if (!video->is_open()) return nullptr;
  return video;
}
#else
std::unique_ptr<Video> open_video(const std::string&) { return nullptr; }
#endif

constexpr PictureCodecs codecs{codecs_edition, sizeof(PictureCodecs), encode, decode, write, has_reader, open_video};

}  // namespace
}  // namespace lf::vision

extern "C" const lf::vision::PictureCodecs* lanternfish_picture_codecs() { return &lf::vision::codecs; }
