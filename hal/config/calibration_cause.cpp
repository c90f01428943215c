#include <array>
#include <cmath>
#include <cstdio>

#include "hal/config/cause.hpp"

namespace lf::config {

namespace {

// What a good calibration may leave in the marker's side: 1.1 % in the sum with the default marker and camera. Of 16 missions whose machine was off its calibration by as much as
// a careful one is, the worst left 0.93 %.
constexpr double survey_m = 0.0002;  // of the marker's own side
constexpr double range = 0.0035;     // of the plane's distance: 2 mm of 0.6 m
constexpr double corner_px = 0.2;    // of the side in the picture: spot and pixels widen black on white
// Rms of corners about a square; 0.2 px were seen.
constexpr double square_px = 0.5;
// A look tells a face's place to 3 mm, the joints the tip's to 2, and which corner of an aslant finger touches first leaves 3 open: added in squares.
constexpr double face_m = 0.0047;

constexpr const char* anew = "If these are right, calibrate camera and laser anew.";

std::string formatted(const char* format, double a, double b) {
  std::array<char, 200> text;
  (void)std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

std::string sides_doubt(const mission::CalibrationFit& fit) {
  const double error = fit.marker_side_error, allowed = allowed_side_error(fit);
  if (!(std::abs(error) > allowed)) return "";
  return formatted("the marker's side on the scanned plane is off the surveyed one by %+.2f %%, where %.2f %% are allowed", 100 * error,
                   100 * allowed);
}

std::string corners_doubt(const mission::CalibrationFit& fit) {
  const double skewed_px = static_cast<double>(fit.marker_corners_m) / fit.marker_size_m * fit.marker_side_px;
  if (!(skewed_px > square_px)) return "";
  return formatted("the marker's corners on the scanned plane are off a square by %.2f px, where %.2f are allowed", skewed_px, square_px);
}

std::string faces_doubt(const mission::TaskResults& results) {
  const double off_m = faces_off_m(results).value_or(0);
  if (!(std::abs(off_m) > face_m)) return "";
  return formatted("the buttons' faces were felt %.1f mm ", 1e3 * std::abs(off_m), 0) + (off_m > 0 ? "behind" : "before") +
         formatted(" the place where they were seen, where %.1f mm are allowed", 1e3 * face_m, 0);
}

void add(Cause& cause, const std::string& doubt, const char* remedy) {
  if (doubt.empty()) return;
  cause.name += (cause.name.empty() ? "" : "; ") + doubt;
  cause.remedy += (cause.remedy.empty() ? "" : " ") + std::string(remedy);
}

}  // namespace

double allowed_side_error(const mission::CalibrationFit& fit) {
  return survey_m / fit.marker_size_m + range + corner_px / fit.marker_side_px;
}

std::optional<double> faces_off_m(const mission::TaskResults& results) {
  double sum_m = 0;
  int felt = 0;
  for (const mission::TaskResult& result : results) {
    const bool no_face = result.failure == StepFailure::early_contact || result.failure == StepFailure::button_missing;
    if (!result.face_felt || no_face) continue;
    sum_m += result.face_off_m;
    ++felt;
  }
  return felt > 0 ? std::optional<double>(sum_m / felt) : std::nullopt;
}

Cause calibration_cause(const mission::CalibrationFit& fit, const mission::TaskResults& results) {
  Cause cause;
  if (fit.known && fit.marker_size_m > 0 && fit.marker_side_px > 0) {
    add(cause, sides_doubt(fit), "Measure the marker's side (panel.marker_size_m).");
    add(cause, corners_doubt(fit),
        "Look at the still picture for what covers the marker's edge, and at the marker for whether it is flat.");
  }
  add(cause, faces_doubt(results),
      "Measure the buttons' height (panel.button_height_m), and check the joints' zeros and the arm's description.");
  if (!cause.name.empty()) cause.remedy += std::string(" ") + anew;
  return cause;
}

}  // namespace lf::config
