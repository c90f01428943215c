// The front door of the vision thread: images and orders in, cloud and plane out.
//
// It shares no state with the controller; `ScanCommand`s come over a ring. A laser-on image becomes peaks at once and points as soon as the joint
// samples around its mid-exposure are there. While the vehicle is docked camera and panel are still: the newest laser-off image serves all
// stripes that follow it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/scan/cloud.hpp"
#include "firmware/scan/joint_history.hpp"
#include "firmware/scan/peaks.hpp"
#include "firmware/scan/plane.hpp"
#include "firmware/scan/triangulate.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/image.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/scan_messages.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf {

struct ScanConfig {
  CameraCalibration camera;
  LaserCalibration laser;
  std::uint8_t camera_index = 0;  // whose images are measured
  scan::PeakConfig peaks;
  scan::Triangulator::Config triangulation;
  scan::PlaneFitter::Config plane{.tight_sigmas = 2.5};
};

class ScanPipeline {
 public:
  static constexpr std::int32_t image_width = 640;
  static constexpr std::int32_t image_height = 480;

  explicit ScanPipeline(const ScanConfig& config);

  // Orders in the order of their times; what is not is refused and counted.
  void on_command(const ScanCommand& command);

  // An image of camera `camera`; only read during the call. It is matched with the exposure ordered within 2 ms of its start; without one it is
  // refused and counted, as is one of another size than 640x480.
  void on_image(std::uint8_t camera, const Image& image);

  // Once after each `analyse`: the plane of the cloud, and whether `still()` holds a picture for the marker.
  bool take_request(PanelRequest& request);

  std::span<const CloudPoint> cloud() const { return cloud_.points(); }
  ImageView still() const { return {still_.pixels.data(), image_width, image_height, image_width}; }
  bool has_still() const { return still_.present; }

  // Of the newest laser-on image, for the report.
  std::span<const scan::Peak> last_peaks() const { return {last_peaks_.data(), last_peaks_count_}; }
  Time last_peaks_time() const { return last_peaks_time_; }

  const ScanStats& stats() const { return stats_; }

 private:
  struct Exposure {
    Time start;
    ExposureKind kind = ExposureKind::laser_on;
    bool dropped = false;
  };
  struct StoredImage {
    std::array<std::uint8_t, static_cast<std::size_t>(image_width) * image_height> pixels{};
    Time start;
    Time mid_exposure;
    bool present = false;
  };
  // A stripe whose joint samples are still to come.
  struct Stripe {
    Time start;
    Time mid_exposure;
    std::size_t count = 0;
    std::array<scan::Peak, image_width> peaks{};
  };

  ScanConfig config_;
  scan::PeakDetector detector_;
  scan::Triangulator triangulator_;
  scan::JointHistory joints_;
  scan::PlaneFitter fitter_;
  scan::Cloud cloud_;
  StoredImage background_;
  StoredImage still_;
  ScanStats stats_;
  std::array<scan::Peak, image_width> last_peaks_{};
  std::size_t last_peaks_count_ = 0;
  Time last_peaks_time_;
};

}  // namespace lf
