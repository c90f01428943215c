// The front door of the vision thread: images and orders in, cloud and plane out.
//
// It shares no state with the controller; `ScanCommand`s come over a ring. A laser-on image becomes peaks at once, and points as soon as the joint
// samples around its mid-exposure are there. While the vehicle is docked camera and panel are still: the newest laser-off image serves the
// stripes that follow it, until the second one after it is due: one that is lost is bridged. From then on stripes are measured without any.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/arm/kinematics.hpp"
#include "firmware/scan/cloud.hpp"
#include "firmware/scan/joint_history.hpp"
#include "firmware/scan/late_mean.hpp"
#include "firmware/scan/peak_refiner.hpp"
#include "firmware/scan/peaks.hpp"
#include "firmware/scan/plane.hpp"
#include "firmware/scan/stripe_chain.hpp"
#include "firmware/scan/triangulate.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/image.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/scan_messages.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf {

struct ScanConfig {
  arm::Arm arm = arm::arm5e();  // that carries the laser, and comes before the camera
  CameraCalibration camera;
  LaserCalibration laser;
  std::uint8_t camera_index = 0;  // whose images are measured
  scan::PeakConfig peaks{.peaks_per_line = 4};
  scan::RefinerConfig refiner;  // its haze is scaled to the camera
  scan::ChainConfig chain;
  scan::Triangulator::Config triangulation;
  // An image without a trigger counter belongs to the exposure ordered within this of its start; exposures are 40 ms apart. It covers the tick's lateness, the
  // camera's own delay, and how well its clock is known.
  Duration match_window = Duration::from_ms(2);
  // Points are taken of one column in so many, of another one in each stripe: where the camera is triggered more often than at 25 Hz, the same number of points
  // from more stripes.
  std::uint32_t columns_apart = 1;
  // One frame in so many is taken without the laser.
  std::uint32_t frames_per_background = 5;
  // Around the arm's outline: since the newest background, 0.16 s ago at most, the hand has moved by 6 mm at 40 mm/s; 4 mm more for the outline itself. For
  // one round after a lost background the outline may lie up to 8 mm farther off.
  double silhouette_margin_m = 0.010;
  // At 0.5 mm rms the marker's plate, 2 mm proud, is outside of the window.
  scan::PlaneFitter::Config plane{.tight_sigmas = 3.0};
};

// What the vision thread's memory is made for.
struct ScanCapacity {
  std::int32_t image_width = 640;  // px; images of another size are refused
  std::int32_t image_height = 480;
  // A sweep of 18.1 s at 25 Hz with one frame of five for the background and 640 columns gives at most 231,680 points.
  std::size_t cloud_points = 262'144;
  // A stripe waits for eight SYNCs, 32 ms: one frame's time, or four at 125 Hz. Beyond that for joint samples that come late.
  std::size_t stripes = 6;
  // Stripes whose points' places are kept for a report. In one turn all that wait may become points, and the one of a new image.
  std::size_t stripes_told = 1;
};

template <ScanCapacity capacity>
class BasicScanPipeline {
 public:
  static constexpr std::int32_t image_width = capacity.image_width;
  static constexpr std::int32_t image_height = capacity.image_height;
  static constexpr std::size_t max_peaks = scan::max_peaks_per_line * image_width;  // of an image

  // The planes' normals point to the side of the camera, whatever `config.plane.toward_m` says.
  explicit BasicScanPipeline(const ScanConfig& config);

  // Orders in the order of their times; what is not is refused and counted. `begin_sweep` empties cloud, background and still.
  // A sweep takes in the stripes ordered between its `begin_sweep` and `end_sweep`; `analyse` closes it: images that have not come by then count as
  // missing, and stripes still waiting for joint samples make do with those there are.
  void on_command(const ScanCommand& command);

  // An image of camera `camera`; only read during the call. It is matched with the exposure of its trigger counter, or, when it has none, with the one
  // ordered within `match_window` of its start; without one it is refused and counted, as is one of another size than the capacity's, or one whose pixels are
  // those of the image before: the noise of a sensor at work never repeats itself. Images of other cameras are passed over.
  void on_image(std::uint8_t camera, const Image& image);

  // Once after each `analyse`: the plane of the cloud, and whether `still()` holds a picture for the marker.
  bool take_request(PanelRequest& request);

  std::span<const CloudPoint> cloud() const { return cloud_.points(); }
  ImageView still() const { return view(still_); }
  bool has_still() const { return still_.present; }

  // Of the newest laser-on image, for the report.
  std::span<const scan::Peak> last_peaks() const { return {last_peaks_.data(), last_peaks_count_}; }
  Time last_peaks_time() const { return last_peaks_time_; }
  // A sweep's stripe whose joints are known: where those of its peaks are that became points, px. For the report, too.
  struct TakenStripe {
    Time mid_exposure;
    std::span<const Eigen::Vector2f> places_px;
  };
  // Stripes taken since construction. Those that waited for the same joints are taken at once, so the newest `taken_kept` of them can be read: `number` counts from 0.
  std::uint32_t stripes_taken() const { return stripes_taken_; }
  static constexpr std::uint32_t taken_kept = static_cast<std::uint32_t>(capacity.stripes_told);
  TakenStripe taken(std::uint32_t number) const {
    const Taken& stripe = taken_[number % taken_kept];
    return {stripe.mid_exposure, {stripe.places_px.data(), stripe.count}};
  }

  const ScanStats& stats() const { return stats_; }

