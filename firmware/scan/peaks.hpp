// Sub-pixel peaks of a laser stripe, one per image column (or row), or a few for a later choice by geometry.
//
// The stripe lies on a sloped, scattering background, so the brightest pixel and the centre of mass are biased toward the background's bright side.
// A zero-mean second-derivative filter does not see the background's offset and slope (Forest, Salvi, Cabruja, Pous, ICPR 2004, with the
// second derivative in place of the first: on a backscatter skirt the zero-mean Laplacian-of-Gaussian of sigma 2.5-3 px erred a third as much).
// The filter here is the cubic B-spline's second difference, sigma 2.83 px, 19 taps: -(1 - z^5)^4 / (1 - z)^2, so five shifted rows and two
// running sums in place of 19 multiplications; its sums wrap around in 16 bits, and the result, below 255 * 68, is exact all the same.
// A filter of twice the stripe's width sees it best, and a wide one takes neighbours for one. So the window follows the stripe: of a stripe wider than 2.6 px two rows are taken as
// one, and from 5.2 px on four, and with them all distances below.
// A stripe across an edge of the paint is pulled to its bright side, by up to 0.9 of its width: peak_refiner.hpp puts it where it is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "firmware/scan/pixel_view.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf::scan {

struct Peak {
  float u_px = 0;
  float v_px = 0;       // pixel centres at integers; sub-pixel along the scanned axis
  float amplitude = 0;  // grey levels of the brightest pixel over the local background
  float ratio = 0;      // second peak's response over this one's, 0..1; near 1 the choice is unsure
  std::uint8_t clipped =
      0;  // pixels of the stripe at full scale; above 3, in a wider window 6 or 12, the centre is the plateau's, and less sure
  float deviation_px = 0;  // standard deviation of the sub-pixel place by the noise; 0: not known
};

// Columns (or rows) seen by a detector, by what became of them. Never reset.
struct PeakCounters {
  std::uint64_t found = 0;
  std::uint64_t weak = 0;
  std::uint64_t saturated = 0;
  std::uint64_t ambiguous = 0;
};

inline constexpr std::int32_t max_peaks_per_line = 4;

enum class PeakAxis : std::uint8_t { column, row };

struct PeakConfig {
  PeakAxis axis = PeakAxis::column;  // along which the one peak is looked for
  // Response over its positive lobe's sum, grey levels; of rows that are taken together less, as their noise is. Noise of 1 grey level in both images gives 0.8 rms, and 480 rows of it 2.4 at most;
  // at 3 levels 7. A column of mere noise that passes fails at `max_ratio`, since noise has many peaks alike.
  float min_contrast = 7.0f;
  float max_ratio = 0.65f;  // of the second peak to the first
  // More than 1: further peaks of a line are given as well, at most `max_peaks_per_line`, and who knows where the laser is chooses among them. A part
  // that stands proud of a panel, seen from elsewhere than lit from, carries its piece of the stripe in front of columns that show the panel's piece
  // as well; and an arm that moved since the background was taken has edges in the difference.
  std::int32_t peaks_per_line = 1;
  float min_second_ratio =
      0.4f;  // of a further peak to the first: parts like the panel give 0.7 and more, edges of moving shadows mostly less
  // px at full scale. In a wider window a plateau of 2 or 4 times as many is a stripe's where its flanks are as soft as a bell's. A wider one is none and is passed over, where what is
  // left has `min_second_ratio` of it.
  std::int32_t max_clipped = 12;
  std::int32_t full_scale = 255;  // grey level at which the sensor clips
};

// Pixel: std::uint8_t or std::uint16_t. MaxLength: pixels along the scanned axis. All scratch memory is inside the object.
template <class Pixel, std::int32_t MaxLength>
class BasicPeakDetector {
 public:
  using Config = PeakConfig;
  static constexpr std::int32_t max_length = MaxLength;
  static constexpr std::int32_t min_length = 25;  // the filter's 19 taps and a peak's neighbours

  explicit BasicPeakDetector(const Config& config = {}) : config_(config) {}

  // Finds at most `peaks_per_line` peaks in each column (row) of `image` less `background`, and writes them to `peaks` in the order of columns
  // (rows), within one the strongest first.
  // `background`: the same scene with the laser off, the same size, of the same exposure or another; an invalid (empty) view leaves the differencing out.
  // Returns the number written; columns without a good peak are counted in `counters()`. Writes nothing when the image is not valid, of
  // another size than the background, shorter than `min_length`, longer than `max_length`, or when `peaks` has less than `peaks_per_line` places a column.
  // O(width * height), no allocation.
  std::size_t detect(const PixelView<Pixel>& image, const PixelView<Pixel>& background, std::span<Peak> peaks);

