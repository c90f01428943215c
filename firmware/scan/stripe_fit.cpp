#include "firmware/scan/stripe_fit.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/scan/haze.hpp"

namespace lf::scan {
namespace {

using Rows = StripeWindows::Rows;

constexpr float pixel_variance = 1.0f / 12;  // of a pixel's aperture
constexpr float window_widths = 2.5f;        // to either side of the centre, and two rows more
constexpr float alone_widths = 3.5f;         // the same of a picture without background: 0.2 % of the peak are left there
constexpr float most_shift_px = 2.0f;        // of a pixel's light: more is noise of dark paint
constexpr float least_spread = 0.1f;         // of the variance of a pixel's light, over the blur's: noise may take it below 0
constexpr float least_rows = 8;              // that are not clipped
constexpr float searched = 2.0f;             // stripe widths to either side of a far start
constexpr float search_step = 0.3f;          // stripe widths
constexpr int steps = 4;                     // of Gauss and Newton: from 0.3 widths the fourth moves by less than 0.01 px
constexpr float longest_step = 0.5f;         // stripe widths
constexpr float farthest = 3.0f;             // stripe widths from the start: beyond it, another stripe
constexpr float least_determinant = 1e-5f;   // of stripe and offset, relative: below it they cannot be told apart
constexpr float plain_sigmas = 3.0f;         // by which the squares about a line may exceed the noise's
constexpr float painted_squares =
    6.0f;  // over the noise's: at an edge of 10:1 on paint of 110 grey levels a hundred times, by noise once in 10^6 columns
constexpr float faintest = 0.1f;            // variance of a speckle of 0.3: columns whose other noise is more tell nothing of it
constexpr float median_of_square = 0.455f;  // of a normal deviate
constexpr float least_variance = 1e-3f;     // grey levels^2: of a picture without noise

Lanes square(Lanes x) { return x * x; }
float square(float x) { return x * x; }

// The windows as the model wants them.
struct Model {
  Rows data;              // the stripe without its haze
  Rows hazy_light;        // what was taken out: it has its noise all the same
  Rows paint;             // the same of the picture without the laser; plain paint without its noise
  Rows place;             // mean of where a pixel's light comes from, rows
  Rows inverse_variance;  // of the stripe as that pixel sees it
  Rows level;             // of a stripe of height 1 whose centre is there
  Rows still_variance;    // of the noise that does not depend on the stripe, grey levels^2
  Rows shared_noise;      // of the picture without the laser, over the paint: what both the difference and the paint have of it
  Rows paint_variance;    // of the paint, over its square
  Rows weight;
  Lanes highest_level;
  float skew = 0;
};

// Of a pixel with the laser off, its haze taken out.
Lanes variance_of(const PixelNoise& noise, Lanes ambient, float near) {
  return (square(noise.read_grey) + ambient / noise.electrons_per_grey) / square(near);
}

// Takes the haze out. It was computed of the hazy picture, which is brighter than the clear one: a uniform one by near + haze_share * scatter.
void clear_haze(const StripeWindows& windows, float scatter, Model& m) {
  const float near = 1 + near_share * scatter, share = scatter / (near + haze_share * scatter);
  for (std::int32_t i = 0; i < windows.count; ++i) {
    m.hazy_light[i] = max(share * windows.stripe_haze[i] / near, Lanes{});
    m.data[i] = windows.stripe[i] / near - m.hazy_light[i];
    m.paint[i] = max((windows.ambient[i] - share * windows.ambient_haze[i]) / near, all_lanes(1));
  }
}

struct Paint {
  LaneMask plain, painted;  // as in StripeFits
};

// A column whose paint lies on a line as far as its noise tells is given the line: the stripe is then not multiplied by that noise.
Paint straighten_plain_paint(const StripeWindows& windows, const PixelNoise& noise, float near, Rows& paint) {
  const auto rows = static_cast<float>(windows.count);
  const float middle = 0.5f * (rows - 1);
  const float squares = rows * (rows * rows - 1) / 12;  // of the distances from the middle
  Lanes mean{}, slope{};
  for (std::int32_t i = 0; i < windows.count; ++i) {
    mean += paint[i] / rows;
    slope += paint[i] * ((static_cast<float>(i) - middle) / squares);
  }
  Lanes left{};
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes line = mean + slope * (static_cast<float>(i) - middle);
    left += square(paint[i] - line) / variance_of(noise, windows.ambient[i], near);
  }
  const LaneMask plain = left < (rows - 2) * (1 + plain_sigmas * std::sqrt(2 / rows));
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes line = mean + slope * (static_cast<float>(i) - middle);
    paint[i] = plain ? max(line, all_lanes(1)) : paint[i];
  }
  return {plain, left > painted_squares * (rows - 2)};
}

