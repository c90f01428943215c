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

// A filter along columns and one along a row, a packet at a time. Known to the compiler, the reach has its taps in registers.
template <int known_radius>
Lanes down(Rows middle, int u, const GaussianTaps& taps) {
  const int radius = known_radius > 0 ? known_radius : taps.radius;
  const float* tap = taps.tap.data();
  Lanes sum = tap[0] * load_lanes(middle[0] + u);
  for (int k = 1; k <= radius; ++k) sum += tap[k] * (load_lanes(middle[-k] + u) + load_lanes(middle[k] + u));
  return sum;
}

template <int known_radius>
Lanes along(const float* row, int u, const GaussianTaps& taps) {
  const int radius = known_radius > 0 ? known_radius : taps.radius;
  const float* tap = taps.tap.data();
  Lanes sum = tap[0] * load_lanes(row + u);
  for (int k = 1; k <= radius; ++k) sum += tap[k] * (load_lanes(row + u - k) + load_lanes(row + u + k));
  return sum;
}

// Most spots reach so far.
template <typename Filter>
Lanes with_radius(int radius, const Filter& filter) {
  switch (radius) {
    case 2: return filter(std::integral_constant<int, 2>());
    case 3: return filter(std::integral_constant<int, 3>());
    case 4: return filter(std::integral_constant<int, 4>());
    case 5: return filter(std::integral_constant<int, 5>());
    default: return filter(std::integral_constant<int, 0>());
  }
}

}  // namespace

void LensSpot::show(PlaneView<const float> from, int v, Packets wanted, float* scratch, float* to) const {
  constexpr int beside = 2;  // packets that light comes from
  float* row = scratch + reach();
  const std::uint8_t* step = step_row(v);
  std::array<const float*, 2 * GaussianTaps::most + 1> rows;
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = from.row(std::clamp(v - GaussianTaps::most + static_cast<int>(i), 0, from.height - 1));
  const int first = std::max(wanted.first - beside, 0), end = std::min(wanted.end + beside, static_cast<int>(packets_a_row_));
  for (int packet = first; packet < end; ++packet) {
    const GaussianTaps& taps = taps_[step[packet]];
    const int u = packet * lane_count;
    store_lanes(row + u, with_radius(taps.radius, [&](auto radius) { return down<radius()>(rows.data() + GaussianTaps::most, u, taps); }));
  }
  if (first == 0) std::fill_n(scratch, reach(), row[0]);
  if (end == static_cast<int>(packets_a_row_)) std::fill_n(row + from.width, reach(), row[from.width - 1]);
  for (int packet = wanted.first; packet < wanted.end; ++packet) {
    const GaussianTaps& taps = taps_[step[packet]];
    const int u = packet * lane_count;
    store_lanes(to + u, with_radius(taps.radius, [&](auto radius) { return along<radius()>(row, u, taps); }));
  }
}

}  // namespace lf::optics
