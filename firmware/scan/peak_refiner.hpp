// Puts a detector's peaks where the stripe is: each column's fit of the stripe to the paint that it lights (stripe_fit.hpp).
//
// The stripe's width and skew, the lens' blur, the water's haze, the speckle and how far the model holds are learned from the pictures, and kept from one to the next. The background may have another
// exposure.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "firmware/scan/haze.hpp"
#include "firmware/scan/optics_estimate.hpp"
#include "firmware/scan/peaks.hpp"
#include "firmware/scan/pixel_view.hpp"
#include "firmware/scan/speckle_estimate.hpp"
#include "firmware/scan/stripe_fit.hpp"

namespace lf::scan {

// What the fit's model leaves out at least, over the stripe's peak: one grey level of a stripe of 200. More is learned.
inline constexpr float least_model_share = 0.005f;

struct RefinerConfig {
  PeakAxis axis = PeakAxis::column;
  std::int32_t full_scale = 255;  // grey level at which the sensor clips
  PixelNoise noise;               // in grey levels of 0 to 255, whatever the pixels' bits are
  StripeOptics optics;            // where learning begins; the stripe's width is measured at half of its height in the first picture
  float haze_near_px = 8.0f;      // haze.hpp: 22 mrad
  // Mean square of what the fit leaves, over the noise's: above it, the column shows no stripe on paint but a silhouette, a shadow or two stripes.
  float largest_misfit = 6.0f;
};

// Peaks by what became of them. Never reset.
struct RefinerCounters {
  std::uint64_t refined = 0;
  std::uint64_t not_fitted = 0;  // no maximum within reach, or too few pixels that are not clipped
  std::uint64_t misfits = 0;
};

template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
class BasicPeakRefiner {
 public:
  explicit BasicPeakRefiner(const RefinerConfig& config = {}) : config_(config), estimate_(config.optics) { begin_anew(); }

  // Moves each of `peaks`, which a detector found in `image` less `background`, to its fit's centre. Drops, and counts, those without one; the others move up.
  // Returns how many are left. Without a background (an invalid view) the paint is taken to be plain. Returns 0 for an invalid image, one that is too large, and
  // a background of another size. O(peaks + width * height), no allocation.
  std::size_t refine(const PixelView<Pixel>& image, const PixelView<Pixel>& background, std::span<Peak> peaks);

  // Forgets what the pictures have told: of another scene, another arm's pose or another light. The counters go on.
  void begin_anew();

  // What the pictures have told so far.
  bool begun() const { return begun_; }
  const StripeOptics& optics() const { return estimate_.optics(); }
  float gain() const { return gain_; }  // of the newest picture over its background
  // The configured one, with read noise, speckle and the model's share as they were learned.
  const PixelNoise& noise() const { return noise_; }
  const RefinerCounters& counters() const { return counters_; }
  // By how much the centres of all columns may be off alike, because the stripe is not shaped as the fit takes it to be.
  float shape_doubt_px() const;

 private:
  struct Pair {
    const PixelView<Pixel>& on;
    const PixelView<Pixel>& off;
  };
  using Firsts = std::array<std::int32_t, lane_count>;  // row of each lane's window

  float& along(Peak& peak) const { return config_.axis == PeakAxis::column ? peak.v_px : peak.u_px; }
  // Within the picture, wherever the peak is said to be.
  std::int32_t line_at(const Pair& pair, const Peak& peak) const;
  std::int32_t length(const Pair& pair) const { return config_.axis == PeakAxis::column ? pair.on.height : pair.on.width; }
  // A line's pixels: `first` its first, `step` from one to the next.
  struct Line {
    const Pixel* first = nullptr;
    std::ptrdiff_t step = 0;
  };
  Line line_of(const PixelView<Pixel>& picture, std::int32_t line) const;
  // In grey levels of 0 to 255. Beyond the picture: that at its border. Of no picture: 0.
  float grey(const PixelView<Pixel>& picture, std::int32_t line, std::int32_t place) const;
  float haze(const BasicHaze<Pixel, MaxWidth, MaxHeight>& of, std::int32_t line, std::int32_t place) const;

  void begin_with_width(const Pair& pair, std::span<Peak> peaks);
  void learn_read_noise(const Pair& pair);
  void learn(const Pair& pair, std::span<Peak> peaks);
  // The windows of up to eight peaks; of fewer, the last is repeated.
  Firsts gather(const Pair& pair, std::span<Peak> peaks, StripeWindows& windows);
  void put(const Pair& pair, std::int32_t line, std::int32_t first, int lane, StripeWindows& windows) const;

  RefinerConfig config_;
  OpticsEstimate estimate_;
  RefinerCounters counters_;
  PixelNoise noise_;
  SpeckleEstimate speckle_;
  float gain_ = 1;
  bool begun_ = false;          // a picture has told the stripe's width
  std::size_t begun_with_ = 0;  // peaks
  bool hazy_ = false;           // the haze of the present pictures was computed
  std::uint32_t pictures_ = 0;
  BasicHaze<Pixel, MaxWidth, MaxHeight> haze_on_, haze_off_;
};

using PeakRefiner = BasicPeakRefiner<std::uint8_t, 640, 480>;
using LargePeakRefiner = BasicPeakRefiner<std::uint8_t, 4096, 4096>;
using LargePeakRefiner16 = BasicPeakRefiner<std::uint16_t, 4096, 4096>;

}  // namespace lf::scan
