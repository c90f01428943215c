#include "firmware/scan/optics_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace lf::scan {
namespace {

constexpr float stripe_probe = 0.08f;  // of the width's logarithm: to either side of the estimate
constexpr float lens_probe = 0.25f;
constexpr float stripe_stride = 0.35f;  // most that one picture moves it by
constexpr float lens_stride = 0.3f;
// By how much less of the speckle a fit of centre and height follows with a wider stripe: the slope, over the width's logarithm, of the squares that are left of speckle of
// variance 1. Of the height 1 / sqrt(8), of the centre 3 / sqrt(32): closed forms of a bell's products.
constexpr float followed = 0.884f;
constexpr float scatter_probe = 0.1f;
constexpr float scatter_stride = 0.2f;
constexpr float skew_probe = 0.03f, skew_stride = 0.05f;
constexpr float untold_skew = 0.05f;  // its standard deviation before a picture has told of it
// Columns of eight that have to be plain. Of pictures with one, whose edges the noise hid, the skew went to its bound; on the panel nearly all are.
constexpr std::int32_t least_plain_of_8 = 5;
constexpr float most_skew = 0.2f;      // there the stripe's flank is a tenth below 0 at two widths
constexpr float scatter_doubt = 0.2f;  // of what the first one is told to be
constexpr float most_scatter = 2.0f;   // there the direct light stands on haze of its own height
// Of what is known, from picture to picture: the light's width changes as the arm moves, the lens does not and the water hardly.
constexpr float width_remembered = 0.9f, lens_remembered = 0.98f;
constexpr float lens_doubt = 0.3f;  // of what the first one is told to be, its logarithm's standard deviation: +30 to 100 % at the corners
constexpr float worst_misfit = 3.0f;  // of a column that is believed
constexpr float least_beam_px = 0.3f, least_lens_px = 0.3f, most_lens_px = 2.5f, most_width_px = 6.0f;

float square(float x) { return x * x; }

// Leaves out of all columns what is as near to the centre as a clipped pixel of any. Speckle clips the brightest: with the dimmer ones of their neighbours in their places, a
// stripe came out a tenth too wide.
void leave_out_clipped(StripeWindows& windows) {
  float farthest = -1;
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes clipped = select(windows.valid[i] > 0, all_lanes(-1), abs(static_cast<float>(i) - windows.start));
    for (int lane = 0; lane < lane_count; ++lane) farthest = std::max(farthest, clipped[lane]);
  }
  for (std::int32_t i = 0; i < windows.count; ++i)
    windows.valid[i] = abs(static_cast<float>(i) - windows.start) <= farthest ? Lanes{} : windows.valid[i];
}

// Of the stripe's width in the picture what is not the lens' is the beam's.
StripeOptics optics_of(float width_px, float lens_px, float scatter, float skew) {
  const float lens = std::clamp(lens_px, least_lens_px, most_lens_px);
  const float beam = square(std::min(width_px, most_width_px)) - square(lens) - 1.0f / 12;
  return {std::sqrt(std::max(beam, square(least_beam_px))), lens, std::clamp(scatter, 0.0f, most_scatter),
          std::clamp(skew, -most_skew, most_skew)};
}

}  // namespace

OpticsEstimate::OpticsEstimate(const StripeOptics& first) : optics_(first) {
  lens_.known = 2 / square(lens_doubt);
  scatter_.known = 2 / square(scatter_doubt);
  skew_.known = skew_.least = 2 / square(untold_skew);
}

void OpticsEstimate::add(const StripeWindows& windows, const PixelNoise& noise, const StripeFits& fits) {
  StripeWindows about = windows;
  about.start = select(fits.found, fits.centre, windows.start);
  const LaneMask among = fits.found & (fits.misfit < worst_misfit);
  if (!any(among)) return;
  // Of thousands of plain columns some look like marks by their noise, and that noise would be taken for a wide lens.
  const LaneMask on_marks = among & fits.painted;
  if (any(on_marks)) add_lens(about, noise, on_marks);
  leave_out_clipped(about);
  add_shape(about, noise, among);
}