 private:
  struct Exposure {
    Time start;
    ExposureKind kind = ExposureKind::laser_on;
    std::uint8_t trigger = 0;
    std::uint32_t frame = 0;  // counted from construction on
    bool in_sweep = false;
    bool dropped = false;
  };
  struct StoredImage {
    std::array<std::uint8_t, static_cast<std::size_t>(image_width) * image_height> pixels{};
    Time start;
    Time mid_exposure;
    std::uint32_t frame = 0;
    bool present = false;
  };
  // Peaks whose joint samples are still to come.
  struct Stripe {
    Time start;
    Time mid_exposure;
    StripeForm form;
    float shape_doubt_px = 0;
    std::size_t count = 0;
    std::array<scan::Peak, max_peaks> peaks{};
  };

  static ImageView view(const StoredImage& image) { return {image.pixels.data(), image_width, image_height, image_width}; }
  static void store(const Image& image, const Exposure& exposure, StoredImage& out);
  bool repeats(const Image& image);

  void begin_sweep(std::uint32_t sweep);
  void expect(const ScanCommand& command);
  void drop(Time start);
  void forget_exposures(std::size_t count);
  bool is_of(const Image& image, const Exposure& exposure) const;
  bool match(const Image& image, Exposure& exposure);
  ImageView background_of(const Exposure& exposure) const;
  void measure(const Image& image, const Exposure& exposure);
  StripeForm learned() const;
  void add_points(bool final);
  bool add_points(const Stripe& stripe, bool final);
  bool behind_arm(const Vec3& point_m) const;
  void add_column(std::span<const scan::Peak> peaks, std::span<const std::uint8_t> chains, const Pose& base_from_laser);
  void analyse(std::uint32_t sweep);

  // At 125 Hz and 0.2 s from trigger to image 25 are on their way; more are images that never came.
  static constexpr std::size_t max_exposures = 32;

  ScanConfig config_;
  scan::BasicPeakDetector<std::uint8_t, std::max(image_width, image_height)> detector_;
  scan::BasicPeakRefiner<std::uint8_t, image_width, image_height> refiner_;
  scan::Triangulator triangulator_;
  scan::JointHistory joints_;
  scan::PlaneFitter fitter_;
  scan::BasicCloud<capacity.cloud_points> cloud_;
  StaticVector<Exposure, max_exposures> exposures_;  // oldest first
  StaticVector<Stripe, capacity.stripes> stripes_;   // oldest first
  Time last_order_;
  std::uint32_t frames_ordered_ = 0;
  bool any_order_ = false;
  std::uint32_t stripes_seen_ = 0;  // of this sweep
  // Of its points, summed: metres along the ray a pixel, and by how much each may be off.
  double m_per_px_ = 0, shape_shifts_m_ = 0;
  // The beam is one over a sweep: the line's doubt at the end, over so many points, holds for all of them. They are of nine pictures in the default sweep; the
  // last alone may be half off the panel.
  static constexpr double late_points = 2000;
  scan::LateMean late_shape_doubt_px_{late_points};
  bool sweeping_ = false;
  std::uint64_t last_pixels_ = 0;  // what repeats() made of the image before
  StoredImage background_;
  StoredImage still_;
  PanelRequest request_;
  bool request_ready_ = false;
  arm::LinkCapsules arm_{};  // at the stripe under work
  ScanStats stats_;
  std::array<scan::Peak, max_peaks> last_peaks_{};
  std::size_t last_peaks_count_ = 0;
  Time last_peaks_time_;
  // A column shows the panel and at most one proud part in the laser's plane.
  static constexpr std::size_t points_a_column = 2;
  struct Taken {
    Time mid_exposure;
    std::size_t count = 0;
    std::array<Eigen::Vector2f, points_a_column * image_width> places_px;
  };
  Taken& newest_taken() { return taken_[(stripes_taken_ - 1) % taken_kept]; }
  std::array<Taken, taken_kept> taken_{};
  std::uint32_t stripes_taken_ = 0;
  std::array<std::uint8_t, max_peaks> chains_{};  // columns of the chain that each peak of the stripe under work stands in
};

// Every point of the slowest sweep. The cloud is 4.2 MB of it, two stored images 0.6, stripes 0.2, detector and refiner 0.2.
inline constexpr ScanCapacity full_scan{.stripes_told = 7};
using ScanPipeline = BasicScanPipeline<full_scan>;
static_assert(sizeof(ScanPipeline) <= 6 * 1024 * 1024, "a computer's, or a board's external 8 MB");

// What a board's build keeps less of an arm's shapes and joints than this one.
inline constexpr std::size_t desktop_arm =
    (capacity::arm_shapes - 16) * (sizeof(ArmModel::Capsule) + sizeof(arm::Capsule)) +
    (capacity::arm_joints - 4) * (scan::JointHistory::capacity * sizeof(double) + sizeof(ArmModel::Joint) + sizeof(Pose));

// Whole images, a quarter of the points: the camera triggered at 12.5 Hz (mission.camera_syncs 20), with every second column, fills it in the same sweep.
inline constexpr ScanCapacity compact_scan{.cloud_points = 65'536, .stripes = 2};
static_assert(sizeof(BasicScanPipeline<compact_scan>) <= 2 * 1024 * 1024 + desktop_arm, "a board's external 2 MB of static memory");

// Images of half the size, binned by the camera, at the same 12.5 Hz.
inline constexpr ScanCapacity small_scan{.image_width = 320, .image_height = 240, .cloud_points = 32'768, .stripes = 2};
static_assert(sizeof(BasicScanPipeline<small_scan>) <= 896 * 1024,
              "inside of the chip: an STM32H7A3's contiguous 1 MB, with an eighth to spare");

}  // namespace lf
