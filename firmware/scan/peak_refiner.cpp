#include "firmware/scan/peak_refiner.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/scan/exposure_gain.hpp"
#include "firmware/scan/pixel_noise.hpp"

namespace lf::scan {
namespace {

constexpr std::size_t blocks_at_first = 8;  // of eight peaks: 64 of them tell the stripe's width within 2 %
constexpr std::size_t blocks_later = 2;
constexpr std::uint32_t first_pictures = 8;        // with as many blocks as the very first
constexpr std::size_t far_more = 2;                // times as many peaks as learning began with: it begins anew
constexpr float clear_water = 0.01f;               // of the scatter: below it the haze is a grey level at most
constexpr std::uint32_t look_for_haze = 8;         // pictures
constexpr float least_read_grey = 0.35f;           // rounding alone is 0.29
constexpr int first_rounds = 12;                   // of learning, in the first picture
constexpr float settled = 0.02f;                   // change of a round: what 64 columns can tell
constexpr float most_electrons = 4000;             // a grey level
constexpr float most_model_share = 0.3f;           // of the stripe's peak: beyond it no column is a misfit
constexpr std::int32_t farthest_half_height = 20;  // rows from a peak
constexpr float half_height_to_sigma = 1 / 2.355f;
// Rows about a window's ends, most of them beyond, by which the background is told where there is no picture of it: twice as many as the stripe has, so that their noise
// hardly moves its centre.
constexpr std::int32_t inside_border = 3, least_border = 3;
constexpr float border_widths = 5.0f;

// By how much a shape that is no bell moves the centre, over width times skew and over width times share. A second lobe, 1.9 to 2.6 widths beside the stripe and 5 to 30 %
// as high, moves it by 2 to 4 times the skew that is found. A nearer lobe makes the stripe wider and hardly skewed: no picture tells it from a wider beam, and the laser's
// calibration takes it in. What is left over moves it most where it looks like a bell's slope, whose rms in the window is 0.42: by 1 / 0.42 times the share.
constexpr float shift_by_skew = 3.0f, shift_by_share = 2.4f;

// The model's share goes half of the way, as a factor, to where the median of the misfits is between these. Haze that is not learned yet makes 1.2, a camera that
// sharpens 5 and more.
constexpr float low_misfit = 0.7f, high_misfit = 1.5f;
constexpr float least_misfit = 0.3f;  // of noise that is there: with a speckle of 0.18 that is not, columns at marks have 0.5 and more

// Returns whether it is there. Where less is left although the model's share is at its least, the noise is less than was supposed: at marks no plain column tells the speckle, and pictures may
// have no noise at all.
template <class Misfits>
bool follow_misfits(Misfits& misfits, PixelNoise& noise) {
  if (misfits.empty()) return true;
  float& model = noise.model;
  const auto middle = misfits.begin() + static_cast<std::ptrdiff_t>(misfits.size() / 2);
  std::nth_element(misfits.begin(), middle, misfits.end());
  const float wanted = std::clamp(*middle, low_misfit, high_misfit);
  if (model == least_model_share && *middle < least_misfit) {
    const float less = std::sqrt(std::max(*middle / least_misfit, 0.25f));
    noise.speckle *= less;
    noise.read_grey = std::max(noise.read_grey * less, least_read_grey);
    noise.electrons_per_grey = std::min(noise.electrons_per_grey / (less * less), most_electrons);
    return less > 0.9f;
  }
  model = std::clamp(model * std::sqrt(std::max(*middle / wanted, 0.01f)), least_model_share, most_model_share);
  return *middle == wanted || model == least_model_share || model == most_model_share;
}

}  // namespace

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
std::size_t BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::refine(const PixelView<Pixel>& image, const PixelView<Pixel>& background,
                                                                 std::span<Peak> peaks) {
  if (!image.valid() || image.width > MaxWidth || image.height > MaxHeight) return 0;
  if (background.valid() && (background.width != image.width || background.height != image.height)) return 0;
  if (peaks.empty()) return 0;
  const Pair pair{image, background};
  // What a few columns told, of a hand's edge perhaps, does not outlive the picture that shows the stripe.
  if (begun_ && peaks.size() >= far_more * begun_with_) begin_anew();
  gain_ = background.valid() ? gain_between(image, background, config_.full_scale, config_.axis == PeakAxis::row) : 1;
  // In clear water the haze is looked at now and then.
  hazy_ = background.valid() && (optics().scatter > clear_water || pictures_ % look_for_haze == 0);
  if (hazy_) {
    haze_on_.compute(image, config_.haze_near_px);
    haze_off_.compute(background, config_.haze_near_px);
  }
  if (pictures_ % look_for_haze == 0) learn_read_noise(pair);
  learn(pair, peaks);

  std::size_t kept = 0;
  for (std::size_t first = 0; first < peaks.size(); first += lane_count) {
    const std::span<Peak> block = peaks.subspan(first, std::min<std::size_t>(lane_count, peaks.size() - first));
    StripeWindows windows;
    const Firsts firsts = gather(pair, block, windows);
    const StripeFits fits = fit_stripes(windows, optics(), noise_, FitStart::filter);
    for (std::size_t lane = 0; lane < block.size(); ++lane) {
      const int i = static_cast<int>(lane);
      if (!fits.found[i]) {
        ++counters_.not_fitted;
        continue;
      }
      if (!(fits.misfit[i] < config_.largest_misfit)) {
        ++counters_.misfits;
        continue;
      }
      Peak peak = block[lane];
      along(peak) = static_cast<float>(firsts[lane]) + fits.centre[i];
      peak.deviation_px = std::sqrt(fits.variance_px2[i]);
      peaks[kept++] = peak;
      ++counters_.refined;
    }
  }
  return kept;
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
float BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::shape_doubt_px() const {
  if (!begun_) return 0;
  const float skew = std::abs(optics().skew) + estimate_.skew_doubt();
  return width_in_picture_px(optics()) * (shift_by_skew * skew + shift_by_share * (noise_.model - least_model_share));
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
void BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::begin_anew() {
  estimate_ = OpticsEstimate(config_.optics);
  noise_ = config_.noise;
  noise_.model = std::max(noise_.model, least_model_share);
  speckle_ = {};
  begun_ = false;
  pictures_ = 0;
}

// The pixels' noise beyond that of their light. A picture alone may be black about the stripe, where half of the noise is clipped: it only tells of more than was configured.
template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
void BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::learn_read_noise(const Pair& pair) {
  const NoiseAlong along = config_.axis == PeakAxis::column ? NoiseAlong::columns : NoiseAlong::rows;
  const float electrons = noise_.electrons_per_grey;
  const float seen_grey = pair.off.valid() ? read_noise_grey(pair.on, pair.off, gain_, electrons, config_.full_scale, along)
                                           : read_noise_grey(pair.on, electrons, config_.full_scale, along);
  const float least = pair.off.valid() ? least_read_grey : config_.noise.read_grey;
  if (seen_grey > 0) noise_.read_grey = std::max(seen_grey, least);
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
void BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::learn(const Pair& pair, std::span<Peak> peaks) {
  if (!begun_) begin_with_width(pair, peaks);
  const std::size_t blocks = peaks.size() / lane_count,
                    taken = std::min(blocks, pictures_ < first_pictures ? blocks_at_first : blocks_later);
  ++pictures_;
  for (int round = begun_ ? first_rounds : 1; round <= first_rounds && taken > 0; ++round) {
    StaticVector<float, blocks_at_first * lane_count> misfits;
    for (std::size_t i = 0; i < taken; ++i) {
      StripeWindows windows;
      // Others in each picture.
      const std::size_t block = (i * blocks / taken + pictures_) % blocks;
      gather(pair, peaks.subspan(block * lane_count, lane_count), windows);
      const StripeFits fits = fit_stripes(windows, optics(), noise_, FitStart::filter);
      for (int lane = 0; lane < lane_count; ++lane) {
        if (fits.found[lane]) (void)misfits.push_back(fits.misfit[lane]);
      }
      estimate_.add(windows, noise_, fits);
      speckle_.add(speckle_between(windows, optics(), noise_, fits));
    }
    noise_.speckle = speckle_.contrast_or(noise_.speckle);
    const bool fits_well = follow_misfits(misfits, noise_);
    if (estimate_.update() < settled && fits_well) break;
  }
  estimate_.end_picture();
  if (!begun_) begun_with_ = peaks.size();
  begun_ = begun_ || taken > 0;
}

// The median of the peaks' widths at half of their height.
template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
void BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::begin_with_width(const Pair& pair, std::span<Peak> peaks) {
  std::array<std::int32_t, 2 * farthest_half_height + 2> counts{};
  std::int32_t measured = 0;
  for (Peak& peak : peaks) {
    const std::int32_t line = line_at(pair, peak), middle = static_cast<std::int32_t>(std::lround(along(peak)));
    if (middle < 0 || middle >= length(pair)) continue;
    const bool two = pair.off.valid();
    const float beside =
        two ? 0 : 0.5f * (grey(pair.on, line, middle - farthest_half_height) + grey(pair.on, line, middle + farthest_half_height));
    const auto stripe = [&](std::int32_t place) {
      return grey(pair.on, line, place) - (two ? gain_ * grey(pair.off, line, place) : beside);
    };
    const float half = 0.5f * stripe(middle);
    if (!(half > 0)) continue;
    std::int32_t before = 0, after = 0;
    while (before < farthest_half_height && stripe(middle - before - 1) > half) ++before;
    while (after < farthest_half_height && stripe(middle + after + 1) > half) ++after;
    const std::int32_t width = before + after + 1;
    ++counts[static_cast<std::size_t>(width)];
    ++measured;
  }
  if (measured == 0) return;
  std::int32_t below = 0;
  std::size_t median = 0;
  while (2 * (below + counts[median]) < measured) below += counts[median++];
  const float sigma = half_height_to_sigma * static_cast<float>(median), lens = config_.optics.lens_px;
  const float beam2 = sigma * sigma - lens * lens - 1.0f / 12;
  estimate_ = OpticsEstimate({std::sqrt(std::max(beam2, 0.1f)), lens, config_.optics.scatter});
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
std::int32_t BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::line_at(const Pair& pair, const Peak& peak) const {
  const bool columns = config_.axis == PeakAxis::column;
  const auto last = static_cast<float>((columns ? pair.on.width : pair.on.height) - 1);
  return static_cast<std::int32_t>(std::lround(std::clamp(columns ? peak.u_px : peak.v_px, 0.0f, last)));
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
auto BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::line_of(const PixelView<Pixel>& picture, std::int32_t line) const -> Line {
  if (config_.axis == PeakAxis::column) return {picture.data + line, picture.stride};
  return {picture.row(line), 1};
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
float BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::grey(const PixelView<Pixel>& picture, std::int32_t line, std::int32_t place) const {
  if (!picture.valid()) return 0;
  const std::int32_t last = (config_.axis == PeakAxis::column ? picture.height : picture.width) - 1;
  const Line pixels = line_of(picture, line);
  return 255.0f / static_cast<float>(config_.full_scale) *
         static_cast<float>(pixels.first[std::clamp<std::int32_t>(place, 0, last) * pixels.step]);
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
float BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::haze(const BasicHaze<Pixel, MaxWidth, MaxHeight>& of, std::int32_t line,
                                                         std::int32_t place) const {
  const auto a = static_cast<float>(line), b = static_cast<float>(place);
  return 255.0f / static_cast<float>(config_.full_scale) * (config_.axis == PeakAxis::column ? of.at(a, b) : of.at(b, a));
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
auto BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::gather(const Pair& pair, std::span<Peak> peaks, StripeWindows& windows) -> Firsts {
  // A plateau tells nothing: what its flanks need comes on top.
  std::int32_t plateau = 0;
  for (const Peak& peak : peaks) plateau = std::max<std::int32_t>(plateau, peak.clipped);
  const std::int32_t reach = std::min(reach_of_window(optics(), pair.off.valid()) + plateau / 2, (StripeWindows::most_rows - 1) / 2);
  windows.count = 2 * reach + 1;
  windows.hazy = hazy_;
  Firsts firsts{};
  for (std::size_t lane = 0; lane < firsts.size(); ++lane) {
    Peak& peak = peaks[std::min(lane, peaks.size() - 1)];
    firsts[lane] = static_cast<std::int32_t>(std::lround(along(peak))) - reach;
    windows.start[static_cast<int>(lane)] = along(peak) - static_cast<float>(firsts[lane]);
    put(pair, line_at(pair, peak), firsts[lane], static_cast<int>(lane), windows);
  }
  return firsts;
}

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
void BasicPeakRefiner<Pixel, MaxWidth, MaxHeight>::put(const Pair& pair, std::int32_t line, std::int32_t first, int lane,
                                                       StripeWindows& windows) const {
  const std::int32_t last = windows.count - 1, end = length(pair) - 1;
  const bool two = pair.off.valid();
  const float to_grey = 255.0f / static_cast<float>(config_.full_scale);
  const Line on = line_of(pair.on, line), off = two ? line_of(pair.off, line) : on;
  // Of a picture alone: what lies about its window's ends, and the straight line between is the background.
  const auto border = std::max(least_border, static_cast<std::int32_t>(std::ceil(border_widths * width_in_picture_px(optics()))));
  const float middle = static_cast<float>(inside_border) - 0.5f * static_cast<float>(border + 1);
  float before = 0, after = 0;
  for (std::int32_t i = 0; !two && i < border; ++i) {
    before += grey(pair.on, line, first + inside_border - 1 - i) / static_cast<float>(border);
    after += grey(pair.on, line, first + last - inside_border + 1 + i) / static_cast<float>(border);
  }
  for (std::int32_t i = 0; i <= last; ++i) {
    const std::int32_t place = first + i, inside = std::clamp<std::int32_t>(place, 0, end);
    const auto lit = static_cast<std::int32_t>(on.first[inside * on.step]);
    const float passed = (static_cast<float>(i) - middle) / (static_cast<float>(last) - 2 * middle);
    const float background = two ? gain_ * to_grey * static_cast<float>(off.first[inside * off.step]) : before + (after - before) * passed;
    const auto row = static_cast<std::size_t>(i);
    windows.stripe[row][lane] = to_grey * static_cast<float>(lit) - background;
    windows.ambient[row][lane] = two ? background : 0;
    windows.background[row][lane] = two ? 0 : std::max(background, 0.0f);
    windows.valid[row][lane] = place == inside && lit < config_.full_scale ? 1.0f : 0.0f;
    if (!hazy_) continue;
    windows.ambient_haze[row][lane] = gain_ * haze(haze_off_, line, place);
    windows.stripe_haze[row][lane] = haze(haze_on_, line, place) - windows.ambient_haze[row][lane];
  }
}

template class BasicPeakRefiner<std::uint8_t, 320, 240>;
template class BasicPeakRefiner<std::uint8_t, 640, 480>;
template class BasicPeakRefiner<std::uint8_t, 4096, 4096>;
template class BasicPeakRefiner<std::uint16_t, 4096, 4096>;

}  // namespace lf::scan
