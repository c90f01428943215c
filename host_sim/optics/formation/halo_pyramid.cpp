#include "host_sim/optics/formation/halo_pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/lanes/lanes.hpp"

namespace lf::optics {
namespace {

constexpr int strip = 8;                // rows of a block of work
constexpr double least_width_px = 1.3;  // of a Gaussian in the picture that it is applied to: below it the halving's own shape shows
constexpr std::size_t margin = GaussianTaps::most + lane_count;

int halved(int size) { return (size + 1) / 2; }
std::size_t padded(int width) { return (static_cast<std::size_t>(width) + lane_count - 1) / lane_count * lane_count; }

// Beyond a row's ends it goes on as it ends.
void pad(float* row, int width) {
  std::fill_n(row - margin, margin, row[0]);
  std::fill_n(row + width, margin, row[width - 1]);
}

// Halves one plane, or the sum of two, by (1 3 3 1) / 8 both ways, and writes row r of that. Unlike the mean of 2x2, this keeps the light's mean place. `row` has room
// for `margin` on both sides.
template <std::size_t planes>
void halve_row(const std::array<PlaneView<const float>, planes>& from, int r, float* row, float* to) {
  const int width = from[0].width, height = from[0].height;
  const auto clamped = [height](int v) { return std::clamp(v, 0, height - 1); };
  std::array<std::array<const float*, 4>, planes> rows;
  for (std::size_t i = 0; i < planes; ++i)
    rows[i] = {from[i].row(clamped(2 * r - 1)), from[i].row(2 * r), from[i].row(clamped(2 * r + 1)), from[i].row(clamped(2 * r + 2))};
  for (int u = 0; u < width; u += lane_count) {
    Lanes near{}, far{};
    for (const auto& of : rows) {
      near += load_lanes(of[1] + u) + load_lanes(of[2] + u);
      far += load_lanes(of[0] + u) + load_lanes(of[3] + u);
    }
    store_lanes(row + u, 0.375f * near + 0.125f * far);
  }
  pad(row, width);
  for (int i = 0; 2 * i < width; i += lane_count) {
    const float* at = row + 2 * i;
    const auto evens = [](const float* p) {
      return __builtin_shufflevector(load_lanes(p), load_lanes(p + lane_count), 0, 2, 4, 6, 8, 10, 12, 14);
    };
    store_lanes(to + i, 0.375f * (evens(at) + evens(at + 1)) + 0.125f * (evens(at - 1) + evens(at + 2)));
  }
}

// Doubles `low` by straight lines between its pixels, and adds row v of that. `row` has room for `margin` on both sides.
void add_doubled_row(PlaneView<const float> low, int v, float* row, int width, float* onto) {
  const int near = v / 2, far = std::clamp(v % 2 == 0 ? near - 1 : near + 1, 0, low.height - 1);
  for (int i = 0; i < low.width; i += lane_count) {
    store_lanes(row + i, 0.75f * load_lanes(low.row(near) + i) + 0.25f * load_lanes(low.row(far) + i));
  }
  pad(row, low.width);
  for (int i = 0; 2 * i < width; i += lane_count) {
    const Lanes centre = 0.75f * load_lanes(row + i);
    const Lanes even = centre + 0.25f * load_lanes(row + i - 1), odd = centre + 0.25f * load_lanes(row + i + 1);
    store_lanes(onto + 2 * i, load_lanes(onto + 2 * i) + __builtin_shufflevector(even, odd, 0, 8, 1, 9, 2, 10, 3, 11));
    if (2 * i + lane_count >= width) break;
    store_lanes(onto + 2 * i + lane_count,
                load_lanes(onto + 2 * i + lane_count) + __builtin_shufflevector(even, odd, 4, 12, 5, 13, 6, 14, 7, 15));
  }
}

void add_blurred_row(PlaneView<const float> from, int v, const GaussianTaps& taps, float weight, float* row, float* onto) {
  for (int u = 0; u < from.width; u += lane_count) {
    Lanes sum = taps.tap[0] * load_lanes(from.row(v) + u);
    for (int k = 1; k <= taps.radius; ++k) {
      const float *above = from.row(std::max(v - k, 0)) + u, *below = from.row(std::min(v + k, from.height - 1)) + u;
      sum += taps.tap[static_cast<std::size_t>(k)] * (load_lanes(above) + load_lanes(below));
    }
    store_lanes(row + u, weight * sum);
  }
  pad(row, from.width);
  for (int u = 0; u < from.width; u += lane_count) {
    Lanes sum = taps.tap[0] * load_lanes(row + u);
    for (int k = 1; k <= taps.radius; ++k)
      sum += taps.tap[static_cast<std::size_t>(k)] * (load_lanes(row + u - k) + load_lanes(row + u + k));
    store_lanes(onto + u, load_lanes(onto + u) + sum);
  }
}

}  // namespace

HaloPyramid::HaloPyramid(int width, int height) {
  for (int w = halved(width), h = halved(height);; w = halved(w), h = halved(h)) {
    Level level{w, h, padded(w), {}, {}, {}};
    const std::size_t size = level.stride * static_cast<std::size_t>(h);
    level.scattered.resize(size), level.stray.resize(size), level.halo.resize(size);
    levels_.push_back(std::move(level));
    if (w == 1 && h == 1) break;
  }
  terms_.resize(levels_.size());
  row_.resize(padded(width) + 2 * margin);
}

void HaloPyramid::place(HaloTerm term, bool stray) {
  if (!(term.weight > 0)) return;
  std::size_t level = 0;
  double reduced = 2;
  while (level + 1 < levels_.size() && 2 * reduced * least_width_px <= term.sigma_px) reduced *= 2, ++level;
  const double own = (reduced * reduced - 1) / 2;
  const double rest = std::sqrt(std::max(term.sigma_px * term.sigma_px - own, 0.0)) / reduced;
  terms_[level].push_back({GaussianTaps::of(rest), term.weight, stray});
}

void HaloPyramid::halve_sources(PlaneView<const float> scattered, PlaneView<const float> grey, const SparsePlane& line, WorkerPool& pool) {
  Level& first = levels_.front();
  const auto has_line = [&](int r) {
    const auto begin = line.rows.begin() + std::max(2 * r - 1, 0), end = line.rows.begin() + std::min(2 * r + 3, grey.height);
    return std::any_of(begin, end, [](std::uint8_t has) { return has != 0; });
  };
  pool.run((first.height + strip - 1) / strip, [&](int block) {
    std::vector<float> row(padded(scattered.width) + 2 * margin);
    for (int r = block * strip; r < std::min((block + 1) * strip, first.height); ++r) {
      const std::size_t at = static_cast<std::size_t>(r) * first.stride;
      halve_row<1>({scattered}, r, row.data() + margin, first.scattered.data() + at);
      if (has_line(r))
        halve_row<2>({grey, line.plane}, r, row.data() + margin, first.stray.data() + at);
      else
        halve_row<1>({grey}, r, row.data() + margin, first.stray.data() + at);
    }
  });
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    const Level& from = levels_[i - 1];
    Level& to = levels_[i];
    const auto plane = [&](const std::vector<float>& values) {
      return PlaneView<const float>{values.data(), from.stride, from.width, from.height};
    };
    for (int r = 0; r < to.height; ++r) {
      const std::size_t at = static_cast<std::size_t>(r) * to.stride;
      halve_row<1>({plane(from.scattered)}, r, row_.data() + margin, to.scattered.data() + at);
      halve_row<1>({plane(from.stray)}, r, row_.data() + margin, to.stray.data() + at);
    }
  }
}

