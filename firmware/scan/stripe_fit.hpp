// The centres of a laser stripe in eight columns of a picture at a time, by least squares, on paint of any pattern.
//
// A camera blurs the product of paint and light. The product of the blurred paint and the blurred stripe is something else, and its centre errs by 0.3 px
// at an edge of 10:1. What a pixel sees comes from places whose density is the paint times the blur's kernel. For a Gaussian blur of variance s^2 the
// picture without the laser, B, tells their mean and variance (Tweedie's formula: Efron, Tweedie's Formula and Selection Bias, 2011):
//
//     mean(x) = x + s^2 (ln B)'(x)          variance(x) = s^2 + s^4 (ln B)''(x)
//
// So each pixel is moved to where its light comes from, and widened by the variance there. A stripe of standard deviation w on the surface is then seen as
//
//     height B(x) w / sqrt(w^2 + variance) exp(-(mean(x) - centre)^2 / (2 (w^2 + variance)))  +  offset B(x)
//
// The offset is laser light that the water scatters over the surroundings of the stripe. It lights the same paint, and is never negative.
#pragma once

#include <array>
#include <cstdint>

#include "shared/lanes/lanes.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf::scan {

// How wide the light and the picture are, as standard deviations, and how hazy.
struct StripeOptics {
  float beam_px = 1.2f;  // of the laser's light on the surface, before the lens
  float lens_px = 0.8f;  // of the lens' blur; a pixel's aperture comes on top
  float scatter = 0.0f;  // exp(b R) - 1 of the water between surface and camera: once-scattered light over direct light
  // What makes one flank steeper than the other: the share of Hermite's third function in the stripe (Gram and Charlier's series). A lens with coma, a camera that
  // sharpens, a beam with a lobe on one side.
  float skew = 0.0f;
};

// Of a stripe in the picture.
float width_in_picture_px(const StripeOptics& optics);

// The noise of a pixel.
struct PixelNoise {
  float read_grey = 1.5f;            // of one picture, rounding included
  float electrons_per_grey = 40.0f;  // shot noise: the variance of g grey levels is g over this
  float speckle = 0.18f;             // standard deviation of the laser's light, over its mean: 0.13 to 0.25 at F/2.8 and 6 um pixels
  // What the model leaves out, as if it were noise of every pixel: this share of the stripe's peak. A camera that sharpens, a beam that is no Gaussian.
  float model = 0.0f;
};

// Rows about a stripe in each of eight columns, grey levels, all finite. A column may begin at another row of the picture than its neighbours.
struct StripeWindows {
  static constexpr std::int32_t most_rows = 48;
  using Rows = std::array<Lanes, most_rows>;

  std::int32_t count = 0;  // of rows that follow
  Lanes start{};           // about where the centre is, rows from the window's first
  Rows stripe{};           // laser on less laser off
  Rows ambient{};          // laser off: the paint, as it is lit. All 0 where no such picture is: the paint is then taken to be plain
  Rows background{};       // where no picture without the laser is: the light under the stripe, of which only the shot noise counts
  Rows stripe_haze{};      // what haze.hpp makes of the first
  Rows ambient_haze{};     // and of the second; 0 in clear water
  Rows valid{};            // 1; 0 where the pixel is clipped
  bool hazy = false;       // the haze was computed; otherwise it is 0, whatever the water
};

// Rows that a window needs to either side of the start. Of a picture alone (`with_background` false) its ends tell the background, and have to lie where the stripe has
// ended: 2.5 widths out, where a pair's window ends, 4 % of the peak are left, which bent single pictures' centres by 0.08 px and narrowed wide stripes by a fifth.
std::int32_t reach_of_window(const StripeOptics& optics, bool with_background = true);

struct StripeFits {
  LaneMask found{};      // the rest holds for these columns
  LaneMask plain{};      // the paint is a straight line as far as its noise tells: no edges
  LaneMask painted{};    // edges that no noise makes: they tell of the lens
  Lanes centre{};        // rows from the window's first
  Lanes variance_px2{};  // of the centre, from the noise
  Lanes height{};        // of the beam over the paint: the stripe's grey levels on paint of 1
  Lanes offset{};        // the same of the light about it
  Lanes misfit{};        // mean square of what is left, over its expected noise: about 1 where the model holds
};

enum class FitStart : std::uint8_t {
  near,    // errs by half of the stripe's width at most
  far,     // by two widths
  filter,  // is a filter's maximum: near on plain paint, far at edges
};

// Not found: a column with fewer than 8 valid pixels, or whose likelihood has no maximum within reach of the start.
// O(rows), no allocation.
StripeFits fit_stripes(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, FitStart start);

// What the fits of eight columns leave: the sum, over the valid pixels of the columns `among`, of squared residuals over their variance and of the variance's
// logarithm. Of two optics the one with less is likelier.
float deviance(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, const StripeFits& fits, LaneMask among);

struct PixelWeights {
  StripeWindows::Rows rows{};  // one over each pixel's variance, of the pictures as they were taken
  Lanes brightest{};           // the most that a pixel's light squared is over its variance
};
PixelWeights weights_of(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, const StripeFits& fits);

// The sum of squared residuals by given weights.
float squares_left(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, const StripeFits& fits,
                   const PixelWeights& weights, LaneMask among);

// By how much the heights of neighbouring columns (lanes) differ, as the speckle's variance that would explain it. Half of them are below the true variance and half
// above. Speckle sets neighbours apart; what the model leaves out of the stripe's shape they have in common.
using SpeckleVariances = StaticVector<float, lane_count>;
SpeckleVariances speckle_between(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, const StripeFits& fits);

}  // namespace lf::scan
