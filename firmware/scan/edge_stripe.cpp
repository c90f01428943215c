#include "firmware/scan/edge_stripe.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lf::scan {
namespace {

constexpr std::int32_t half = StripeProfile::half;

// Steps of the background. Against both sides' sum, a panel's arris has 0.15 to 0.3, a marker's border 0.7; bare metal, shading and glow stay below.
constexpr float least_change = 24.0f;  // over the four rows of either side, grey levels: below it is noise
constexpr float edge_step = 0.12f;     // between both sides of the middle, over their sum
constexpr float marks = 0.25f;         // all changes from row to row, over the brightest row
constexpr float least_mark = 12.0f;    // grey levels from one row to the next
constexpr float marks_floor = 8.0f;    // grey levels: of a background that is darker, changes are noise

// A stripe on marks. Of this width in clear water, with the lens' blur; in turbid it is wider, and the fit says so.
constexpr float marks_sigma = 1.5f;
constexpr float pixel_noise = 3.0f;          // grey levels, of the difference of two images
constexpr float relative_noise = 0.05f;      // speckle, and pixels that are a part of two cells
constexpr float largest_mean_square = 3.0f;  // of what the fit leaves, over the noise's
constexpr std::int32_t least_rows = 8;       // that are not clipped
constexpr float largest_veil = 0.9f;         // of the darkest row: what the water itself sends back; black paint is not quite black
constexpr std::int32_t quarters = 4;         // candidates a pixel
constexpr std::int32_t farthest = 14;        // candidates to either side of the middle

// A stripe at one edge. Its flank falls as that of a Gaussian this wide: 1.25 px in clear water, more in turbid, and the lens adds its blur.
constexpr float flank_sigma = 1.6f;
constexpr std::int32_t flank_reach = 4;        // rows
constexpr float flank_least = 8.0f;            // grey levels: below it a pixel says nothing of a flank
constexpr float flank_relative_noise = 0.03f;  // speckle and what the model leaves out
constexpr float filter_weight = 500.0f;        // of the filter's position, as a pixel's: (grey levels x px)^2
constexpr float largest_shift_px = 0.8f;       // of flanks against filter: what differs more is no single stripe
constexpr float texture = 0.55f;               // changes beside the step, over it: more is a texture, which the stripe need not share
constexpr float mixed_pixel = 0.2f;            // of the step: a pixel further than this from its side's level lies on the edge

float square(float x) { return x * x; }

// The place in an array of what is `places` from its middle.
constexpr std::size_t at(std::int32_t middle, std::int32_t places) {
  const std::int32_t index = middle + places;
  return static_cast<std::size_t>(index);
}

// exp(-(k / 4)^2 / (2 sigma^2)) for each distance that a row and a candidate can have.
constexpr std::size_t distances = quarters * half + farthest + 1;
constexpr auto bell = [] {
  static_assert(marks_sigma == 1.5f);
  constexpr double q = 0.9862071167439163;  // exp(-(1/4)^2 / (2 * 1.5^2))
  std::array<float, distances> values{};
  double value = 1, ratio = q;  // of neighbours: q, q^3, q^5, ...
  for (float& v : values) {
    v = static_cast<float>(value);
    value *= ratio;
    ratio *= q * q;
  }
  return values;
}();

// How much the background differs between both sides of the middle, over their sum; 0 where that is dark or noise.
float step_across(const StripeProfile& profile) {
  float before = 0, after = 0;
  for (std::int32_t i = 2; i <= 5; ++i) {
    before += profile.background[half - i];
    after += profile.background[half + i];
  }
  const float step = std::abs(before - after);
  return step > least_change ? step / (before + after) : 0;
}

bool has_marks(const StripeProfile& profile) {
  float largest = 0, sum = 0, brightest = profile.background[0];
  for (std::size_t i = 1; i < StripeProfile::rows; ++i) {
    const float change = std::abs(profile.background[i] - profile.background[i - 1]);
    largest = std::max(largest, change);
    sum += change;
    brightest = std::max(brightest, profile.background[i]);
  }
  return largest > least_mark && sum > marks * (brightest + marks_floor);
}

}  // namespace

bool has_edges(const StripeProfile& profile) { return step_across(profile) > edge_step || has_marks(profile); }

