#include "firmware/scan/peaks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "firmware/scan/exposure_gain.hpp"

namespace lf::scan {
namespace {

constexpr std::int32_t lanes = 64;
constexpr std::int32_t delay = 9;                // rows from the filter's newest tap to its centre
constexpr float positive_lobe = 34.0f;           // sum of the filter's positive taps 1 4 7 10 7 4 1
constexpr std::int32_t exclusion = 8;            // rows about a peak in which a second maximum is the same stripe's
constexpr std::int32_t background_distance = 9;  // rows from the peak, where the filter's negative lobe ends

// Of the filter's sigma. A bell of w before a filter of f is seen with f^2.5 / (w^2 + f^2)^1.5 of the noise: best at f = 2.24 w, three quarters of that at f = 1.08 w. The narrowest that
// sees so much keeps neighbours apart.
constexpr float widest_share = 1 / 1.08f;
constexpr float filter_sigma = 2.83f;
constexpr std::int32_t widest_scale = 4;
constexpr std::size_t more_lines = 8;  // a wider window is taken where it finds more by an eighth of the lines

constexpr std::int32_t gain_one = 256;       // a gain of 1 in fixed point
constexpr std::int32_t gain_told_apart = 3;  // from it: a hundredth, what the pictures tell of it

constexpr std::int32_t few_clipped = 3;        // rows at full scale that the filter does not mind
constexpr float flank_level = 0.6f;            // of a plateau's height
constexpr float most_overexposure_log = 3.9f;  // a bell of 50 times full scale, whose plateau is 5.6 of its sigmas
// Curvature over height of the response: 0.2225..0.227 for a stripe of sigma 1.7 px, more for a narrower one.
constexpr float narrow_curvature = 0.2225f;
constexpr std::int32_t narrow_half_width = 5;
constexpr std::array<float, 2 * narrow_half_width + 1> narrow_taps = {-1, -2, -3, 0, 3, 6, 3, 0, -3, -2, -1};

// Where the parabola through three equidistant values has its vertex, from the middle one.
float vertex(const float (&y)[3]) { return 0.5f * (y[0] - y[2]) / (y[0] - 2 * y[1] + y[2]); }

using NarrowWindow = std::array<float, narrow_taps.size() + 2>;

// Where the narrow filter's response to `window` is highest, from the window's middle; nothing where the middle is no maximum.
std::optional<float> narrow_vertex(const NarrowWindow& window) {
  float response[3] = {};
  for (std::size_t shift = 0; shift < 3; ++shift) {
    for (std::size_t k = 0; k < narrow_taps.size(); ++k) response[shift] += narrow_taps[k] * window[k + shift];
  }
  const bool maximum = response[1] >= response[0] && response[1] >= response[2] && 2 * response[1] > response[0] + response[2];
  if (!maximum || !(response[1] > 0)) return std::nullopt;
  return vertex(response);
}

// The same about `centre` of a line with the values `value(row)`; `centre` where there is no maximum within a pixel of it.
template <class Value>
float narrow_peak_about(float centre, const Value& value) {
  constexpr std::int32_t reach = narrow_half_width + 1;
  const auto middle = static_cast<std::int32_t>(std::lround(centre));
  std::array<float, narrow_taps.size() + 4> around;
  for (std::size_t k = 0; k < around.size(); ++k) around[k] = value(middle - reach - 1 + static_cast<std::int32_t>(k));
  for (const std::int32_t step : {0, -1, 1}) {
    NarrowWindow window;
    std::copy_n(around.begin() + step + 1, window.size(), window.begin());
    if (const auto offset = narrow_vertex(window)) return static_cast<float>(middle + step) + *offset;
  }
  return centre;
}

// The loops below are all there is to the detector's speed. Each stands alone with restricted pointers and a constant count, and masks in
// place of conditions: that is what GCC 12 turns into vector code.

template <class Pixel, class Sum>
[[gnu::noinline]] void subtract(const Pixel* __restrict on, const Pixel* __restrict off, Sum* __restrict out) {
  for (std::int32_t i = 0; i < lanes; ++i) out[i] = static_cast<Sum>(on[i] - off[i]);
}

// What the background would be with the picture's exposure. Where it is clipped nobody knows: there is no difference.
template <class Pixel, class Sum>
[[gnu::noinline]] void subtract_scaled(const Pixel* __restrict on, const Pixel* __restrict off, std::int32_t gain, std::int32_t full_scale,
                                       Sum* __restrict out) {
  for (std::int32_t i = 0; i < lanes; ++i) {
    const std::int32_t scaled = std::min((off[i] * gain + gain_one / 2) / gain_one, full_scale);
    out[i] = static_cast<Sum>(off[i] < full_scale ? on[i] - scaled : 0);
  }
}

template <class Sum>
[[gnu::noinline]] void add(const Sum* __restrict part, Sum* __restrict sum) {
  for (std::int32_t i = 0; i < lanes; ++i) sum[i] = static_cast<Sum>(sum[i] + part[i]);
}

// By 2 or 4, toward minus infinity: what is the same everywhere the filter does not see.
template <class Sum, class Response>
[[gnu::noinline]] void divide(std::int32_t by, Sum* values) {
  const int bits = by == 2 ? 1 : 2;
  for (std::int32_t i = 0; i < lanes; ++i) values[i] = static_cast<Sum>(static_cast<Response>(values[i]) >> bits);
}

// One step of -(1 - z^5)^4 / (1 - z)^2: `x5` is the row five before `x0`, and so on.
template <class Sum, class Response>
[[gnu::noinline]] void filter_step(const Sum* __restrict x0, const Sum* __restrict x5, const Sum* __restrict x10, const Sum* __restrict x15,
                                   const Sum* __restrict x20, Sum* __restrict sum, Sum* __restrict sum_of_sums,
                                   Response* __restrict response) {
  for (std::int32_t i = 0; i < lanes; ++i) {
    const Sum step = static_cast<Sum>(x0[i] + x20[i] - 4u * (x5[i] + x15[i]) + 6u * x10[i]);
    const Sum s = static_cast<Sum>(sum[i] + step);
    const Sum ss = static_cast<Sum>(sum_of_sums[i] + s);
    sum[i] = s;
    sum_of_sums[i] = ss;
    response[i] = static_cast<Response>(static_cast<Sum>(0u - ss));
  }
}

// Takes the middle row's local maxima into the best and the second of each lane.
template <class Response>
[[gnu::noinline]] void update_maxima(const Response* __restrict before, const Response* __restrict middle, const Response* __restrict after,
                                     Response row, Response* __restrict best, Response* __restrict second, Response* __restrict best_row) {
  for (std::int32_t i = 0; i < lanes; ++i) {
    const Response m = middle[i];
    const Response is_maximum = static_cast<Response>(-static_cast<Response>((m >= before[i]) & (m > after[i])));
    const Response candidate = static_cast<Response>(m & is_maximum);
    const Response b = best[i], s = second[i];
    const Response loser = b < candidate ? b : candidate;
    second[i] = s < loser ? loser : s;
    const Response wins = static_cast<Response>(-static_cast<Response>(candidate > b));
    best_row[i] = static_cast<Response>((row & wins) | (best_row[i] & ~wins));
    best[i] = b < candidate ? candidate : b;
  }
}

}  // namespace

template <class Pixel, std::int32_t MaxLength>
std::int32_t BasicPeakDetector<Pixel, MaxLength>::rows_as_one_for(float width_px) {
  std::int32_t scale = 1;
  while (scale < widest_scale && width_px > widest_share * filter_sigma * static_cast<float>(scale)) scale *= 2;
  return scale;
}

template <class Pixel, std::int32_t MaxLength>
std::size_t BasicPeakDetector<Pixel, MaxLength>::detect(const PixelView<Pixel>& image, const PixelView<Pixel>& background,
                                                        std::span<Peak> peaks) {
  if (!image.valid() || config_.peaks_per_line < 1 || config_.peaks_per_line > max_peaks_per_line) return 0;
  if (background.valid() && (background.width != image.width || background.height != image.height)) return 0;
  const bool columns = config_.axis == PeakAxis::column;
  const std::int32_t lines = columns ? image.width : image.height;
  const std::int32_t length = columns ? image.height : image.width;
  if (length < min_length || length > max_length ||
      peaks.size() < static_cast<std::size_t>(lines) * static_cast<std::size_t>(config_.peaks_per_line))
    return 0;

  if (!background.valid()) off_block_ = {};
  gain_ = gain_one;
  if (background.valid())
    gain_ = static_cast<std::int32_t>(std::lround(gain_one * gain_between(image, background, config_.full_scale, !columns)));
  if (std::abs(gain_ - gain_one) <= gain_told_apart) gain_ = gain_one;
  std::int32_t widest = widest_scale;
  while (length < min_length * widest) widest /= 2;
  if (width_px_ > 0) return detect_with(std::min(rows_as_one_for(width_px_), widest), image, background, peaks);

  const PeakCounters before = counters_;
  std::size_t count = detect_with(1, image, background, peaks);
  if (2 * count >= static_cast<std::size_t>(lines)) return count;
  std::int32_t best = 1;
  for (std::int32_t scale = 2; scale <= widest; scale *= 2) {
    counters_ = before;
    const std::size_t here = detect_with(scale, image, background, peaks);
    if (here <= count + static_cast<std::size_t>(lines) / more_lines) continue;
    best = scale;
    count = here;
  }
  if (best == scale_) return count;
  counters_ = before;
  return detect_with(best, image, background, peaks);
}

template <class Pixel, std::int32_t MaxLength>
std::size_t BasicPeakDetector<Pixel, MaxLength>::detect_with(std::int32_t scale, const PixelView<Pixel>& image,
                                                             const PixelView<Pixel>& background, std::span<Peak> peaks) {
  scale_ = scale;
  const bool columns = config_.axis == PeakAxis::column;
  const std::int32_t lines = columns ? image.width : image.height, length = columns ? image.height : image.width;
  std::size_t count = 0;
  for (std::int32_t first = 0; first < lines; first += strip) {
    const Strip s{image, background, first, std::min(strip, lines - first), length, (length + scale - 1) / scale};
    sweep(s);
    for (std::int32_t lane = 0; lane < s.lines; ++lane) count += finish(s, lane, peaks.subspan(count));
  }
  return count;
}

// The strip's `row`-th difference goes to its place in the ring. Of several pixels their mean.
template <class Pixel, std::int32_t MaxLength>
void BasicPeakDetector<Pixel, MaxLength>::load_row(const Strip& s, std::int32_t row) {
  Sum* out = rows_[row & 31].data();
  load_pixels(s, std::min(row * scale_, s.length - 1), out);
  for (std::int32_t i = 1; i < scale_; ++i) {
    load_pixels(s, std::min(row * scale_ + i, s.length - 1), pixels_.data());
    add(pixels_.data(), out);
  }
  if (scale_ > 1) divide<Sum, Response>(scale_, out);
}

template <class Pixel, std::int32_t MaxLength>
void BasicPeakDetector<Pixel, MaxLength>::load_pixels(const Strip& s, std::int32_t row, Sum* out) {
  const bool direct = config_.axis == PeakAxis::column && s.lines == strip;
  if (direct) {
    // A strip touches a cache line or two of every row, which on a large image the hardware does not foresee: asked for 16 rows ahead, 1920x1080 took
    // 1.8 ms in place of 6.6 on a busy machine.
    const std::int32_t ahead = std::min(row + 16, s.length - 1);
    __builtin_prefetch(s.on.row(ahead) + s.first);
    __builtin_prefetch(s.on.row(ahead) + s.first + strip - 1);
    if (s.off.valid()) {
      __builtin_prefetch(s.off.row(ahead) + s.first);
      __builtin_prefetch(s.off.row(ahead) + s.first + strip - 1);
    }
    const Pixel* off = s.off.valid() ? s.off.row(row) + s.first : off_block_[0].data();
    take_difference(s.on.row(row) + s.first, off, out);
    return;
  }
  if (row % strip == 0) {
    load_block(s.on, s, row, on_block_);
    if (s.off.valid()) load_block(s.off, s, row, off_block_);
  }
  take_difference(on_block_[row % strip].data(), off_block_[row % strip].data(), out);
}

template <class Pixel, std::int32_t MaxLength>
void BasicPeakDetector<Pixel, MaxLength>::take_difference(const Pixel* on, const Pixel* off, Sum* out) const {
  if (gain_ == gain_one)
    subtract(on, off, out);
  else
    subtract_scaled(on, off, gain_, config_.full_scale, out);
}

// Rows `begin` to `begin` + 63 of a strip that is not 64 columns of the image: turned, or narrower.
template <class Pixel, std::int32_t MaxLength>
void BasicPeakDetector<Pixel, MaxLength>::load_block(const PixelView<Pixel>& image, const Strip& s, std::int32_t begin,
                                                     std::array<Lanes<Pixel>, strip>& block) const {
  const std::int32_t rows = std::min(strip, s.length - begin);
  if (config_.axis == PeakAxis::column) {
    for (std::int32_t r = 0; r < rows; ++r) std::copy_n(image.row(begin + r) + s.first, s.lines, block[r].data());
    return;
  }
  for (std::int32_t lane = 0; lane < s.lines; ++lane) {
    const Pixel* line = image.row(s.first + lane) + begin;
    for (std::int32_t r = 0; r < rows; ++r) block[r][lane] = line[r];
  }
}

// Filters the strip from its first row to its last, the border rows repeated beyond them, and keeps each lane's two highest maxima.
template <class Pixel, std::int32_t MaxLength>
void BasicPeakDetector<Pixel, MaxLength>::sweep(const Strip& s) {
  sum_ = {};
  sum_of_sums_ = {};
  best_ = {};
  second_ = {};
  best_row_ = {};
  load_row(s, 0);
  for (std::int32_t i = 1; i < 32; ++i) rows_[i] = rows_[0];
  for (std::int32_t row = 0; row < s.rows + delay; ++row) {
    if (row < s.rows)
      load_row(s, row);
    else
      rows_[row & 31] = rows_[(s.rows - 1) & 31];
    Response* response = response_[std::max<std::int32_t>(row - delay, 0)].data();
    filter_step(rows_[row & 31].data(), rows_[(row - 5) & 31].data(), rows_[(row - 10) & 31].data(), rows_[(row - 15) & 31].data(),
                rows_[(row - 20) & 31].data(), sum_.data(), sum_of_sums_.data(), response);
    const std::int32_t middle = row - delay - 1;
    if (middle < 1) continue;
    update_maxima(response_[middle - 1].data(), response_[middle].data(), response, static_cast<Response>(middle), best_.data(),
                  second_.data(), best_row_.data());
  }
}

// From a lane's maxima to its peaks; none, and counted, when there is no good one.
template <class Pixel, std::int32_t MaxLength>
std::size_t BasicPeakDetector<Pixel, MaxLength>::finish(const Strip& s, std::int32_t lane, std::span<Peak> peaks) {
  // Also where the column has no maximum at all, and so no row of one.
  const float least = std::max(1.0f, config_.min_contrast * positive_lobe / std::sqrt(static_cast<float>(scale_)));
  if (static_cast<float>(best_[lane]) < least) {
    ++counters_.weak;
    return 0;
  }
  const bool several = config_.peaks_per_line > 1;
  const float share = several ? config_.min_second_ratio : config_.max_ratio;
  Maxima known;    // all looked at, highest first
  Maxima stripes;  // those of them that can be a stripe's
  Maximum next = maximum_at(s, lane, static_cast<std::int32_t>(best_row_[lane]), static_cast<float>(best_[lane]));
  // The second of all maxima is an upper bound of the next stripe's: within a wide one it may be the same stripe's.
  float second = static_cast<float>(second_[lane]);
  while (next.response >= least && !known.full()) {
    (void)known.push_back(next);
    if (is_stripe(s, s.first + lane, next.plateau)) (void)stripes.push_back(next);
    if (static_cast<std::int32_t>(stripes.size()) >= std::max<std::int32_t>(2, config_.peaks_per_line)) break;
    if (!stripes.empty() && second <= share * stripes[0].response) break;
    next = next_maximum(s, lane, std::span<const Maximum>(known.data(), known.size()));
    second = next.response;
    if (!stripes.empty() && second <= share * stripes[0].response) break;
  }
  if (stripes.empty()) {
    ++counters_.saturated;
    return 0;
  }
  // Of one peak a line: what is passed over may be the stripe itself, and what is left a ghost of it.
  if (!several && stripes[0].response < config_.min_second_ratio * known[0].response) {
    ++counters_.saturated;
    return 0;
  }
  const float ratio = (stripes.size() > 1 ? stripes[1].response : second) / stripes[0].response;
  // What is hardly above the noise has to be the only one.
  const bool alone = !several || stripes[0].response < 2 * least;
  if (alone && ratio > config_.max_ratio) {
    ++counters_.ambiguous;
    return 0;
  }
  // Noise has many maxima alike; stripes are few.
  if (several && static_cast<std::int32_t>(stripes.size()) >= config_.peaks_per_line) {
    const Maximum further = next_maximum(s, lane, std::span<const Maximum>(known.data(), known.size()));
    if (further.response > config_.max_ratio * stripes.back().response) {
      ++counters_.ambiguous;
      return 0;
    }
  }
  const std::size_t count = alone ? 1 : stripes.size();
  for (std::size_t i = 0; i < count; ++i) measure(s, lane, stripes[i], ratio, peaks[i]);
  return count;
}

template <class Pixel, std::int32_t MaxLength>
void BasicPeakDetector<Pixel, MaxLength>::measure(const Strip& s, std::int32_t lane, const Maximum& maximum, float ratio, Peak& peak) {
  const std::int32_t line = s.first + lane;
  const Plateau& plateau = maximum.plateau;
  const float position = plateau.length > few_clipped * scale_ ? plateau_centre(s, line, plateau) : response_peak(s, lane, maximum.row);
  peak.u_px = config_.axis == PeakAxis::column ? static_cast<float>(line) : position;
  peak.v_px = config_.axis == PeakAxis::column ? position : static_cast<float>(line);
  peak.amplitude = amplitude(s, line, middle_of(maximum.row));
  peak.ratio = ratio;
  peak.clipped = static_cast<std::uint8_t>(std::min<std::int32_t>(plateau.length, 255));
  ++counters_.found;
}

// The vertex of the parabola through the response's maximum and its neighbours. A stripe found narrow is filtered again with the same spline at a
// spacing of 3 px (sigma 1.63): on a stripe of sigma 0.7..1.5 px white noise then moves the peak by 28..12 % less, and a skirt by half.
template <class Pixel, std::int32_t MaxLength>
float BasicPeakDetector<Pixel, MaxLength>::response_peak(const Strip& s, std::int32_t lane, std::int32_t row) const {
  const float wide[3] = {static_cast<float>(response_[row - 1][lane]), static_cast<float>(response_[row][lane]),
                         static_cast<float>(response_[row + 1][lane])};
  const float centre = static_cast<float>(scale_) * (static_cast<float>(row) + vertex(wide)) + 0.5f * static_cast<float>(scale_ - 1);
  const bool narrow = scale_ == 1 && 2 * wide[1] - wide[0] - wide[2] >= narrow_curvature * wide[1];
  const std::int32_t line = s.first + lane;
  const auto raw = [&](std::int32_t v) { return static_cast<float>(difference(s, line, v)); };
  return narrow ? narrow_peak_about(centre, raw) : centre;
}

// A wide stripe's noisy top has several maxima that are one stripe: those within `exclusion` of the peak, or of its plateau.
template <class Pixel, std::int32_t MaxLength>
auto BasicPeakDetector<Pixel, MaxLength>::maximum_at(const Strip& s, std::int32_t lane, std::int32_t row, float response) const -> Maximum {
  const Plateau plateau = find_plateau(s, s.first + lane, row);
  const std::int32_t first = plateau.length > 0 ? plateau.first : middle_of(row);
  const std::int32_t last = plateau.length > 0 ? plateau.first + plateau.length - 1 : middle_of(row);
  return {row, response, first - exclusion * scale_, last + exclusion * scale_, plateau};
}

// The highest of the lane's maxima that belongs to none of the stripes `before`; of response 0 when there is none.
template <class Pixel, std::int32_t MaxLength>
auto BasicPeakDetector<Pixel, MaxLength>::next_maximum(const Strip& s, std::int32_t lane, std::span<const Maximum> before) const
    -> Maximum {
  Response highest = 0;
  std::int32_t highest_row = 0;
  for (std::int32_t row = 1; row < s.rows - 1; ++row) {
    const Response r = response_[row][lane];
    if (r <= highest || r < response_[row - 1][lane] || r <= response_[row + 1][lane]) continue;
    const std::int32_t place = middle_of(row);
    const bool known = std::any_of(before.begin(), before.end(), [place](const Maximum& m) { return place >= m.first && place <= m.last; });
    if (known) continue;
    highest = r;
    highest_row = row;
  }
  return highest > 0 ? maximum_at(s, lane, highest_row, static_cast<float>(highest)) : Maximum{};
}

template <class Pixel, std::int32_t MaxLength>
std::int32_t BasicPeakDetector<Pixel, MaxLength>::pixel(const PixelView<Pixel>& image, std::int32_t line, std::int32_t row) const {
  return config_.axis == PeakAxis::column ? image.row(row)[line] : image.row(line)[row];
}

template <class Pixel, std::int32_t MaxLength>
std::int32_t BasicPeakDetector<Pixel, MaxLength>::difference(const Strip& s, std::int32_t line, std::int32_t row) const {
  const std::int32_t inside = std::clamp<std::int32_t>(row, 0, s.length - 1);
  const std::int32_t on = pixel(s.on, line, inside);
  if (!s.off.valid()) return on;
  const std::int32_t off = pixel(s.off, line, inside);
  if (gain_ == gain_one) return on - off;
  return off < config_.full_scale ? on - std::min((off * gain_ + gain_one / 2) / gain_one, config_.full_scale) : 0;
}

// The run of full-scale pixels at the peak; empty when none of the three about it is at full scale.
template <class Pixel, std::int32_t MaxLength>
auto BasicPeakDetector<Pixel, MaxLength>::find_plateau(const Strip& s, std::int32_t line, std::int32_t row) const -> Plateau {
  const std::int32_t end = std::min((row + 2) * scale_, s.length);
  std::int32_t first = (row - 1) * scale_;
  while (first < end && pixel(s.on, line, first) < config_.full_scale) ++first;
  if (first >= end) return {};
  std::int32_t last = first;
  while (last + 1 < s.length && pixel(s.on, line, last + 1) >= config_.full_scale) ++last;
  while (first > 0 && pixel(s.on, line, first - 1) >= config_.full_scale) --first;
  return {first, last - first + 1};
}

// From the plateau's last pixel, at `end`, to where its flank crosses `flank_level`; negative where it does not. Between pixels a Gaussian's flank is near a straight line in the logarithm.
template <class Pixel, std::int32_t MaxLength>
float BasicPeakDetector<Pixel, MaxLength>::flank(const Strip& s, std::int32_t line, std::int32_t end, std::int32_t step) const {
  const float level = flank_level * static_cast<float>(difference(s, line, end));
  for (std::int32_t i = 0; i < exclusion * scale_; ++i) {
    const float inner = static_cast<float>(difference(s, line, end + i * step));
    const float outer = std::max(1.0f, static_cast<float>(difference(s, line, end + (i + 1) * step)));
    if (outer < level && inner >= level) return static_cast<float>(i) + std::log(inner / level) / std::log(inner / outer);
  }
  return -1;
}

// A bell that is clipped at a sigmas' distance has fallen to the share q of full scale d farther out, where d (2 a + d) = 2 ln(1 / q) sigmas^2, and its height is exp(a^2 / 2) of
// full scale. A lamp's flanks are steep: they would be those of a bell hundreds of times too bright.
template <class Pixel, std::int32_t MaxLength>
bool BasicPeakDetector<Pixel, MaxLength>::is_stripe(const Strip& s, std::int32_t line, const Plateau& plateau) const {
  if (plateau.length <= config_.max_clipped) return true;
  if (plateau.length > config_.max_clipped * scale_) return false;
  const float half = 0.5f * static_cast<float>(plateau.length - 1);
  const float steepest = half * half * -std::log(flank_level) / most_overexposure_log;
  const float before = flank(s, line, plateau.first, -1), after = flank(s, line, plateau.first + plateau.length - 1, 1);
  if (before < 0 || after < 0) return false;
  const float fall = 0.5f * (before + after);  // of each alone speckle makes more
  return fall * (2 * half + fall) > steepest;
}

// Midway between the flanks of a clipped stripe: the filter's response is flat on a plateau, the flanks are steep.
template <class Pixel, std::int32_t MaxLength>
float BasicPeakDetector<Pixel, MaxLength>::plateau_centre(const Strip& s, std::int32_t line, const Plateau& plateau) const {
  const auto crossing = [&](std::int32_t end, std::int32_t step) {
    const float fall = flank(s, line, end, step);
    if (fall >= 0) return static_cast<float>(end) + static_cast<float>(step) * fall;
    // A flank beyond the image is taken to be at its border.
    return static_cast<float>(std::clamp<std::int32_t>(end + step * exclusion * scale_, 0, s.length - 1));
  };
  return 0.5f * (crossing(plateau.first, -1) + crossing(plateau.first + plateau.length - 1, 1));
}

template <class Pixel, std::int32_t MaxLength>
float BasicPeakDetector<Pixel, MaxLength>::amplitude(const Strip& s, std::int32_t line, std::int32_t place) const {
  const std::int32_t top = std::max({difference(s, line, place - 1), difference(s, line, place), difference(s, line, place + 1)});
  const std::int32_t away = background_distance * scale_;
  const std::int32_t below = difference(s, line, place - away) + difference(s, line, place - away - 1) + difference(s, line, place + away) +
                             difference(s, line, place + away + 1);
  return static_cast<float>(top) - 0.25f * static_cast<float>(below);
}

template class BasicPeakDetector<std::uint8_t, 320>;
template class BasicPeakDetector<std::uint8_t, 640>;
template class BasicPeakDetector<std::uint8_t, 4096>;
template class BasicPeakDetector<std::uint16_t, 4096>;

}  // namespace lf::scan