Paint make_model(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, Model& m) {
  const float blur = square(optics.lens_px) + pixel_variance, beam = square(optics.beam_px);
  const std::int32_t last = windows.count - 1;
  const float near = 1 + near_share * optics.scatter;
  clear_haze(windows, optics.scatter, m);
  const Paint paint = straighten_plain_paint(windows, noise, near, m.paint);
  m.highest_level = Lanes{};
  m.skew = optics.skew;
  Lanes before = log(m.paint[0]), here = before;
  for (std::int32_t i = 0; i <= last; ++i) {
    const Lanes after = i < last ? log(m.paint[i + 1]) : here;
    const Lanes slope = 0.5f * (after - before), bend = after - 2 * here + before;
    const Lanes variance = beam + max(blur + square(blur) * bend, all_lanes(least_spread * blur));
    m.place[i] = static_cast<float>(i) + clamp(blur * slope, -most_shift_px, most_shift_px);
    m.inverse_variance[i] = 1 / variance;
    m.level[i] = m.paint[i] * optics.beam_px * sqrt(m.inverse_variance[i]);
    m.highest_level = max(m.highest_level, m.level[i]);
    const Lanes off = variance_of(noise, windows.ambient[i] + windows.background[i], near);
    const LaneMask differenced = windows.ambient[i] > 0;
    m.still_variance[i] = differenced ? off + off : off;
    const Lanes shared = differenced & ~paint.plain ? off / m.paint[i] : Lanes{};
    m.shared_noise[i] = shared + shared;
    m.paint_variance[i] = shared / m.paint[i];
    before = here;
    here = after;
  }
  return paint;
}

// Of a pixel in which the stripe is expected to be `light`: read and shot noise, speckle, and the noise of the paint that the stripe is a multiple of.
Lanes weight_of(const StripeWindows& windows, const PixelNoise& noise, const Model& m, std::int32_t row, Lanes light, Lanes peak) {
  const Lanes grey = max(light, Lanes{}), lit = grey + m.hazy_light[row];
  const Lanes by_light = lit * (1 / noise.electrons_per_grey + lit * square(noise.speckle));
  const Lanes by_paint = grey * (m.shared_noise[row] + grey * m.paint_variance[row]);
  return windows.valid[row] / max(m.still_variance[row] + by_light + by_paint + square(noise.model * peak), all_lanes(least_variance));
}

struct Shape {
  Lanes light, slope;  // of a stripe of height 1; slope over its centre
};

// A bell and Hermite's third function. The slope of each of Hermite's functions is the next one, turned.
Shape shape_at(const Model& m, std::int32_t row, Lanes centre) {
  const Lanes per_px = sqrt(m.inverse_variance[row]), z = (m.place[row] - centre) * per_px, z2 = z * z;
  const Lanes bell = m.level[row] * exp(-0.5f * z2);
  return {bell * (1 + m.skew * z * (z2 - 3)), bell * per_px * (z + m.skew * (z2 * (z2 - 6) + 3))};
}

// The best stripes whose centres are given. `explained`: by how much they lessen the sum of weighted squares.
struct Stripes {
  Lanes height{}, offset{}, explained{};
};

Stripes best_at(const StripeWindows& windows, const Model& m, Lanes centre) {
  Lanes ss{}, sp{}, pp{}, sd{}, pd{};  // s: shape, p: paint, d: the picture's stripe
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes shape = shape_at(m, i, centre).light, paint = m.paint[i], d = m.data[i];
    const Lanes ws = m.weight[i] * shape, wp = m.weight[i] * paint;
    ss += ws * shape;
    sp += ws * paint;
    pp += wp * paint;
    sd += ws * d;
    pd += wp * d;
  }
  const Lanes determinant = ss * pp - sp * sp;
  const LaneMask apart = determinant > least_determinant * ss * pp;
  const Lanes offset = (ss * pd - sp * sd) / determinant;
  const LaneMask with_offset = apart & (offset > 0);
  Stripes best;
  best.offset = with_offset ? offset : Lanes{};
  best.height = with_offset ? (sd * pp - pd * sp) / determinant : sd / max(ss, all_lanes(1e-20f));
  const LaneMask lit = best.height > 0;
  best.height = lit ? best.height : Lanes{};
  best.offset = lit ? best.offset : Lanes{};
  best.explained = best.height * sd + best.offset * pd;
  return best;
}

// The centres that explain most, to a part of the stripe's width. `inside` stays where that is not at the border of what was searched.
Lanes search(const StripeWindows& windows, const Model& m, float width, LaneMask& inside) {
  const float step = std::max(0.25f, search_step * width);
  const auto places = static_cast<std::int32_t>(std::ceil(searched * width / step)) + 1;
  Lanes most = all_lanes(-1), at = Lanes{};
  for (std::int32_t k = -places; k <= places; ++k) {
    const Lanes explained = best_at(windows, m, windows.start + static_cast<float>(k) * step).explained;
    const LaneMask better = explained > most;
    most = better ? explained : most;
    at = better ? all_lanes(static_cast<float>(k)) : at;
  }
  inside &= abs(at) < static_cast<float>(places);
  return windows.start + at * step;
}

