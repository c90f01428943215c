// The light of a picture that water has scattered far on its way to the camera: a smooth haze of the picture itself.
//
// Of the light that scatters once on the way from a surface, sea water lays 25 % into a Gaussian of 8 px about where it came from, 27 % into one of 32 px and
// 12 % into one of 128 px (Petzold's mean phase function in the single-scattering kernel of Wells, 1977; pixels of 2.77 mrad; other cameras scale all three). A
// picture y of a scene x is then x + S M(x), with M these three and S = exp(b R) - 1 at a scattering of b over the range R. Light that is scattered less far, into
// 2 px and the core, widens the picture as the lens does and is left to the fit's blur.
//
// The haze is smooth: it is computed in cells of 8 by 8 pixels, its wide parts in cells of 16 by 16.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/scan/pixel_view.hpp"

namespace lf::scan {

// Of the light that scatters once: what goes into each Gaussian, and the share of a uniform picture that M is.
inline constexpr float near_haze = 0.248f, far_haze = 0.275f, farthest_haze = 0.118f;
inline constexpr float haze_share = near_haze + far_haze + farthest_haze;
// What scatters near: it belongs to the picture that the lens blurs.
inline constexpr float near_share = 0.136f + 0.199f;

// Pictures of up to MaxWidth by MaxHeight pixels. All memory is inside the object.
template <class Pixel, std::int32_t MaxWidth, std::int32_t MaxHeight>
class BasicHaze {
 public:
  // Computes M of `picture`, 8 px being `near_px` pixels of this camera. Beyond its borders the picture goes on as it ends. An invalid view, or one that is too
  // large, leaves a haze of 0. O(width * height), no allocation.
  void compute(const PixelView<Pixel>& picture, float near_px = 8.0f);

  // At a pixel, grey levels. Outside the picture: that at its border.
  float at(float u, float v) const;

 private:
  static constexpr std::int32_t cell = 8, coarse = 2;  // pixels a cell, cells a coarse cell

  template <std::int32_t Columns, std::int32_t Rows>
  struct Plane {
    std::int32_t columns = 0, rows = 0;
    std::array<float, static_cast<std::size_t>(Columns) * static_cast<std::size_t>(Rows)> values{};

    float* row(std::int32_t r) { return values.data() + static_cast<std::ptrdiff_t>(r) * Columns; }
    const float* row(std::int32_t r) const { return values.data() + static_cast<std::ptrdiff_t>(r) * Columns; }
    void resize(std::int32_t c, std::int32_t r) { columns = c, rows = r; }
    // The straight line between cells; `x` and `y` in cells, a cell's centre at its number.
    float at(float x, float y) const;
    // Blurs by `sigma` cells and multiplies by `share`.
    void blur(float sigma, float share, Plane& scratch);
  };
  static constexpr std::int32_t cells_of(std::int32_t pixels, std::int32_t size) { return (pixels + size - 1) / size; }
  using Fine = Plane<cells_of(MaxWidth, cell), cells_of(MaxHeight, cell)>;
  using Coarse = Plane<cells_of(MaxWidth, cell* coarse), cells_of(MaxHeight, cell* coarse)>;

  void add_up(const PixelView<Pixel>& picture);
  void add_up_cells();

  Fine fine_, fine_scratch_;
  Coarse coarse_, widest_, coarse_scratch_;
};

using Haze = BasicHaze<std::uint8_t, 640, 480>;

}  // namespace lf::scan
