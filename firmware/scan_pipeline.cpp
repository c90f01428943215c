#include "firmware/scan_pipeline.hpp"

#include <algorithm>
#include <cstring>

#include "firmware/arm/collision.hpp"
#include "firmware/arm/kinematics.hpp"
#include "firmware/scan/picture_light.hpp"
#include "firmware/scan/stripe_finder.hpp"

namespace lf {
namespace {

// The jaw is closed while the arm scans.
constexpr double jaw_while_scanning_rad = 0;
// Of the links only forearm, wrist and fingers come before the panel.
constexpr std::size_t first_seen_link = 3;

// Of every eighth row: noise in 38,400 pixels. FNV-1a by eight pixels at a time, 5 us on a desktop.
constexpr std::int32_t rows_a_sample = 8;

Duration distance(Time a, Time b) { return a < b ? b - a : a - b; }

// Haze is as wide in angle for every camera.
scan::RefinerConfig scaled(scan::RefinerConfig config, const CameraCalibration& camera) {
  constexpr double near_haze_rad = 0.0221;
  if (camera.intrinsics.fy > 0) config.haze_near_px = static_cast<float>(near_haze_rad * camera.intrinsics.fy);
  return config;
}

scan::PlaneFitter::Config toward_camera(scan::PlaneFitter::Config config, const CameraCalibration& camera) {
  config.toward_m = camera.base_from_camera.translation();
  return config;
}

}  // namespace

template <ScanCapacity capacity>
BasicScanPipeline<capacity>::BasicScanPipeline(const ScanConfig& config)
    : config_(config),
      detector_(config.peaks),
      refiner_(scaled(config.refiner, config.camera)),
      triangulator_(config.camera, config.laser, config.triangulation) {
  config_.plane = toward_camera(config.plane, config.camera);
}

template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::on_command(const ScanCommand& command) {
  switch (command.kind) {
    case ScanCommand::Kind::joint_sample:
      if (!joints_.add(command.joints)) ++stats_.commands_refused;
      add_points(false);
      return;
    case ScanCommand::Kind::exposure: expect(command); return;
    case ScanCommand::Kind::begin_sweep: begin_sweep(command.sweep); return;
    case ScanCommand::Kind::end_sweep: sweeping_ = false; return;
    case ScanCommand::Kind::analyse: analyse(command.sweep); return;
    case ScanCommand::Kind::drop_exposure: drop(command.exposure_start); return;
  }
  ++stats_.commands_refused;
}

template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::begin_sweep(std::uint32_t sweep) {
  forget_exposures(exposures_.size());
  stripes_.clear();
  cloud_.clear();
  // Light and water may have changed: the stripe is learned anew.
  refiner_.begin_anew();
  detector_.follow(0);
  stats_.stripe = {};
  // Between sweeps the arm, its shadow and what it turned have moved.
  background_.present = false;
  still_.present = false;
  request_ready_ = false;
  request_.id = sweep;
  stripes_seen_ = 0;
  m_per_px_ = shape_shifts_m_ = 0;
  late_shape_doubt_px_ = scan::LateMean(late_points);
  sweeping_ = true;
}

template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::expect(const ScanCommand& command) {
  if (any_order_ && command.exposure_start <= last_order_) {
    ++stats_.commands_refused;
    return;
  }
  any_order_ = true;
  last_order_ = command.exposure_start;
  if (exposures_.full()) forget_exposures(1);
  (void)exposures_.push_back({.start = command.exposure_start,
                              .kind = command.exposure_kind,
                              .trigger = command.trigger,
                              .frame = frames_ordered_,
                              .in_sweep = sweeping_});
  ++frames_ordered_;
}

// The image of a dropped exposure may be on its way, or have come already.
template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::drop(Time start) {
  for (Exposure& exposure : exposures_) {
    if (exposure.start != start) continue;
    exposure.dropped = true;
    return;
  }
  bool known = false;
  for (StoredImage* image : {&background_, &still_}) {
    if (!image->present || image->start != start) continue;
    image->present = false;
    known = true;
  }
  for (Stripe& stripe : stripes_) {
    if (stripe.start != start) continue;
    stripe.count = 0;
    known = true;
  }
  ++(known ? stats_.images_refused : stats_.commands_refused);
}

// The oldest `count` exposures have no image.
template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::forget_exposures(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) stats_.images_missing += exposures_[i].dropped ? 0 : 1;
  std::copy(exposures_.begin() + count, exposures_.end(), exposures_.begin());
  for (std::size_t i = 0; i < count; ++i) exposures_.pop_back();
}

