#include <algorithm>
#include <array>
#include <new>
#include <optional>
#include <span>

#include "firmware/arm/kinematics.hpp"
#include "firmware/scan/camera_model.hpp"
#include "firmware/scan/peaks.hpp"
#include "firmware/scan/plane.hpp"
#include "firmware/scan/triangulate.hpp"
#include "tests/arm5e.hpp"
#include "tests/target/ledger.hpp"
#include "tests/target/same_everywhere.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::test {
namespace {

constexpr std::int32_t width = 640, height = 480;
using Pixels = std::array<std::uint8_t, static_cast<std::size_t>(width) * height>;
LANTERNFISH_EXTERNAL_MEMORY Pixels on, off;
LANTERNFISH_EXTERNAL_MEMORY std::array<scan::Peak, static_cast<std::size_t>(width) * scan::max_peaks_per_line> peaks;
LANTERNFISH_EXTERNAL_MEMORY scan::PeakDetector detector;
LANTERNFISH_EXTERNAL_MEMORY scan::PlaneFitter fitter;
constexpr std::size_t cloud_size = 20'000;
LANTERNFISH_EXTERNAL_MEMORY std::array<CloudPoint, cloud_size> cloud;

ImageView view(const Pixels& pixels) { return {pixels.data(), width, height, width}; }

struct Picture {
  std::int32_t amplitude = 120;  // grey levels
  std::int32_t second = 0;       // of another stripe, 100 px below
  std::int32_t noise = 5;        // grey levels from lowest to highest
  std::int32_t slope_256 = 61;   // 256ths of a row that the stripe falls from column to column
};

void paint(const Picture& picture, std::uint64_t seed) {
  SameRandom random(seed);
  for (std::int32_t v = 0; v < height; ++v) {
    for (std::int32_t u = 0; u < width; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * width + u;
      const std::int32_t scene = 30 + (u * 7 + v * 3) % 23;
      const std::int32_t centre_256 = 120 * 256 + u * picture.slope_256;
      const std::int32_t light =
          stripe_grey(v * 256 - centre_256, picture.amplitude) + stripe_grey(v * 256 - centre_256 - 100 * 256, picture.second);
      on[i] = static_cast<std::uint8_t>(std::min<std::int32_t>(255, scene + light + random.below(picture.noise)));
      off[i] = static_cast<std::uint8_t>(scene + random.below(picture.noise));
    }
  }
}

void put_peaks_of(Ledger& ledger, const scan::PeakConfig& config, ImageView background) {
  new (&detector) scan::PeakDetector(config);  // a tenth of a megabyte: not by way of the stack
  const std::size_t n = ledger.turn([&] { return detector.detect(view(on), background, peaks); });
  ledger.integer(n);
  for (const scan::Peak& peak : std::span(peaks).first(n)) {
    ledger.number(peak.u_px);
    ledger.number(peak.v_px);
    ledger.number(peak.amplitude);
    ledger.number(peak.ratio);
    ledger.integer(peak.clipped);
  }
  const scan::PeakCounters& counters = detector.counters();
  for (const std::uint64_t counter : {counters.found, counters.weak, counters.saturated, counters.ambiguous}) ledger.integer(counter);
}

void put_peaks(Ledger& ledger) {
  // Sums are integers and equal; the vertex is of single precision, where a unit in the last place is 3e-5 px at row 256 and below.
  constexpr double tolerance = 6.2e-5;
  ledger.operation("peaks of 640x480", tolerance);
  for (const Picture& picture : {Picture{}, Picture{.amplitude = 40}, Picture{.amplitude = 12, .noise = 9}}) {
    paint(picture, 11);
    put_peaks_of(ledger, {}, view(off));
  }
  ledger.operation("peaks, up to four a column", tolerance);
  paint({.second = 90}, 12);
  put_peaks_of(ledger, {.peaks_per_line = 4}, view(off));
  ledger.operation("peaks of a clipped stripe", tolerance);
  paint({.amplitude = 700}, 13);
  put_peaks_of(ledger, {}, view(off));
  ledger.operation("peaks along rows", tolerance);
  paint({.slope_256 = 900}, 14);
  put_peaks_of(ledger, {.axis = scan::PeakAxis::row}, view(off));
  ledger.operation("peaks without a background", tolerance);
  paint({}, 15);
  put_peaks_of(ledger, {}, {});
}

void put_points(Ledger& ledger) {
  CameraCalibration camera = nominal_camera();
  camera.intrinsics.distortion = {-0.21, 0.07, 0.001, -0.0007, -0.01};
  const scan::CameraModel model(camera.intrinsics);
  ledger.operation("ray of a pixel, distorted", 1e-14);
  for (int v = 0; v < height; v += 48) {
    for (int u = 0; u < width; u += 64) {
      const std::optional<Vec3> ray = ledger.turn([&] { return model.ray(Vec2(u + 0.25, v + 0.5)); });
      ledger.integer(ray.has_value());
      if (ray) ledger.numbers(*ray);
    }
  }

  const LaserCalibration laser = nominal_laser();
  const scan::Triangulator triangulator(camera, laser, {});
  ledger.operation("triangulation of a point", 1e-12);  // the sheet is met at some tenths of a radian, which multiplies the pose's 1e-14
  for (int step = 0; step < 8; ++step) {
    const Pose base_from_laser = test::arm5e.base_from_laser(arm::planar_joints(0, 0.9, 1.2 + 0.08 * step, 0), laser);
    for (int v = 8; v < height; v += 24) {
      const std::optional<Vec3> point = ledger.turn([&] { return triangulator.point(Vec2(200.25 + v, v), base_from_laser); });
      ledger.integer(point.has_value());
      if (point) ledger.numbers(*point);
    }
  }
}

// The panel with noise of 1 mm, a plate 2 mm proud on a tenth of it, and three points of ten anywhere.
void strew() {
  SameRandom random(31);
  const Pose panel = PanelLayout{}.nominal_base_from_panel();
  for (CloudPoint& point : cloud) {
    const Vec3 place = random.shares();
    const double x = 0.4 * place.x(), y = 0.3 * place.y();
    const bool stray = random.below(10) < 3;
    const double plate_m = x < -0.3 && y > 0 ? 0.002 : 0;
    const double z = stray ? 0.2 * place.z() : plate_m + 0.001 * place.z();
    point.p_m = (panel * Vec3(x, y, z)).cast<float>();
    point.amplitude = 100;
  }
}

void put_planes(Ledger& ledger) {
  strew();
  // Sums of 14,000 points, and an eigenvector of them: 1e-13. The same inliers to a point.
  for (const double tight_sigmas : {0.0, 3.0}) {
    ledger.operation(tight_sigmas > 0 ? "plane of 20,000 points, biweight" : "plane of 20,000 points", 1e-12);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const PlaneFit fit = ledger.turn([&] { return fitter.fit(cloud, {.seed = seed, .tight_sigmas = tight_sigmas}); });
      ledger.integer(fit.valid);
      ledger.integer(fit.points);
      ledger.integer(fit.inliers);
      ledger.numbers(fit.plane.normal);
      ledger.number(fit.plane.offset_m);
      ledger.number(fit.rms_m);
      ledger.number(fit.bend_m);
      ledger.number(fit.seen_m);
    }
  }
}

}  // namespace

void put_scan(Ledger& ledger) {
  put_peaks(ledger);
  put_points(ledger);
  put_planes(ledger);
}

}  // namespace lf::test