// One step of Gauss and Newton over centre, height and offset, with weights of the fitted light, which has no noise of its own.
LaneMask refine(const StripeWindows& windows, const PixelNoise& noise, float width, Model& m, StripeFits& fits) {
  const Lanes peak = fits.height * m.highest_level;
  Lanes gg{}, gs{}, gp{}, gr{}, ss{}, sp{}, pp{}, sr{}, pr{},
      rr{};  // g: slope of the light over the centre, s: shape, p: paint, r: what is left
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const auto [shape, slope] = shape_at(m, i, fits.centre);
    const Lanes paint = m.paint[i], light = fits.height * shape;
    const Lanes weight = weight_of(windows, noise, m, i, light, peak);
    const Lanes g = fits.height * slope, r = m.data[i] - light - fits.offset * paint;
    const Lanes wg = weight * g, ws = weight * shape, wp = weight * paint;
    gg += wg * g;
    gs += wg * shape;
    gp += wg * paint;
    gr += wg * r;
    ss += ws * shape;
    sp += ws * paint;
    pp += wp * paint;
    sr += ws * r;
    pr += wp * r;
    rr += weight * r * r;
  }
  // Height and offset taken out of the normal equations: with an offset, and without one where it would be negative or cannot be told from the stripe.
  const Lanes determinant = ss * pp - sp * sp, safe_ss = max(ss, all_lanes(1e-20f));
  const LaneMask apart = determinant > least_determinant * ss * pp;
  const Lanes on_shape = (gs * pp - gp * sp) / determinant, on_paint = (gp * ss - gs * sp) / determinant;
  const Lanes information_with = gg - on_shape * gs - on_paint * gp;
  const Lanes move_with = (gr - on_shape * sr - on_paint * pr) / information_with;
  const Lanes offset_with = fits.offset + (ss * (pr - gp * move_with) - sp * (sr - gs * move_with)) / determinant;
  const LaneMask with_offset = apart & (information_with > 0) & (offset_with > 0);
  // Without, the residual has the light of the present offset again.
  const Lanes sr_without = sr + fits.offset * sp, gr_without = gr + fits.offset * gp;
  const Lanes information = with_offset ? information_with : gg - gs * gs / safe_ss;
  const Lanes whole = with_offset ? move_with : (gr_without - gs / safe_ss * sr_without) / information;
  const Lanes move = clamp(whole, -longest_step * width, longest_step * width);
  const Lanes height_with = fits.height + (pp * (sr - gs * move) - sp * (pr - gp * move)) / determinant;
  const Lanes height = with_offset ? height_with : fits.height + (sr_without - gs * move) / safe_ss;
  const LaneMask valid = (height > 0) & (information > 0);
  fits.centre = valid ? fits.centre + move : fits.centre;
  fits.height = valid ? height : fits.height;
  fits.offset = with_offset ? offset_with : Lanes{};
  fits.variance_px2 = 1 / information;
  fits.misfit = rr;
  return valid;
}

}  // namespace

float width_in_picture_px(const StripeOptics& optics) {
  return std::sqrt(square(optics.beam_px) + square(optics.lens_px) + pixel_variance);
}

std::int32_t reach_of_window(const StripeOptics& optics, bool with_background) {
  const float widths = with_background ? window_widths : alone_widths;
  const auto rows = static_cast<std::int32_t>(std::ceil(widths * width_in_picture_px(optics))) + 2;
  return std::min(rows, (StripeWindows::most_rows - 1) / 2);
}

float deviance(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, const StripeFits& fits, LaneMask among) {
  Model m;
  make_model(windows, optics, noise, m);
  const float scale =
      2 * std::log(1 + near_share * optics.scatter);  // from the clear picture's grey levels to those of the picture that was taken
  const Lanes peak = fits.height * m.highest_level;
  Lanes sum{};
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes light = fits.height * shape_at(m, i, fits.centre).light, left = m.data[i] - light - fits.offset * m.paint[i];
    const Lanes weight = weight_of(windows, noise, m, i, light, peak);
    const LaneMask counted = among & (weight > 0);
    sum += select(counted, weight * square(left) - log(max(weight, all_lanes(1e-20f))) + scale, Lanes{});
  }
  float total = 0;
  for (int lane = 0; lane < lane_count; ++lane) total += sum[lane];
  return total;
}