template <ScanCapacity capacity>
bool BasicScanPipeline<capacity>::is_of(const Image& image, const Exposure& exposure) const {
  if (image.trigger >= 0) return image.trigger == exposure.trigger;
  return distance(exposure.start, image.exposure_start) <= config_.match_window;
}

// Takes the exposure that `image` is of off the list, with those before it: images come in the order of their exposures.
template <ScanCapacity capacity>
bool BasicScanPipeline<capacity>::match(const Image& image, Exposure& exposure) {
  for (std::size_t i = 0; i < exposures_.size(); ++i) {
    if (!is_of(image, exposures_[i])) continue;
    exposure = exposures_[i];
    forget_exposures(i);
    std::copy(exposures_.begin() + 1, exposures_.end(), exposures_.begin());
    exposures_.pop_back();
    return true;
  }
  return false;
}

// Its start is the instant that was ordered, by which a later `drop_exposure` calls it, not the camera's stamp.
template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::store(const Image& image, const Exposure& exposure, StoredImage& out) {
  for (std::int32_t v = 0; v < image_height; ++v)
    std::copy_n(image.view.row(v), image_width, out.pixels.data() + static_cast<std::ptrdiff_t>(v) * image_width);
  out.start = exposure.start;
  out.frame = exposure.frame;
  out.mid_exposure = image.mid_exposure();
  out.present = true;
}

template <ScanCapacity capacity>
bool BasicScanPipeline<capacity>::repeats(const Image& image) {
  static_assert(image_width % 8 == 0);
  std::uint64_t pixels = 0xcbf29ce484222325u, white = ~std::uint64_t{0};
  for (std::int32_t v = 0; v < image_height; v += rows_a_sample) {
    const std::uint8_t* row = image.view.row(v);
    for (std::int32_t u = 0; u < image_width; u += 8) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, row + u, sizeof eight);
      pixels = (pixels ^ eight) * 0x100000001b3u;
      white &= eight;
    }
  }
  // Pictures that are white everywhere are alike because of the light.
  const bool again = pixels == last_pixels_ && white != ~std::uint64_t{0};
  last_pixels_ = pixels;
  return again;
}

template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::on_image(std::uint8_t camera, const Image& received) {
  if (camera != config_.camera_index) return;
  Exposure exposure;
  if (!match(received, exposure)) {
    ++stats_.images_unexpected;
    return;
  }
  Image image = received;
  if (image.trigger >= 0) image.exposure_start = exposure.start;  // joints are sampled at the same SYNC, and are known by the same time
  const bool well_formed =
      image.view.valid() && image.view.width == image_width && image.view.height == image_height && image.exposure > Duration();
  if (well_formed && repeats(image)) {
    ++stats_.images_repeated;
    return;
  }
  stats_.newest_exposure = exposure.start;
  if (!well_formed || exposure.dropped) {
    ++stats_.images_refused;
    return;
  }
  ++stats_.images;
  switch (exposure.kind) {
    case ExposureKind::laser_on:
      measure(image, exposure);
      add_points(false);
      return;
    case ExposureKind::background: store(image, exposure, background_); return;
    case ExposureKind::still:
      store(image, exposure, still_);
      ++stats_.stills;
      stats_.still = scan::picture_light(image.view);
      return;
    case ExposureKind::monitor: return;
  }
}

// The newest image without the laser, or an empty view where it is older than two rounds. The second round bridges a background that was lost. Over more rounds
// the hand moves too far, and its old outline would be taken for stripes.
template <ScanCapacity capacity>
ImageView BasicScanPipeline<capacity>::background_of(const Exposure& exposure) const {
  const std::uint32_t age_frames = exposure.frame - background_.frame;
  return background_.present && age_frames < 2 * config_.frames_per_background ? view(background_) : ImageView{};
}

