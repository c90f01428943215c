#include <array>
#include <cmath>
#include <cstdio>

#include "hal/config/cause.hpp"

namespace lf::config {

namespace {

// What a good calibration leaves in the marker's side. In the simulator, whose machine is off its calibration by as much as a careful one is, 1.2 % in the sum at the default marker.
constexpr double survey_m = 0.0002;  // of the marker's own side
constexpr double range = 0.0035;     // of the plane's distance: 2 mm of 0.6 m
constexpr double corner_px = 0.2;    // of the side in the picture: spot and pixels widen black on white
// Rms of corners about a square; 0.2 px were seen.
constexpr double square_px = 0.5;
// A look tells a face's place to 3 mm, the joints the tip's to 2: added in squares, as press_face_m has them.
constexpr double face_m = 0.0036;

std::string formatted(const char* format, double a, double b) {
  std::array<char, 200> text;
  (void)std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

Cause cause_by_marker(const mission::CalibrationFit& fit) {
  if (!fit.known || !(fit.marker_size_m > 0) || !(fit.marker_side_px > 0)) return {};
  const double size_m = fit.marker_size_m, side_px = fit.marker_side_px, error = fit.marker_side_error;
  const double allowed = survey_m / size_m + range + corner_px / side_px;
  if (std::abs(error) > allowed) {
    return {formatted("the marker's square on the scanned plane is %.1f %% ", 100 * std::abs(error), 0) +
                (error > 0 ? "larger" : "smaller") + formatted(" than surveyed, where %.1f %% is usual", 100 * allowed, 0),
            "Measure the marker's side (panel.marker_size_m). If it is right, calibrate camera and laser anew."};
  }
  const double skewed_px = fit.marker_corners_m / size_m * side_px;
  if (skewed_px > square_px) {
    return {
        formatted("the marker's corners on the scanned plane are off a square by %.1f px, where %.1f are usual", skewed_px, square_px),
        "Look at the still picture for what covers the marker's edge, and at the marker for whether it is flat. If it is well, calibrate "
        "the camera anew."};
  }
  return {};
}

Cause cause_by_faces(const mission::TaskResults& results) {
  const std::optional<double> off_m = faces_off_m(results);
  if (!off_m || !(std::abs(*off_m) > face_m)) return {};
  return {formatted("the buttons' faces were felt %.1f mm ", 1e3 * std::abs(*off_m), 0) + (*off_m > 0 ? "deeper" : "higher") +
              formatted(" than they were seen, where %.1f mm are usual", 1e3 * face_m, 0),
          "Measure the buttons' height (panel.button_height_m). If it is right, calibrate camera and laser anew."};
}

}  // namespace

std::optional<double> faces_off_m(const mission::TaskResults& results) {
  double sum_m = 0;
  int felt = 0;
  for (const mission::TaskResult& result : results) {
    if (!result.face_felt || result.failure != StepFailure::none) continue;
    sum_m += result.face_off_m;
    ++felt;
  }
  return felt > 0 ? std::optional<double>(sum_m / felt) : std::nullopt;
}

Cause calibration_cause(const mission::CalibrationFit& fit, const mission::TaskResults& results) {
  const Cause by_marker = cause_by_marker(fit);
  return by_marker.name.empty() ? cause_by_faces(results) : by_marker;
}

}  // namespace lf::config