// Whole columns are compared with the stripe's shape, so that speckle counts as if it were even over them: by its own weights the brightest pixels hardly
// count, and the skirts, which are no bell's, would be taken for the stripe. The weights are those of the columns' mean height: by their own, the columns that speckle makes
// low and wide would weigh more, and a stripe came out 6 to 10 % too wide.
void OpticsEstimate::add_shape(const StripeWindows& about, const PixelNoise& speckled, LaneMask among) {
  PixelNoise noise = speckled;
  noise.model = std::hypot(speckled.model, speckled.speckle);
  noise.speckle = 0;
  const float width = width_in_picture_px(optics_), lens = optics_.lens_px, scatter = optics_.scatter, skew = optics_.skew;
  const std::array<StripeOptics, 5> probes{optics_, optics_of(width * std::exp(-stripe_probe), lens, scatter, skew),
                                           optics_of(width * std::exp(stripe_probe), lens, scatter, skew),
                                           optics_of(width, lens, scatter, skew - skew_probe),
                                           optics_of(width, lens, scatter, skew + skew_probe)};
  std::array<StripeFits, probes.size()> probed;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    probed[i] = fit_stripes(about, probes[i], noise, FitStart::near);
    among &= probed[i].found;
  }
  if (!any(among)) return;
  float height = 0, columns = 0;
  for (int lane = 0; lane < lane_count; ++lane) {
    if (among[lane] != 0) height += probed[0].height[lane], ++columns;
  }
  StripeFits even = probed[0];
  even.height = all_lanes(height / columns);
  const PixelWeights weights = weights_of(about, optics_, noise, even);
  std::array<float, probes.size()> left{};
  for (std::size_t i = 0; i < probes.size(); ++i) left[i] = squares_left(about, probes[i], noise, probed[i], weights, among);
  for (int lane = 0; lane < lane_count; ++lane) {
    if (among[lane] != 0) stripe_.slope -= followed * std::min(1.0f, square(speckled.speckle) * weights.brightest[lane]);
  }
  stripe_.add(left[1], left[0], left[2], stripe_probe);
  // At marks the model's own error would be taken for skew.
  const LaneMask plain = among & probed[0].plain;
  for (int lane = 0; lane < lane_count; ++lane) {
    if (among[lane] != 0) ++fitted_;
    if (plain[lane] != 0) ++plain_;
  }
  if (!any(plain)) return;
  for (const std::size_t i : {0, 3, 4}) left[i] = squares_left(about, probes[i], noise, probed[i], weights, plain);
  skew_.add(left[3], left[0], left[4], skew_probe);
}

void OpticsEstimate::add_lens(const StripeWindows& about, const PixelNoise& noise, LaneMask among) {
  const float width = width_in_picture_px(optics_), lens = optics_.lens_px, scatter = optics_.scatter, skew = optics_.skew;
  const std::array<StripeOptics, 5> probes{
      optics_, optics_of(width, lens * std::exp(-lens_probe), scatter, skew), optics_of(width, lens * std::exp(lens_probe), scatter, skew),
      optics_of(width, lens, scatter - scatter_probe, skew), optics_of(width, lens, scatter + scatter_probe, skew)};
  const std::size_t count = about.hazy ? probes.size() : 3;
  std::array<StripeFits, probes.size()> probed;
  for (std::size_t i = 0; i < count; ++i) {
    probed[i] = fit_stripes(about, probes[i], noise, FitStart::near);
    among &= probed[i].found;
  }
  if (!any(among)) return;
  std::array<float, probes.size()> left{};
  for (std::size_t i = 0; i < count; ++i) left[i] = deviance(about, probes[i], noise, probed[i], among);
  lens_.add(left[1], left[0], left[2], lens_probe);
  if (about.hazy) scatter_.add(left[3], left[0], left[4], scatter_probe);
}

void OpticsEstimate::Newton::add(float below, float here, float above, float probe) {
  if (!std::isfinite(below) || !std::isfinite(here) || !std::isfinite(above)) return;
  slope += (above - below) / (2 * probe);
  curvature += (above - 2 * here + below) / square(probe);
}

// Against the slope, no farther than where the deviance's parabola ends. Where that has no end, as far as is allowed.
float OpticsEstimate::Newton::step(float longest, float remembered) {
  if (slope == 0 && curvature == 0) return 0;
  const float total = std::max(curvature + known, least);
  float move = 0;
  if (slope != 0) move = total > 0 ? std::clamp(-slope / total, -longest, longest) : (slope > 0 ? -longest : longest);
  known = std::max(remembered * std::max(total, 0.0f), least);
  drop();
  return move;
}

float OpticsEstimate::skew_doubt() const { return std::sqrt(2 / (skew_.least + told_)); }

void OpticsEstimate::end_picture() {
  if (newest_ > 0) told_ = lens_remembered * told_ + newest_;
  newest_ = 0;
}

float OpticsEstimate::update() {
  // Where most columns have edges, those of the others are hidden by their noise.
  if (8 * plain_ < least_plain_of_8 * fitted_) skew_.drop();
  newest_ = skew_.curvature;
  fitted_ = plain_ = 0;
  const float stripe_move = stripe_.step(stripe_stride, width_remembered), lens_move = lens_.step(lens_stride, lens_remembered),
              scatter_move = scatter_.step(scatter_stride, lens_remembered), skew_move = skew_.step(skew_stride, lens_remembered);
  if (stripe_move == 0 && lens_move == 0 && scatter_move == 0 && skew_move == 0) return 0;
  optics_ = optics_of(width_in_picture_px(optics_) * std::exp(stripe_move), optics_.lens_px * std::exp(lens_move),
                      optics_.scatter + scatter_move, optics_.skew + skew_move);
  return std::max({std::abs(skew_move), std::abs(stripe_move), std::abs(lens_move), std::abs(scatter_move)});
}

}  // namespace lf::scan
