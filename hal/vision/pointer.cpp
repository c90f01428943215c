#include "hal/vision/pointer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "firmware/scan/camera_model.hpp"

namespace lf::vision {
namespace {

constexpr double step_m = 0.001;        // between samples along the bar: half a pixel
constexpr double end_margin_m = 0.006;  // of the bar that is left out at its ends: two pixels where it is foreshortened most
constexpr double edge_blur_m = 0.003;   // half width of the paint's edge as a lens of 1 px shows it
constexpr std::array<double, 3> edge_errors_m{-0.003, 0.0,
                                              0.003};  // the marker's place, 3 mm at worst, shifts the paint's edge along the bar
constexpr double min_face_px = 0.8;                    // a face that is seen narrower shows its neighbours
constexpr double grazing_cosine = 0.10;
constexpr double still_floor_grey = 1.0, cloud_floor_grey = 2.0;  // read noise of 3 grey levels, averaged over what a sample covers
constexpr double grain = 0.02;  // of the level: texture, and light that does not fall off in a straight line
constexpr double top_window_m =
    0.004;                       // half the thickness of the layer whose points lie on the bar's top: 5 sigma of the cloud in turbid water
constexpr double bin_m = 0.002;  // of the laser's points along the bar
constexpr std::size_t min_samples = 12;  // less of a profile shows no shape

// Sum of weighted squares about the best straight line with a step at `edge_m`, up toward that end; without the step where it would have the wrong sign.
double residual(std::span<const BarSample> samples, double edge_m, double sign) {
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  const double outward = edge_m > 0 ? 1 : -1;
  const auto terms = [&](double along_m) {
    return Vec3(1, along_m / 0.05, 0.5 * (1 + std::tanh(outward * (along_m - edge_m) / edge_blur_m)));
  };
  for (const BarSample& sample : samples) {
    const Vec3 t = terms(sample.along_m);
    normal += sample.weight * t * t.transpose();
    right += sample.weight * sample.value * t;
  }
  Vec3 best = normal.ldlt().solve(right);
  if (!best.allFinite() || best.z() * sign < 0) {
    const Eigen::Vector2d line = normal.topLeftCorner<2, 2>().ldlt().solve(right.head<2>());
    best = Vec3(line.x(), line.y(), 0);
  }
  double sum = 0;
  for (const BarSample& sample : samples) {
    const double off = sample.value - terms(sample.along_m).dot(best);
    sum += sample.weight * off * off;
  }
  return sum;
}

double least_residual(std::span<const BarSample> samples, double edge_m, double sign) {
  double least = std::numeric_limits<double>::infinity();
  for (const double error_m : edge_errors_m) least = std::min(least, residual(samples, edge_m + error_m, sign));
  return least;
}

std::optional<double> grey_at(ImageView image, const Vec2& pixel) {
  const double x = std::floor(pixel.x()), y = std::floor(pixel.y());
  if (!(x >= 0 && y >= 0 && x < image.width - 1 && y < image.height - 1)) return std::nullopt;
  const auto* row = image.data + static_cast<std::ptrdiff_t>(y) * image.stride + static_cast<std::ptrdiff_t>(x);
  const double a = pixel.x() - x, b = pixel.y() - y;
  return (1 - b) * ((1 - a) * row[0] + a * row[1]) + b * ((1 - a) * row[image.stride] + a * row[image.stride + 1]);
}

// The bar in the base frame: its middle, and unit directions along, across and away from the panel.
struct Bar {
  Vec3 middle = Vec3::Zero(), along = Vec3::Zero(), across = Vec3::Zero(), out = Vec3::Zero();
  double half_length_m = 0, half_thickness_m = 0, half_depth_m = 0;
};

Bar bar_at(const BarPlace& place, const PanelLayout::Valve& valve) {
  Bar bar;
  const Vec3 along(-std::sin(place.angle_rad), std::cos(place.angle_rad), 0),
      across(std::cos(place.angle_rad), std::sin(place.angle_rad), 0);
  // Along the bar its visible points say little of its middle: an end may be hidden. The valve's axis is known from the marker.
  const double aside_m = across.dot(place.centre_m - Vec3(valve.at_m.x(), valve.at_m.y(), 0));
  bar.middle = place.base_from_panel * (aside_m * across + valve.handle_centre_m());
  bar.along = place.base_from_panel.linear() * along;
  bar.across = place.base_from_panel.linear() * across;
  bar.out = place.base_from_panel.linear().col(2);
  bar.half_length_m = valve.handle_length_m / 2;
  bar.half_thickness_m = valve.handle_thickness_m / 2;
  bar.half_depth_m = valve.depth_m() / 2;
  return bar;
}

class StillReader {
 public:
  StillReader(const Bar& bar, ImageView still, const CameraCalibration& camera)
      : bar_(bar),
        still_(still),
        camera_(camera.intrinsics),
        camera_from_base_(camera.base_from_camera.inverse()),
        eye_(camera.base_from_camera.translation()) {}

