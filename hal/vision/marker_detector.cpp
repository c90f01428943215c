#include "hal/vision/marker_detector.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "hal/vision/corner_refinement.hpp"
#include "shared/input_error.hpp"

namespace lf::vision {
namespace {

struct Family {
  std::string name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

const std::vector<Family>& families() {
  static const std::vector<Family> table{
      {"16h5", tag16h5_create, tag16h5_destroy},
      {"25h9", tag25h9_create, tag25h9_destroy},
      {"36h10", tag36h10_create, tag36h10_destroy},
      {"36h11", tag36h11_create, tag36h11_destroy},
      {"circle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
      {"circle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
      {"custom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
      {"standard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
      {"standard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
  };
  return table;
}

const Family& family_from_name(const std::string& name) {
  std::string known;
  for (const Family& family : families()) {
    if (family.name == name) return family;
    known.append(known.empty() ? "" : ", ").append(family.name);
  }
  throw InputError("unknown marker family '" + name + "': " + known);
}

void check(const MarkerDetectorConfig& config) {
  if (config.max_hamming < 0 || config.max_hamming > 2) throw InputError("marker detector: max_hamming must be 0, 1 or 2");
  if (!(config.decimate >= 1 && config.decimate <= 8)) throw InputError("marker detector: decimate must be 1 to 8");
  if (!(config.blur_sigma_px >= 0 && config.blur_sigma_px <= 10)) throw InputError("marker detector: blur must be 0 to 10 px");
  if (!(config.min_margin >= 0)) throw InputError("marker detector: the margin must not be negative");
}

// libapriltag has pixel corners at integers; ours are the centres.
constexpr double pixel_centre_px = 0.5;

Vec2 crossing_of_diagonals(const std::array<Vec2, 4>& corners) {
  const Vec2 a = corners[2] - corners[0], b = corners[3] - corners[1], d = corners[1] - corners[0];
  return corners[0] + a * ((d.x() * b.y() - d.y() * b.x()) / (a.x() * b.y() - a.y() * b.x()));
}

DetectedMarker from_library(const apriltag_detection_t& detection, ImageView image) {
  DetectedMarker marker;
  marker.id = detection.id;
  marker.hamming = detection.hamming;
  marker.margin = detection.decision_margin;
  for (std::size_t i = 0; i < 4; ++i) {
    marker.corners_px[i] = Vec2(detection.p[i][0] - pixel_centre_px, detection.p[i][1] - pixel_centre_px);
  }
  marker.corners_px = refine_corners(image, marker.corners_px, detection.family->width_at_border);
  marker.centre_px = crossing_of_diagonals(marker.corners_px);
  return marker;
}

auto order_of(const DetectedMarker& m) { return std::tuple(m.id, -m.margin, m.centre_px.x(), m.centre_px.y()); }

}  // namespace

struct MarkerDetector::Implementation {
  explicit Implementation(const MarkerDetectorConfig& c)
      : config(c), family(family_from_name(c.family)), codes(family.create()), detector(apriltag_detector_create()) {
    detector->nthreads = 1;
    detector->quad_decimate = static_cast<float>(config.decimate);
    detector->quad_sigma = static_cast<float>(config.blur_sigma_px);
    detector->refine_edges = true;
    apriltag_detector_add_family_bits(detector, codes, config.max_hamming);
  }
  ~Implementation() {
    apriltag_detector_destroy(detector);
    family.destroy(codes);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  MarkerDetectorConfig config;
  const Family& family;
  apriltag_family_t* codes;
  apriltag_detector_t* detector;
  std::vector<std::uint8_t> pixels;  // libapriltag blurs in place when it does not decimate
};

MarkerDetector::MarkerDetector(const MarkerDetectorConfig& config) {
  check(config);
  implementation_ = std::make_unique<Implementation>(config);
}
MarkerDetector::~MarkerDetector() = default;
MarkerDetector::MarkerDetector(MarkerDetector&&) noexcept = default;
MarkerDetector& MarkerDetector::operator=(MarkerDetector&&) noexcept = default;

std::vector<DetectedMarker> MarkerDetector::detect(ImageView image) {
  constexpr std::int32_t smallest_px = 16;  // a tag of 8 cells with 2 px each; libapriltag's tiles need more than 4 px
  if (!image.valid()) return {};
  Implementation& own = *implementation_;
  const auto searched_px = std::min(image.width, image.height) / own.config.decimate;
  if (searched_px < smallest_px) return {};

  own.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (std::int32_t v = 0; v < image.height; ++v) {
    std::copy_n(image.row(v), image.width, own.pixels.begin() + static_cast<std::ptrdiff_t>(v) * image.width);
  }
  image_u8_t borrowed{image.width, image.height, image.width, own.pixels.data()};
  zarray_t* detections = apriltag_detector_detect(own.detector, &borrowed);
  std::vector<DetectedMarker> markers;
  for (int i = 0; i < zarray_size(detections); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(detections, i, &detection);
    if (detection->decision_margin >= own.config.min_margin) markers.push_back(from_library(*detection, image));
  }
  apriltag_detections_destroy(detections);
  std::sort(markers.begin(), markers.end(), [](const DetectedMarker& a, const DetectedMarker& b) { return order_of(a) < order_of(b); });
  return markers;
}

const std::vector<std::string>& MarkerDetector::marker_families() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Family& family : families()) list.push_back(family.name);
    return list;
  }();
  return names;
}

}  // namespace lf::vision
