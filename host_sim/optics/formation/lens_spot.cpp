#include "host_sim/optics/formation/lens_spot.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "shared/lanes/lanes.hpp"

namespace lf::optics {

LensSpot::LensSpot(int width, int height, double centre_px, double corner_px)
    : centre_u_(0.5 * (width - 1)),
      centre_v_(0.5 * (height - 1)),
      per_corner2_(1 / std::max(centre_u_ * centre_u_ + centre_v_ * centre_v_, 1.0)),
      variance_(centre_px * centre_px),
      growth_(corner_px * corner_px - centre_px * centre_px),
      packets_a_row_(static_cast<std::size_t>((width + lane_count - 1) / lane_count)) {
  for (std::size_t i = 0; i < taps_.size(); ++i)
    taps_[i] = GaussianTaps::of(std::sqrt(variance_ + growth_ * static_cast<double>(i) / steps));
  step_.reserve(packets_a_row_ * static_cast<std::size_t>(height));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; u += lane_count) {
      const double du = u + 0.5 * (lane_count - 1) - centre_u_, dv = v - centre_v_;
      const double share = std::min((du * du + dv * dv) * per_corner2_, 1.0);
      step_.push_back(static_cast<std::uint8_t>(std::lround(share * steps)));
    }
  }
}

double LensSpot::sigma_px(double u, double v) const {
  const double du = u - centre_u_, dv = v - centre_v_;
  return std::sqrt(variance_ + growth_ * (du * du + dv * dv) * per_corner2_);
}

namespace {

using Rows = const float* const*;  // from the middle one, so many on both sides

// Packets from `first` up to `end` of one row: a filter along columns, and one along a row. Most spots reach four pixels; known to the compiler, such a reach has its
// taps in registers.
template <int known_radius>
void filter_down(Rows middle, int first, int end, const GaussianTaps& taps, float* to) {
  const int radius = known_radius > 0 ? known_radius : taps.radius;
  for (int u = first; u < end; u += lane_count) {
    Lanes sum = taps.tap[0] * load_lanes(middle[0] + u);
    for (int k = 1; k <= radius; ++k)
      sum += taps.tap[static_cast<std::size_t>(k)] * (load_lanes(middle[-k] + u) + load_lanes(middle[k] + u));
    store_lanes(to + u, sum);
  }
}

template <int known_radius>
void filter_along(const float* row, int first, int end, const GaussianTaps& taps, float* to) {
  const int radius = known_radius > 0 ? known_radius : taps.radius;
  for (int u = first; u < end; u += lane_count) {
    Lanes sum = taps.tap[0] * load_lanes(row + u);
    for (int k = 1; k <= radius; ++k) sum += taps.tap[static_cast<std::size_t>(k)] * (load_lanes(row + u - k) + load_lanes(row + u + k));
    store_lanes(to + u, sum);
  }
}

template <typename Filter>
void with_radius(int radius, const Filter& filter) {
  switch (radius) {
    case 2: return filter(std::integral_constant<int, 2>());
    case 3: return filter(std::integral_constant<int, 3>());
    case 4: return filter(std::integral_constant<int, 4>());
    case 5: return filter(std::integral_constant<int, 5>());
    default: return filter(std::integral_constant<int, 0>());
  }
}

void clear(float* to, int first, int end) { std::fill(to + first, to + end, 0.f); }

}  // namespace

void LensSpot::show(PlaneView<const float> from, int v, const std::uint8_t* wanted, float* scratch, float* to) const {
  float* row = scratch + reach();
  const std::uint8_t* step = step_row(v);
  const auto packets = static_cast<int>(packets_a_row_);
  const auto near = [&](int packet) {
    return wanted == nullptr || std::any_of(wanted + std::max(packet - 2, 0), wanted + std::min(packet + 2, packets - 1) + 1,
                                            [](std::uint8_t w) { return w != 0; });
  };
  const auto here = [&](int packet) { return wanted == nullptr || wanted[packet] != 0; };
  std::array<const float*, 2 * GaussianTaps::most + 1> rows;
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = from.row(std::clamp(v - GaussianTaps::most + static_cast<int>(i), 0, from.height - 1));

  // Neighbours with one spot are filtered together.
  const auto runs = [&](const auto& is_wanted, float* onto, const auto& filter) {
    for (int first = 0, end = 0; first < packets; first = end) {
      const bool filtered = is_wanted(first);
      for (end = first + 1; end < packets && step[end] == step[first] && is_wanted(end) == filtered;) ++end;
      if (filtered)
        filter(taps_[step[first]], first * lane_count, end * lane_count);
      else
        clear(onto, first * lane_count, end * lane_count);
    }
  };
  runs(near, row, [&](const GaussianTaps& taps, int first, int end) {
    with_radius(taps.radius, [&](auto radius) { filter_down<radius()>(rows.data() + GaussianTaps::most, first, end, taps, row); });
  });
  std::fill_n(scratch, reach(), row[0]);
  std::fill_n(row + from.width, reach(), row[from.width - 1]);
  runs(here, to, [&](const GaussianTaps& taps, int first, int end) {
    with_radius(taps.radius, [&](auto radius) { filter_along<radius()>(row, first, end, taps, to); });
  });
}

}  // namespace lf::optics
