#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "hal/config/cause.hpp"
#include "shared/geometry/pose.hpp"

namespace lf::config {

namespace {

using mission::Sight;

// Mean of a still: the lamps' backscatter alone gives 30 grey levels; a camera's black level and noise stay below this.
constexpr float dark_grey = 6;
constexpr float white_share = 0.5f;
// PictureLight::contrast_grey of the default panel under its lamps, in the simulator: 9.0 at an attenuation of 4 per m, where the marker is still found and the pointer
// is not, and 5.8 at 5, where no marker is found.
constexpr float no_contrast_grey = 6;
// PictureLight::noise_grey: at 20 the default panel's handle is lost in its cloud, at 12 the mission succeeds.
constexpr float noisy_grey = 15;
// PictureLight::contrast_grey that noise of 1 grey level makes: the step between the means of two squares of 64 pixels that one in a hundred exceeds.
constexpr float contrast_of_noise = 2.58f * 1.414f / 8;
// Sight::marker_cell_px: an AprilTag is found down to 2.2 to 2.5 px a square.
constexpr float small_cell_px = 2.4f;
// Of the cloud's points: a sweep over a panel has 80,000, and PanelMap takes less for no scan. Peaks alone tell nothing: edges of the arm's moving shadow are some.
constexpr std::uint32_t fewest_points = 2000;
// A panel beyond what docking allows: 20 mm and 2 degrees, seen through the tilt of PnP and of a plane's edge.
constexpr float far_off_m = 0.06f;
constexpr float far_tilted_rad = 0.12f;

double stripe_share(const Sight& sight) {
  const double columns = double(sight.columns_found) + sight.columns_weak + sight.columns_saturated;
  return columns > 0 ? sight.columns_found / columns : 0;
}

double white_stripe_share(const Sight& sight) {
  const double columns = double(sight.columns_found) + sight.columns_weak + sight.columns_saturated;
  return columns > 0 ? sight.columns_saturated / columns : 0;
}

std::string formatted(const char* format, double value) {
  std::array<char, 160> text;
  (void)std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

Cause pictures_missing() {
  return {"no pictures came", "Check the camera's cable and source, and that its trigger is wired to the output node."};
}
Cause pictures_refused() {
  return {"the pictures were refused",
          "They are of another size than the core takes, or were exposed without the light that was ordered: check the camera's format and "
          "trigger, and the laser's interlock."};
}
Cause pictures_dark() {
  return {
      "the pictures are dark",
      "The exposure is too short, or the lens is covered: raise camera.exposure_us, check the camera's aperture and gain, and the lamps."};
}
Cause pictures_white() {
  return {"the pictures are white", "The exposure is too long: lower camera.exposure_us or the gain, or dim the lamps."};
}
Cause pictures_noisy(double noise_grey) {
  return {formatted("the pictures are noisy: %.0f grey levels", noise_grey),
          "Give them more light in place of gain: raise camera.exposure_us or the lamps; check the camera's cable and its shield."};
}
// What noise does not make.
float contrast_of(const PictureLight& still) {
  const float by_noise = contrast_of_noise * still.noise_grey;
  return std::sqrt(std::max(0.0f, still.contrast_grey * still.contrast_grey - by_noise * by_noise));
}
bool without_contrast(const PictureLight& still) { return contrast_of(still) < no_contrast_grey; }

Cause turbid() {
  return {
      "the water is too turbid",
      "The still picture shows no contrast: wait for clearer water or dock nearer; in haze, lamps that are off or farther from the camera "
      "help."};
}
Cause no_line() {
  return {"the laser's line is missing or too weak",
          "The marker is at its place and the picture has contrast, but hardly a point of the line was found: check the laser's power, its "
          "window and interlock; in turbid water dock nearer or sweep slower (mission.sweep_speed_rad_s)."};
}
Cause line_saturated() { return {"the laser's line is white over its width", "Lower camera.exposure_us or the laser's power."}; }
Cause marker_hidden() {
  return {"the marker is hidden or another one",
          "Panel and handle are at their place and the picture has contrast: look at the still picture for what covers, blurs or outshines "
          "the marker, as haze in "
          "the lamps' light does; check "
          "panel.marker_id "
          "and panel.marker_centre_m."};
}
Cause marker_small(double cell_px) {
  return {formatted("the marker is too small in the picture: %.1f px a square of its code", cell_px),
          "Use a larger one (panel.marker_size_m), a camera with more pixels a degree, or dock nearer."};
}
Cause docked_off(double off_m) {
  return {formatted("the panel stands %.0f mm off its nominal place", 1e3 * off_m),
          "Dock again, nearer to the nominal place: mission.docking_m is what the arm allows for; check panel.ahead_m, panel.right_m and "
          "panel.down_m."};
}
Cause docked_askew(double tilt_rad) {
  return {formatted("the panel is tilted by %.1f degrees against its nominal place", deg_from_rad(tilt_rad)),
          "Dock again, nearer to the nominal place: mission.docking_rad is what the arm allows for."};
}
Cause panel_elsewhere() {
  return {
      "neither marker nor handle is at its place",
      "The picture has contrast: look at the still picture. Where the panel stands elsewhere, dock again, nearer to the nominal place, and "
      "check panel.ahead_m, panel.right_m and panel.down_m; where it is covered, clean it; where the picture is "
      "blurred or hazy, check the lens, the exposure and the lamps."};
}

// The panel was seen somewhere: is that where docking allows it?
Cause place_of(const Sight& sight) {
  if (sight.marker_found && sight.marker_off_m > far_off_m) return docked_off(sight.marker_off_m);
  if (sight.handle_found && sight.handle_off_m > far_off_m) return docked_off(sight.handle_off_m);
  // A fit to few points, or that few agree with, is no panel.
  if (!sight.plane_found || sight.points < fewest_points || 5 * sight.inliers < 2 * sight.points) return {};
  if (std::abs(sight.plane_off_m) > far_off_m) return docked_off(sight.plane_off_m);
  if (sight.plane_tilt_rad > far_tilted_rad) return docked_askew(sight.plane_tilt_rad);
  return {};
}

// Whatever was looked for: pictures in which nothing can be seen.
Cause light_of(const Sight& sight) {
  if (sight.stripes == 0 && !sight.still_taken) return sight.images_refused > 0 ? pictures_refused() : pictures_missing();
  if (!sight.still_taken) return {};
  if (sight.still.white_share > white_share) return pictures_white();
  if (sight.still.mean_grey < dark_grey && without_contrast(sight.still)) return pictures_dark();
  if (sight.still.noise_grey > noisy_grey) return pictures_noisy(sight.still.noise_grey);
  return {};
}

Cause cause_of_poor_plane(const Sight& sight) {
  if (sight.still_taken && without_contrast(sight.still)) return turbid();
  if (white_stripe_share(sight) > 0.5) return line_saturated();
  if (sight.points >= fewest_points || !sight.still_taken) return {};
  return sight.marker_found ? no_line() : panel_elsewhere();
}

Cause cause_without_marker(const Sight& sight) {
  if (!sight.still_taken) return {"no still picture came", "Check the camera's cable and trigger."};
  if (without_contrast(sight.still)) return turbid();
  if (!sight.handle_found) return panel_elsewhere();
  return sight.marker_cell_px > 0 && sight.marker_cell_px < small_cell_px ? marker_small(sight.marker_cell_px) : marker_hidden();
}

}  // namespace

Cause sight_cause(StepFailure failure, const Sight& sight) {
  switch (failure) {
    case StepFailure::no_panel:
    case StepFailure::too_few_points:
    case StepFailure::plane_unsure:
    case StepFailure::no_marker:
    case StepFailure::marker_disagrees:
    case StepFailure::no_handle:
    case StepFailure::unreachable:
    case StepFailure::panel_in_the_way: break;
    default: return {};
  }
  // An answer that was not made of pictures, as on a test bench that gives sight, has points all the same.
  if (sight.look == 0 || (sight.stripes == 0 && sight.points > 0)) return {};
  const bool by_seeing = failure != StepFailure::unreachable && failure != StepFailure::panel_in_the_way;
  if (by_seeing && !light_of(sight).name.empty()) return light_of(sight);
  if (!place_of(sight).name.empty()) return place_of(sight);
  switch (failure) {
    case StepFailure::no_panel:
    case StepFailure::too_few_points:
    case StepFailure::plane_unsure: return cause_of_poor_plane(sight);
    case StepFailure::no_marker: return cause_without_marker(sight);
    default: return {};
  }
}

std::string sight_text(const Sight& sight) {
  if (sight.look == 0) return "";
  std::string text =
      formatted("%.0f images of the laser", sight.stripes) + formatted(", peaks in %.0f %% of their columns", 100 * stripe_share(sight));
  if (sight.images_missing > 0) text += formatted(", %.0f images missing", sight.images_missing);
  if (sight.images_refused > 0) text += formatted(", %.0f images refused", sight.images_refused);
  if (sight.stripe.width_px > 0) {
    text += formatted("; stripe %.2f px wide", sight.stripe.width_px) + formatted(", skew %+.2f", sight.stripe.skew) +
            formatted(", %.1f %% of its shape unexplained", 100 * sight.stripe.model_share);
  }
  text += formatted("; %.0f points", sight.points);
  if (sight.plane_found) {
    text += formatted(", %.0f on a plane", sight.inliers) + formatted(" %+.0f mm", 1e3 * sight.plane_off_m) +
            formatted(" and %.1f degrees off the nominal one", deg_from_rad(sight.plane_tilt_rad));
  } else {
    text += ", no plane";
  }
  if (!sight.still_taken) return text + "; no still";
  text += formatted("; still: mean %.0f grey", sight.still.mean_grey) + formatted(", contrast %.1f", sight.still.contrast_grey) +
          formatted(", noise %.1f", sight.still.noise_grey) + formatted(", %.0f %% white", 100 * sight.still.white_share);
  text += sight.marker_found ? formatted(", marker %.0f mm off its nominal place", 1e3 * sight.marker_off_m) : ", no marker";
  if (sight.fit.known)
    text += formatted(", its side %+.1f %% against the surveyed one", 100 * static_cast<double>(sight.fit.marker_side_error));
  return text + (sight.handle_found ? formatted(", handle %.0f mm", 1e3 * sight.handle_off_m) : ", no handle");
}

}  // namespace lf::config