// The stripe's peaks; those of a sweep wait for their joints.
template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::measure(const Image& image, const Exposure& exposure) {
  const ImageView background = background_of(exposure);
  last_peaks_count_ = scan::find_stripe(detector_, refiner_, image.view, background, last_peaks_);
  last_peaks_time_ = image.mid_exposure();
  const scan::PeakCounters& counters = detector_.counters();
  stats_.peaks = static_cast<std::uint32_t>(refiner_.counters().refined);
  stats_.peaks_weak = static_cast<std::uint32_t>(counters.weak);
  stats_.peaks_saturated = static_cast<std::uint32_t>(counters.saturated);
  stats_.peaks_unfitted = static_cast<std::uint32_t>(refiner_.counters().not_fitted);
  stats_.peaks_misfit = static_cast<std::uint32_t>(refiner_.counters().misfits);
  if (!exposure.in_sweep) return;
  ++stats_.stripes;
  if (stripes_.full()) add_points(true);
  Stripe& stripe = *stripes_.extend();
  stripe.start = exposure.start;
  stripe.mid_exposure = image.mid_exposure();
  stripe.form = learned();
  stripe.shape_doubt_px = refiner_.shape_doubt_px();
  stripe.count = last_peaks_count_;
  std::copy_n(last_peaks_.begin(), last_peaks_count_, stripe.peaks.begin());
}

template <ScanCapacity capacity>
StripeForm BasicScanPipeline<capacity>::learned() const {
  if (!refiner_.begun()) return {};
  const scan::StripeOptics& optics = refiner_.optics();
  return {scan::width_in_picture_px(optics), optics.lens_px, optics.scatter, optics.skew, refiner_.noise().speckle, refiner_.noise().model};
}

// Stripes whose joints are known become points, oldest first; `final` leaves none waiting.
template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::add_points(bool final) {
  std::size_t done = 0;
  while (done < stripes_.size() && add_points(stripes_[done], final)) ++done;
  if (done == 0) return;
  std::copy(stripes_.begin() + done, stripes_.end(), stripes_.begin());
  for (std::size_t i = 0; i < done; ++i) stripes_.pop_back();
}

// False when the stripe has to wait.
template <ScanCapacity capacity>
bool BasicScanPipeline<capacity>::add_points(const Stripe& stripe, bool final) {
  PerArmJoint<double> q_rad{};
  const scan::JointHistory::Outcome outcome =
      stripe.count == 0 ? scan::JointHistory::Outcome::done : joints_.at(stripe.mid_exposure, final, q_rad);
  if (outcome == scan::JointHistory::Outcome::wait) return false;
  ++stripes_taken_;
  newest_taken().mid_exposure = stripe.mid_exposure;
  newest_taken().count = 0;
  if (stripe.count == 0) return true;
  if (outcome != scan::JointHistory::Outcome::done) {
    stats_.points_no_joints += static_cast<std::uint32_t>(stripe.count);
    return true;
  }
  const arm::JointVector q(q_rad.data());
  const Pose base_from_laser = config_.arm.base_from_laser(q, config_.laser);
  arm_ = config_.arm.link_capsules(q, jaw_while_scanning_rad);
  const std::span<const scan::Peak> peaks = std::span(stripe.peaks).first(stripe.count);
  const std::span<std::uint8_t> chains = std::span(chains_).first(peaks.size());
  scan::measure_chains(peaks, config_.chain.step_px, chains);
  const std::uint32_t apart = std::max<std::uint32_t>(config_.columns_apart, 1u);
  if (*std::max_element(chains.begin(), chains.end()) < config_.chain.panel_columns(config_.camera.intrinsics.fx)) {
    stats_.peaks_apart += static_cast<std::uint32_t>(peaks.size()) / apart;
    return true;
  }
  // Beyond the panel there are specks and edges, whose shape is no stripe's.
  stats_.stripe = stripe.form;
  const double m_per_px_before = m_per_px_;
  const std::size_t points_before = cloud_.points().size();
  const std::uint32_t shift = stripes_seen_++ % apart;
  for (std::size_t begin = 0; begin < peaks.size();) {
    std::size_t end = begin + 1;
    while (end < peaks.size() && peaks[end].u_px == peaks[begin].u_px) ++end;
    const auto column = static_cast<std::uint32_t>(std::max(peaks[begin].u_px, 0.f));
    if (column % apart == shift) add_column(peaks.subspan(begin, end - begin), chains.subspan(begin, end - begin), base_from_laser);
    begin = end;
  }
  shape_shifts_m_ += static_cast<double>(stripe.shape_doubt_px) * (m_per_px_ - m_per_px_before);
  late_shape_doubt_px_.add(static_cast<double>(stripe.shape_doubt_px), static_cast<double>(cloud_.points().size() - points_before));
  return true;
}