std::optional<float> centre_on_marks(const StripeProfile& profile) {
  if (!has_marks(profile)) return std::nullopt;
  StripeProfile::Rows<float> weight{};
  float squares = 0;
  std::int32_t used = 0;
  for (std::size_t i = 0; i < StripeProfile::rows; ++i) {
    if (profile.clipped[i]) continue;
    const float d = std::max(profile.stripe[i], 0.0f);
    weight[i] = 1 / (square(pixel_noise) + square(relative_noise * d));
    squares += weight[i] * square(profile.stripe[i]);
    ++used;
  }
  if (used < least_rows) return std::nullopt;
  const float darkest = *std::min_element(profile.background.begin(), profile.background.end());
  // What the best height and veil leave of the squares, for each candidate: d = height * (background - veil) * bell.
  std::array<float, 2 * farthest + 1> left;
  for (std::int32_t candidate = -farthest; candidate <= farthest; ++candidate) {
    float aa = 0, ab = 0, bb = 0, ad = 0, bd = 0;  // a: background * bell, b: bell
    for (std::int32_t row = 0; row < StripeProfile::rows; ++row) {
      const auto i = static_cast<std::size_t>(row);
      const float b = bell[static_cast<std::size_t>(std::abs(quarters * (row - half) - candidate))], a = profile.background[i] * b;
      const float wa = weight[i] * a, wb = weight[i] * b;
      aa += wa * a;
      ab += wa * b;
      bb += wb * b;
      ad += wa * profile.stripe[i];
      bd += wb * profile.stripe[i];
    }
    const float height = ad * bb - bd * ab, flat = bd * aa - ad * ab;  // of a and of b, both times the same positive determinant
    const float veil = height > 0 ? std::clamp(-flat / height, 0.0f, largest_veil * darkest) : largest_veil * darkest;
    const float with_data = ad - veil * bd, with_itself = aa - 2 * veil * ab + veil * veil * bb;
    const bool sound = with_data > 0 && with_itself > 0;
    left[at(farthest, candidate)] = sound ? squares - square(with_data) / with_itself : squares;
  }
  const auto best = static_cast<std::size_t>(std::min_element(left.begin(), left.end()) - left.begin());
  if (best == 0 || best + 1 == left.size() || !(left[best] < largest_mean_square * static_cast<float>(used))) return std::nullopt;
  const float curvature = left[best - 1] - 2 * left[best] + left[best + 1];
  const float vertex = curvature > 0 ? 0.5f * (left[best - 1] - left[best + 1]) / curvature : 0;
  return (static_cast<float>(best) - static_cast<float>(farthest) + vertex) / quarters;
}

std::optional<float> centre_by_flanks(const StripeProfile& profile, float centre) {
  if (!(step_across(profile) > edge_step)) return centre;
  const auto off = [&](std::int32_t row) { return profile.background[at(half, row)]; };
  const auto change = [&](std::int32_t row) { return std::abs(off(row + 1) - off(row)); };
  std::int32_t edge = 0;  // the step is between this row and the next
  for (std::int32_t row = -flank_reach; row < flank_reach; ++row) {
    if (change(row) > change(edge)) edge = row;
  }
  const float step = std::abs(off(edge + 2) - off(edge - 1));
  float elsewhere = 0;
  for (std::int32_t row = -flank_reach; row < flank_reach; ++row) {
    if (row < edge - 1 || row > edge + 1) elsewhere += change(row);
  }
  if (elsewhere > texture * step) return centre;
  const std::int32_t last_before = change(edge - 1) > mixed_pixel * step ? edge - 1 : edge;
  const std::int32_t first_after = change(edge + 1) > mixed_pixel * step ? edge + 2 : edge + 1;

  constexpr float variance = flank_sigma * flank_sigma;
  float moment = filter_weight * centre / variance, weight = filter_weight;
  const auto add_side = [&](std::int32_t first, std::int32_t last) {
    float w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (std::int32_t row = first; row <= last; ++row) {
      const std::size_t i = at(half, row);
      const float d = profile.stripe[i];
      if (d <= flank_least || profile.clipped[i]) continue;
      const float x = static_cast<float>(row), y = std::log(d) + x * x / (2 * variance);
      const float sure = d * d / (1 + square(flank_relative_noise * d));
      w += sure;
      wx += sure * x;
      wy += sure * y;
      wxx += sure * x * x;
      wxy += sure * x * y;
    }
    if (!(w > 0)) return;
    moment += wxy - wx * wy / w;
    weight += wxx - wx * wx / w;
  };
  add_side(-flank_reach, last_before);
  add_side(first_after, flank_reach);
  const float flanks = variance * moment / weight;
  if (!(std::abs(flanks - centre) <= largest_shift_px)) return std::nullopt;
  return flanks;
}

}  // namespace lf::scan