// The level's own terms on top of what the coarser levels gave.
void HaloPyramid::gather(std::size_t i) {
  Level& level = levels_[i];
  std::fill(level.halo.begin(), level.halo.end(), 0.f);
  float* row = row_.data() + margin;
  for (int v = 0; v < level.height; ++v) {
    float* onto = level.halo.data() + static_cast<std::size_t>(v) * level.stride;
    for (const Placed& term : terms_[i]) {
      const std::vector<float>& from = term.stray ? level.stray : level.scattered;
      add_blurred_row({from.data(), level.stride, level.width, level.height}, v, term.taps, term.weight, row, onto);
    }
    if (i + 1 == levels_.size()) continue;
    const Level& low = levels_[i + 1];
    add_doubled_row({low.halo.data(), low.stride, low.width, low.height}, v, row, level.width, onto);
  }
}

void HaloPyramid::add(PlaneView<const float> scattered, const std::vector<HaloTerm>& scattered_terms, PlaneView<const float> grey,
                      const SparsePlane& line, HaloTerm stray_term, PlaneView<float> onto, WorkerPool& pool) {
  for (auto& terms : terms_) terms.clear();
  for (const HaloTerm& term : scattered_terms) place(term, false);
  place(stray_term, true);
  halve_sources(scattered, grey, line, pool);
  for (std::size_t i = levels_.size(); i-- > 0;) gather(i);
  const Level& low = levels_.front();
  const int blocks = (onto.height + strip - 1) / strip;
  pool.run(blocks, [&](int block) {
    std::vector<float> row(padded(onto.width) + 2 * margin);
    for (int v = block * strip; v < std::min((block + 1) * strip, onto.height); ++v) {
      add_doubled_row({low.halo.data(), low.stride, low.width, low.height}, v, row.data() + margin, onto.width, onto.row(v));
    }
  });
}

}  // namespace lf::optics