  // Grey levels along the long face whose outward normal is `normal`; `aside` lies in the face, square to the bar. Empty for a face that is not seen.
  std::vector<BarSample> face(const Vec3& normal, const Vec3& aside) const {
    const Vec3 centre = bar_.middle + half_m(normal) * normal;
    if (normal.dot((eye_ - centre).normalized()) < grazing_cosine) return {};
    const double width_px = seen_width_px(centre, aside);
    if (!(width_px >= min_face_px)) return {};
    std::vector<BarSample> samples;
    const double reach_m = bar_.half_length_m - end_margin_m;
    double s = -reach_m;
    while (s <= reach_m) {
      if (const std::optional<double> grey = mean_across(centre + s * bar_.along, aside)) samples.push_back({s, *grey, width_px});
      s += step_m;
    }
    return samples;
  }

 private:
  // Of the bar, along a unit vector that is across it or out of the panel.
  double half_m(const Vec3& direction) const { return std::abs(direction.dot(bar_.out)) > 0.5 ? bar_.half_depth_m : bar_.half_thickness_m; }
  std::optional<Vec2> pixel(const Vec3& point) const { return camera_.project(camera_from_base_ * point); }

  // The face's width in the picture, square to the bar.
  double seen_width_px(const Vec3& centre, const Vec3& aside) const {
    const auto a = pixel(centre - half_m(aside) * aside), b = pixel(centre + half_m(aside) * aside);
    const auto c = pixel(centre - 0.01 * bar_.along), d = pixel(centre + 0.01 * bar_.along);
    if (!a || !b || !c || !d) return 0;
    const Vec2 wide = *b - *a, along = (*d - *c).normalized();
    return std::abs(wide.x() * along.y() - wide.y() * along.x());
  }

  // Over the middle six tenths of the face.
  std::optional<double> mean_across(const Vec3& at, const Vec3& aside) const {
    double sum = 0;
    for (const double share : {-0.6, -0.3, 0.0, 0.3, 0.6}) {
      const auto px = pixel(at + share * half_m(aside) * aside);
      const auto grey = px ? grey_at(still_, *px) : std::nullopt;
      if (!grey) return std::nullopt;
      sum += *grey;
    }
    return sum / 5;
  }