  // The stripe's standard deviation in the picture, as it was found (peak_refiner.hpp). 0, as at first: not known. Then a picture that shows hardly a stripe is searched with all windows,
  // and the one that finds clearly more is taken.
  void follow(float width_px) { width_px_ = width_px; }
  float followed_px() const { return width_px_; }
  // Rows that the newest picture was searched with as one.
  std::int32_t rows_as_one() const { return scale_; }
  static std::int32_t rows_as_one_for(float width_px);

  const PeakCounters& counters() const { return counters_; }

 private:
  // 64 lines at a time: their rows, sums and maxima stay in the first-level cache.
  static constexpr std::int32_t strip = 64;

  using Sum = std::conditional_t<sizeof(Pixel) == 1, std::uint16_t, std::uint32_t>;
  using Response = std::make_signed_t<Sum>;
  template <class T>
  using Lanes = std::array<T, strip>;

  // Up to 64 lines of the picture, from `first` on. `rows`: of the filter, each of `scale_` pixels.
  struct Strip {
    const PixelView<Pixel>& on;
    const PixelView<Pixel>& off;
    std::int32_t first, lines, length, rows;
  };

  struct Plateau {
    std::int32_t first = 0, length = 0;
  };

  std::size_t detect_with(std::int32_t scale, const PixelView<Pixel>& image, const PixelView<Pixel>& background, std::span<Peak> peaks);
  void load_row(const Strip& s, std::int32_t row);
  void load_pixels(const Strip& s, std::int32_t place, Sum* out);
  void take_difference(const Pixel* on, const Pixel* off, Sum* out) const;
  void load_block(const PixelView<Pixel>& image, const Strip& s, std::int32_t begin, std::array<Lanes<Pixel>, strip>& block) const;
  void sweep(const Strip& s);
  struct Maximum {
    std::int32_t row = 0;
    float response = 0;
    std::int32_t first = 0, last = 0;  // pixels about it whose maxima are the same stripe's
    Plateau plateau;
  };

  using Maxima = StaticVector<Maximum, max_peaks_per_line + 2>;  // with two plateaus

  std::size_t finish(const Strip& s, std::int32_t lane, std::span<Peak> peaks);
  Maximum maximum_at(const Strip& s, std::int32_t lane, std::int32_t row, float response) const;
  Maximum next_maximum(const Strip& s, std::int32_t lane, std::span<const Maximum> before) const;
  void measure(const Strip& s, std::int32_t lane, const Maximum& maximum, float ratio, Peak& peak);
  float response_peak(const Strip& s, std::int32_t lane, std::int32_t row) const;
  std::int32_t middle_of(std::int32_t row) const { return row * scale_ + scale_ / 2; }  // pixel
  std::int32_t pixel(const PixelView<Pixel>& image, std::int32_t line, std::int32_t row) const;
  std::int32_t difference(const Strip& s, std::int32_t line, std::int32_t row) const;
  Plateau find_plateau(const Strip& s, std::int32_t line, std::int32_t row) const;
  float flank(const Strip& s, std::int32_t line, std::int32_t end, std::int32_t step) const;
  bool is_stripe(const Strip& s, std::int32_t line, const Plateau& plateau) const;
  float plateau_centre(const Strip& s, std::int32_t line, const Plateau& plateau) const;
  float amplitude(const Strip& s, std::int32_t line, std::int32_t place) const;

  Config config_;
  PeakCounters counters_;
  float width_px_ = 0;
  std::int32_t scale_ = 1;   // pixels that are one row of the filter: 1, 2 or 4
  std::int32_t gain_ = 256;  // of the picture's exposure over the background's, in 256ths
  alignas(64) std::array<Lanes<Pixel>, strip> on_block_{}, off_block_{};
  alignas(64) std::array<Lanes<Sum>, 32> rows_{};               // the newest rows of the difference; the filter looks back 20
  alignas(64) Lanes<Sum> pixels_{};                             // of a row of several pixels, the one to be added
  alignas(64) Lanes<Sum> sum_{}, sum_of_sums_{};                // the filter's two integrators
  alignas(64) Lanes<Response> best_{}, second_{}, best_row_{};  // of each lane's local maxima
  alignas(64) std::array<Lanes<Response>, MaxLength> response_{};
};

// The core's, for 640x480 in both directions, and the desktop's.
using PeakDetector = BasicPeakDetector<std::uint8_t, 640>;
using LargePeakDetector = BasicPeakDetector<std::uint8_t, 4096>;
using LargePeakDetector16 = BasicPeakDetector<std::uint16_t, 4096>;

}  // namespace lf::scan