PixelWeights weights_of(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, const StripeFits& fits) {
  Model m;
  make_model(windows, optics, noise, m);
  const float near = 1 + near_share * optics.scatter;
  const Lanes peak = fits.height * m.highest_level;
  PixelWeights weights;
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes light = fits.height * shape_at(m, i, fits.centre).light, weight = weight_of(windows, noise, m, i, light, peak);
    weights.rows[i] = weight / square(near);
    weights.brightest = max(weights.brightest, weight * square(light));
  }
  return weights;
}

float squares_left(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, const StripeFits& fits,
                   const PixelWeights& weights, LaneMask among) {
  Model m;
  make_model(windows, optics, noise, m);
  const float near = 1 + near_share * optics.scatter;
  Lanes sum{};
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes light = fits.height * shape_at(m, i, fits.centre).light;
    sum += select(among, weights.rows[i] * square(near * (m.data[i] - light - fits.offset * m.paint[i])), Lanes{});
  }
  float total = 0;
  for (int lane = 0; lane < lane_count; ++lane) total += sum[lane];
  return total;
}

SpeckleVariances speckle_between(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise,
                                 const StripeFits& fits) {
  Model m;
  make_model(windows, optics, noise, m);
  const Lanes peak = fits.height * m.highest_level;
  // The heights are those of what is left of the shape beside the offset's.
  Lanes sp{}, pp{};
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes shape = shape_at(m, i, fits.centre).light;
    m.weight[i] = weight_of(windows, noise, m, i, fits.height * shape, peak);
    sp += m.weight[i] * shape * m.paint[i];
    pp += m.weight[i] * square(m.paint[i]);
  }
  const Lanes on_paint = fits.offset > 0 ? sp / pp : Lanes{};
  // Variances of the heights as the fit weighs its pixels: of a speckle of 1, and of all else.
  Lanes ss{}, speckled{}, still{};
  PixelNoise even = noise;
  even.speckle = even.model = 0;
  for (std::int32_t i = 0; i < windows.count; ++i) {
    const Lanes shape = shape_at(m, i, fits.centre).light, light = fits.height * shape, beside = shape - on_paint * m.paint[i];
    const Lanes without = weight_of(windows, even, m, i, light, peak), on_height = square(m.weight[i] * beside);
    ss += m.weight[i] * square(beside);
    speckled += on_height * square(light);
    still += without > 0 ? on_height / without : Lanes{};
  }
  const Lanes relative = 1 / max(square(ss * fits.height), all_lanes(1e-20f));
  speckled *= relative;
  still *= relative;
  const LaneMask among = fits.found & fits.plain;
  SpeckleVariances variances;
  for (int a = 0, b = 1; b < lane_count; ++a, ++b) {
    if (among[a] == 0 || among[b] == 0) continue;
    if (!(still[a] + still[b] < faintest * (speckled[a] + speckled[b]))) continue;
    const float apart = 2 * (fits.height[a] - fits.height[b]) / (fits.height[a] + fits.height[b]);
    const float variance = (square(apart) / median_of_square - still[a] - still[b]) / (speckled[a] + speckled[b]);
    if (std::isfinite(variance)) (void)variances.push_back(variance);
  }
  return variances;
}

StripeFits fit_stripes(const StripeWindows& windows, const StripeOptics& optics, const PixelNoise& noise, FitStart start) {
  StripeFits fits;
  if (windows.count < 3 || windows.count > StripeWindows::most_rows) return fits;
  Lanes valid{};
  for (std::int32_t i = 0; i < windows.count; ++i) valid += windows.valid[i];

  const float width = width_in_picture_px(optics);
  Model m;
  const Paint paint = make_model(windows, optics, noise, m);
  fits.plain = paint.plain;
  fits.painted = paint.painted;
  Lanes highest{};
  for (std::int32_t i = 0; i < windows.count; ++i) highest = max(highest, m.data[i]);
  // Where the stripe is, its brightest pixels tell, speckled or not.
  PixelNoise even = noise;
  even.speckle = 0;
  for (std::int32_t i = 0; i < windows.count; ++i) m.weight[i] = weight_of(windows, even, m, i, m.data[i], highest);
  fits.found = valid >= least_rows;
  const bool far = start == FitStart::far || (start == FitStart::filter && any(~fits.plain));
  fits.centre = far ? search(windows, m, width, fits.found) : windows.start;
  const Stripes begin = best_at(windows, m, fits.centre);
  fits.height = begin.height;
  fits.offset = begin.offset;
  fits.found &= begin.height > 0;
  for (int step = 0; step < steps; ++step) fits.found &= refine(windows, noise, width, m, fits);
  fits.misfit /= max(valid - 3, all_lanes(1));
  fits.found &= abs(fits.centre - windows.start) < farthest * width;
  return fits;
}

}  // namespace lf::scan
