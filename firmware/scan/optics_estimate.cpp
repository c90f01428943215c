#include "firmware/scan/optics_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace lf::scan {
namespace {

constexpr float stripe_probe = 0.08f;  // of the width's logarithm: to either side of the estimate
constexpr float lens_probe = 0.25f;
constexpr float stripe_stride = 0.35f;  // most that one picture moves it by
constexpr float lens_stride = 0.3f;
constexpr float scatter_probe = 0.1f;
constexpr float scatter_stride = 0.2f;
constexpr float scatter_doubt = 0.2f;  // of what the first one is told to be
constexpr float most_scatter = 2.0f;   // there the direct light stands on haze of its own height
// Of what is known, from picture to picture: the light's width changes as the arm moves, the lens does not and the water hardly.
constexpr float width_remembered = 0.9f, lens_remembered = 0.98f;
constexpr float lens_doubt = 0.3f;  // of what the first one is told to be, its logarithm's standard deviation: +30 to 100 % at the corners
constexpr float worst_misfit = 3.0f;  // of a column that is believed
constexpr float least_beam_px = 0.3f, least_lens_px = 0.3f, most_lens_px = 2.5f, most_width_px = 6.0f;

float square(float x) { return x * x; }

// Of the stripe's width in the picture what is not the lens' is the beam's.
StripeOptics optics_of(float width_px, float lens_px, float scatter) {
  const float lens = std::clamp(lens_px, least_lens_px, most_lens_px);
  const float beam = square(std::min(width_px, most_width_px)) - square(lens) - 1.0f / 12;
  return {std::sqrt(std::max(beam, square(least_beam_px))), lens, std::clamp(scatter, 0.0f, most_scatter)};
}

}  // namespace

OpticsEstimate::OpticsEstimate(const StripeOptics& first) : optics_(first) {
  lens_.known = 2 / square(lens_doubt);
  scatter_.known = 2 / square(scatter_doubt);
}

void OpticsEstimate::add(const StripeWindows& windows, const PixelNoise& noise, const StripeFits& fits) {
  const float width = width_in_picture_px(optics_), lens = optics_.lens_px, scatter = optics_.scatter;
  const auto factor = [](float probe) { return std::exp(probe); };
  const std::array<StripeOptics, 7> probes{optics_,
                                           optics_of(width * factor(-stripe_probe), lens, scatter),
                                           optics_of(width * factor(stripe_probe), lens, scatter),
                                           optics_of(width, lens * factor(-lens_probe), scatter),
                                           optics_of(width, lens * factor(lens_probe), scatter),
                                           optics_of(width, lens, scatter - scatter_probe),
                                           optics_of(width, lens, scatter + scatter_probe)};
  StripeWindows about = windows;
  about.start = select(fits.found, fits.centre, windows.start);
  std::array<StripeFits, probes.size()> probed;
  LaneMask among = fits.found & (fits.misfit < worst_misfit);
  const std::size_t count = windows.hazy ? probes.size() : probes.size() - 2;
  for (std::size_t i = 0; i < count; ++i) {
    probed[i] = fit_stripes(about, probes[i], noise, FitStart::near);
    among &= probed[i].found;
  }
  if (!any(among)) return;
  const auto take = [&](Newton& newton, std::size_t less, std::size_t more, float probe, LaneMask columns) {
    const auto left = [&](std::size_t i) { return deviance(about, probes[i], noise, probed[i], columns); };
    const float below = left(less), above = left(more);
    newton.slope += (above - below) / (2 * probe);
    newton.curvature += (above - 2 * left(0) + below) / square(probe);
  };
  take(stripe_, 1, 2, stripe_probe, among);
  const LaneMask on_marks = among & ~fits.plain;
  if (!any(on_marks)) return;
  take(lens_, 3, 4, lens_probe, on_marks);
  if (windows.hazy) take(scatter_, 5, 6, scatter_probe, on_marks);
}

// Against the slope, no farther than where the deviance's parabola ends. Where that has no end, as far as is allowed.
float OpticsEstimate::Newton::step(float longest, float remembered) {
  const float total = curvature + known;
  float move = 0;
  if (slope != 0) move = total > 0 ? std::clamp(-slope / total, -longest, longest) : (slope > 0 ? -longest : longest);
  known = remembered * std::max(total, 0.0f);
  slope = curvature = 0;
  return move;
}

float OpticsEstimate::update() {
  const float stripe_move = stripe_.step(stripe_stride, width_remembered), lens_move = lens_.step(lens_stride, lens_remembered),
              scatter_move = scatter_.step(scatter_stride, lens_remembered);
  if (stripe_move == 0 && lens_move == 0 && scatter_move == 0) return 0;
  optics_ = optics_of(width_in_picture_px(optics_) * std::exp(stripe_move), optics_.lens_px * std::exp(lens_move),
                      optics_.scatter + scatter_move);
  return std::max({std::abs(stripe_move), std::abs(lens_move), std::abs(scatter_move)});
}

}  // namespace lf::scan