// Whether the arm's hand stands in the line of sight: what is seen there is the hand, lit by its own laser, or the edge that it moved.
template <ScanCapacity capacity>
bool BasicScanPipeline<capacity>::behind_arm(const Vec3& point_m) const {
  const arm::Capsule sight{.link = 0, .a_m = config_.camera.base_from_camera.translation(), .b_m = point_m, .radius_m = 0};
  return std::any_of(arm_.begin(), arm_.end(), [&](const arm::Capsule& link) {
    return link.link >= first_seen_link && arm::clearance_between(sight, link) < config_.silhouette_margin_m;
  });
}

// Where more of a column's peaks could be points than it can show, none is believed.
template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::add_column(std::span<const scan::Peak> peaks, std::span<const std::uint8_t> chains,
                                             const Pose& base_from_laser) {
  const int part_columns = config_.chain.part_columns(config_.camera.intrinsics.fx);
  StaticVector<CloudPoint, scan::max_peaks_per_line> points;
  StaticVector<Eigen::Vector2f, scan::max_peaks_per_line> seen;
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    const scan::Peak& peak = peaks[i];
    if (chains[i] < part_columns) {
      ++stats_.peaks_apart;
      continue;
    }
    const std::optional<Vec3> point_m = triangulator_.point(Vec2(peak.u_px, peak.v_px), base_from_laser);
    if (!point_m || behind_arm(*point_m)) continue;
    (void)points.push_back({.p_m = point_m->cast<float>(), .amplitude = peak.amplitude});
    (void)seen.push_back({peak.u_px, peak.v_px});
  }
  if (points.size() > points_a_column) {
    ++stats_.peaks_ambiguous;
    return;
  }
  const Vec3 eye_m = config_.camera.base_from_camera.translation(), normal = base_from_laser.linear().col(0);
  for (const CloudPoint& point : points) {
    const bool added = cloud_.add(point);
    ++(added ? stats_.points : stats_.points_overflowed);
    if (!added) continue;
    // A pixel's width at the point's distance, over the sine of the angle between ray and laser's plane.
    const Vec3 ray_m = point.p_m.cast<double>() - eye_m;
    m_per_px_ += ray_m.squaredNorm() / (config_.camera.intrinsics.fy * std::abs(ray_m.dot(normal)));
  }
  Taken& taken = newest_taken();
  for (const Eigen::Vector2f& place : seen) {
    if (taken.count < taken.places_px.size()) taken.places_px[taken.count++] = place;
  }
}

template <ScanCapacity capacity>
void BasicScanPipeline<capacity>::analyse(std::uint32_t sweep) {
  forget_exposures(exposures_.size());
  add_points(true);
  sweeping_ = false;
  request_.id = sweep;
  request_.fit = fitter_.fit(cloud_.points(), config_.plane);
  if (!cloud_.points().empty()) {
    const auto points = static_cast<double>(cloud_.points().size());
    request_.fit.shape_shift_m = std::max(shape_shifts_m_, late_shape_doubt_px_.mean() * m_per_px_) / points;
    request_.fit.depth_m_per_rad = m_per_px_ * config_.camera.intrinsics.fy / points;
  }
  request_.has_still = still_.present;
  request_.still_time = still_.mid_exposure;
  request_ready_ = true;
}

template <ScanCapacity capacity>
bool BasicScanPipeline<capacity>::take_request(PanelRequest& request) {
  if (!request_ready_) return false;
  request = request_;
  request_ready_ = false;
  return true;
}

template class BasicScanPipeline<full_scan>;
template class BasicScanPipeline<compact_scan>;
template class BasicScanPipeline<small_scan>;

}  // namespace lf
