#include "host_sim/optics/formation/lens_spot.hpp"

#include <algorithm>
#include <cmath>

#include "shared/lanes/lanes.hpp"

namespace lf::optics {

LensSpot::LensSpot(int width, int height, double centre_px, double corner_px)
    : centre_u_(0.5 * (width - 1)),
      centre_v_(0.5 * (height - 1)),
      per_corner2_(1 / std::max(centre_u_ * centre_u_ + centre_v_ * centre_v_, 1.0)),
      variance_(centre_px * centre_px),
      growth_(corner_px * corner_px - centre_px * centre_px) {
  for (std::size_t i = 0; i < taps_.size(); ++i)
    taps_[i] = GaussianTaps::of(std::sqrt(variance_ + growth_ * static_cast<double>(i) / steps));
}

double LensSpot::sigma_px(double u, double v) const {
  const double du = u - centre_u_, dv = v - centre_v_;
  return std::sqrt(variance_ + growth_ * (du * du + dv * dv) * per_corner2_);
}

// Of the packet's middle.
const GaussianTaps& LensSpot::taps_of(int u, int v) const {
  const double du = u + 0.5 * (lane_count - 1) - centre_u_, dv = v - centre_v_;
  const double share = std::min((du * du + dv * dv) * per_corner2_, 1.0);
  return taps_[static_cast<std::size_t>(std::lround(share * steps))];
}

void LensSpot::show(PlaneView<const float> from, int v, const std::uint8_t* wanted, float* scratch, float* to) const {
  float* row = scratch + reach();
  const auto near = [&](int u) {
    if (wanted == nullptr) return true;
    const int packet = u / lane_count, last = (from.width - 1) / lane_count;
    for (int p = std::max(packet - 2, 0); p <= std::min(packet + 2, last); ++p) {
      if (wanted[p] != 0) return true;
    }
    return false;
  };
  const auto row_at = [&](int k) { return from.row(std::clamp(v + k, 0, from.height - 1)); };
  for (int u = 0; u < from.width; u += lane_count) {
    Lanes sum{};
    if (near(u)) {
      const GaussianTaps& taps = taps_of(u, v);
      sum = taps.tap[0] * load_lanes(row_at(0) + u);
      for (int k = 1; k <= taps.radius; ++k)
        sum += taps.tap[static_cast<std::size_t>(k)] * (load_lanes(row_at(-k) + u) + load_lanes(row_at(k) + u));
    }
    store_lanes(row + u, sum);
  }
  std::fill_n(scratch, reach(), row[0]);
  std::fill_n(row + from.width, reach(), row[from.width - 1]);
  for (int u = 0; u < from.width; u += lane_count) {
    Lanes sum{};
    if (wanted == nullptr || wanted[u / lane_count] != 0) {
      const GaussianTaps& taps = taps_of(u, v);
      sum = taps.tap[0] * load_lanes(row + u);
      for (int k = 1; k <= taps.radius; ++k)
        sum += taps.tap[static_cast<std::size_t>(k)] * (load_lanes(row + u - k) + load_lanes(row + u + k));
    }
    store_lanes(to + u, sum);
  }
}

}  // namespace lf::optics
