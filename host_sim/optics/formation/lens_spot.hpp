// The lens's spot over the field of view: round, and wider toward the corners.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host_sim/optics/formation/gaussian_taps.hpp"
#include "host_sim/optics/formation/halo_pyramid.hpp"

namespace lf::optics {

class LensSpot {
 public:
  // The spot's standard deviation is `centre_px` in the middle of the picture and `corner_px` at its corners; its variance grows with the distance squared.
  LensSpot(int width, int height, double centre_px, double corner_px);

  double sigma_px(double u, double v) const;

  // Packets of eight pixels of a row, from `first` to before `end`.
  struct Packets {
    int first = 0, end = 0;
  };

  // The wanted packets of row v of `from` as the lens shows it, into `to` (room for the padded width); the others are left as they are. `scratch` has room for a row and
  // reach() on both sides.
  void show(PlaneView<const float> from, int v, Packets wanted, float* scratch, float* to) const;

  static constexpr std::size_t reach() { return GaussianTaps::most + 8; }

 private:
  static constexpr int steps = 32;  // of the variance, from the centre to the corners
  // One a packet of eight pixels.
  const std::uint8_t* step_row(int v) const { return step_.data() + static_cast<std::size_t>(v) * packets_a_row_; }

  double centre_u_, centre_v_, per_corner2_, variance_, growth_;
  std::array<GaussianTaps, steps + 1> taps_;
  std::size_t packets_a_row_;
  std::vector<std::uint8_t> step_;  // of each packet's middle
};

}  // namespace lf::optics