  const Bar& bar_;
  ImageView still_;
  scan::CameraModel camera_;
  Pose camera_from_base_;
  Vec3 eye_;
};

double level_of(std::span<const BarSample> samples) {
  double sum = 0;
  for (const BarSample& sample : samples) sum += sample.value;
  return samples.empty() ? 0 : sum / static_cast<double>(samples.size());
}

// Faces are fitted each on its own: they face the light differently. The evidence of a face counts by how wide it is seen.
double still_evidence(const Bar& bar, ImageView still, const CameraCalibration& camera, double edge_m, double sign) {
  if (still.data == nullptr || still.width < 2 || still.height < 2) return 0;
  const StillReader reader(bar, still, camera);
  const std::array<std::pair<Vec3, Vec3>, 3> faces{{{bar.out, bar.across}, {bar.across, bar.out}, {-bar.across, bar.out}}};
  double sum = 0, weights = 0;
  for (const auto& [normal, aside] : faces) {
    const std::vector<BarSample> samples = reader.face(normal, aside);
    if (samples.size() < min_samples) continue;
    const double weight = samples.front().weight;
    sum += weight * step_evidence(samples, edge_m, sign, std::hypot(still_floor_grey, grain * level_of(samples)));
    weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

// The laser's brightness on the bar's top, as the median of each short piece of it: points on an edge are dim.
std::vector<BarSample> laser_profile(const Bar& bar, std::span<const CloudPoint> cloud) {
  const double reach_m = bar.half_length_m - end_margin_m / 2;
  const auto bins = static_cast<std::size_t>(2 * reach_m / bin_m) + 1;
  std::vector<std::vector<float>> found(bins);
  for (const CloudPoint& point : cloud) {
    if (!point.p_m.allFinite() || !std::isfinite(point.amplitude)) continue;
    const Vec3 off = point.p_m.cast<double>() - bar.middle;
    const double s = bar.along.dot(off);
    const bool on_top =
        std::abs(bar.across.dot(off)) <= bar.half_thickness_m && std::abs(bar.out.dot(off) - bar.half_depth_m) <= top_window_m;
    if (on_top && std::abs(s) < reach_m) found[static_cast<std::size_t>((s + reach_m) / bin_m)].push_back(point.amplitude);
  }
  std::vector<BarSample> samples;
  for (std::size_t i = 0; i < bins; ++i) {
    std::vector<float>& in_bin = found[i];
    if (in_bin.empty()) continue;
    const auto middle = in_bin.begin() + static_cast<std::ptrdiff_t>(in_bin.size() / 2);
    std::nth_element(in_bin.begin(), middle, in_bin.end());
    samples.push_back(
        {(static_cast<double>(i) + 0.5) * bin_m - reach_m, static_cast<double>(*middle), std::sqrt(static_cast<double>(in_bin.size()))});
  }
  return samples;
}

double cloud_evidence(const Bar& bar, std::span<const CloudPoint> cloud, double edge_m, double sign) {
  const std::vector<BarSample> samples = laser_profile(bar, cloud);
  if (samples.size() < min_samples) return 0;
  return step_evidence(samples, edge_m, sign, std::hypot(cloud_floor_grey, grain * level_of(samples)));
}

}  // namespace

double step_evidence(std::span<const BarSample> samples, double edge_m, double sign, double floor) {
  double weights = 0;
  for (const BarSample& sample : samples) weights += sample.weight;
  const double here = least_residual(samples, edge_m, sign), there = least_residual(samples, -edge_m, sign);
  const double evidence = (there - here) / (there + here + 2 * weights * floor * floor);
  return std::isfinite(evidence) ? evidence : 0;
}

PointerObservation find_pointer(const BarPlace& place, ImageView still, std::span<const CloudPoint> cloud, const CameraCalibration& camera,
                                const PanelLayout::Valve& valve) {
  PointerObservation pointer;
  const double edge_m = valve.handle_length_m / 2 - valve.pointer_length_m;
  if (!valve.has_pointer() || !(edge_m > edge_blur_m)) return pointer;
  const double sign = valve.pointer == PanelLayout::Pointer::light_end ? 1 : -1;
  const Bar bar = bar_at(place, valve);
  pointer.still_evidence = still_evidence(bar, still, camera, edge_m, sign);
  pointer.cloud_evidence = cloud_evidence(bar, cloud, edge_m, sign);
  const double both = (pointer.still_evidence + pointer.cloud_evidence) / 2;
  pointer.seen = both != 0;
  pointer.direction = both < 0 ? Vec3(-bar.along) : bar.along;
  pointer.confidence = static_cast<float>(std::abs(both));
  return pointer;
}

}  // namespace lf::vision
