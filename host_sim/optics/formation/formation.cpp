#include "host_sim/optics/formation/formation.hpp"

#include <algorithm>
#include <cmath>

namespace lf::optics {
namespace {

PlaneView<const float> plane_of(const PixelStore& pixels, const GreyPlanes& planes, std::size_t channel) {
  return {planes.data() + channel * pixels.plane + pixels.index(0, 0), pixels.stride, pixels.width, pixels.height};
}

// Light comes from packets this far beside: the spot's 16 pixels, and one for samples at edges.
constexpr int reach_packets = 3;

}  // namespace

Formation::Formation(const Camera& camera, const ForwardScatter& scatter)
    : camera_(camera),
      scatter_(scatter),
      pyramid_(camera.width(), camera.height()),
      lens_(camera.width(), camera.height(), camera.config.blur_px, camera.config.blur_px * camera.config.corner_blur),
      reach_rows_(GaussianTaps::of(camera.config.blur_px * std::max(camera.config.corner_blur, 1.0)).radius + 1),
      packets_a_row_(static_cast<std::size_t>((camera.width() + lane_count - 1) / lane_count)),
      near_line_(packets_a_row_ * static_cast<std::size_t>(camera.height())),
      any_line_(static_cast<std::size_t>(camera.height())) {}

void Formation::find_lines(const std::vector<std::uint8_t>& line_packets) {
  const int height = camera_.height(), columns = static_cast<int>(packets_a_row_);
  std::vector<std::uint8_t> wide(near_line_.size());
  for (int v = 0; v < height; ++v) {
    const std::uint8_t* from = line_packets.data() + static_cast<std::size_t>(v) * packets_a_row_;
    any_line_[static_cast<std::size_t>(v)] = std::any_of(from, from + columns, [](std::uint8_t lit) { return lit != 0; });
    if (!any_line_[static_cast<std::size_t>(v)]) continue;
    std::uint8_t* to = wide.data() + static_cast<std::size_t>(v) * packets_a_row_;
    for (int p = 0; p < columns; ++p) {
      for (int q = std::max(p - reach_packets, 0); q <= std::min(p + reach_packets, columns - 1); ++q) to[p] |= from[q];
    }
  }
  std::fill(near_line_.begin(), near_line_.end(), std::uint8_t{0});
  std::vector<std::uint8_t> lit(any_line_.size());
  for (int v = 0; v < height; ++v) {
    if (!any_line_[static_cast<std::size_t>(v)]) continue;
    const std::uint8_t* from = wide.data() + static_cast<std::size_t>(v) * packets_a_row_;
    for (int row = std::max(v - reach_rows_, 0); row <= std::min(v + reach_rows_, height - 1); ++row) {
      std::uint8_t* to = near_line_.data() + static_cast<std::size_t>(row) * packets_a_row_;
      for (int p = 0; p < columns; ++p) to[p] |= from[p];
      lit[static_cast<std::size_t>(row)] = 1;
    }
  }
  any_line_ = lit;
}

void Formation::add_ghost(PixelStore& pixels) const {
  const auto share = static_cast<float>(camera_.config.ghost_share);
  const auto shift = static_cast<int>(std::lround(camera_.config.ghost_px));
  if (share == 0) return;
  for (int v = shift; v < pixels.height; ++v) {
    if (any_line_[static_cast<std::size_t>(v - shift)] == 0) continue;
    for (std::size_t c = 0; c < pixels.channels; ++c) {
      float* onto = pixels.grey.data() + c * pixels.plane + pixels.index(0, v);
      const float* from = pixels.laser.data() + c * pixels.plane + pixels.index(0, v - shift);
      for (std::size_t u = 0; u < pixels.stride; u += lane_count)
        store_lanes(onto + u, load_lanes(onto + u) + share * load_lanes(from + u));
    }
  }
}

void Formation::spread(PixelStore& pixels, const std::vector<std::uint8_t>& line_packets, bool scatters, WorkerPool& pool) {
  find_lines(line_packets);
  // The sensor takes the strayed share off all light, so what is added here is over the rest.
  const auto stray = static_cast<float>(camera_.config.stray_share);
  std::vector<HaloTerm> terms;
  terms.reserve(scatter_.terms.size());
  for (const ScatterTerm& term : scatter_.terms)
    terms.push_back({term.weight / (1 - stray), static_cast<double>(term.angle_rad) * camera_.config.intrinsics.fy});
  if (!scatters) terms.clear();
  for (std::size_t c = 0; c < pixels.channels && (scatters || stray > 0); ++c) {
    const PlaneView<float> onto{pixels.grey.data() + c * pixels.plane + pixels.index(0, 0), pixels.stride, pixels.width, pixels.height};
    pyramid_.add(plane_of(pixels, pixels.scattered, c), terms, {plane_of(pixels, pixels.grey, c), plane_of(pixels, pixels.laser, c)},
                 {stray / (1 - stray), camera_.config.stray_px}, onto, pool);
  }
  add_ghost(pixels);
}

void Formation::expose_row(const PixelStore& pixels, int v, const Speckle& speckle, const Exposing& exposing, std::uint8_t* out) const {
  std::vector<float> scratch(pixels.stride + 2 * LensSpot::reach()), row(pixels.stride), line(pixels.stride);
  const std::size_t channels = pixels.channels;
  std::vector<float> interleaved(channels > 1 ? pixels.stride * channels : 0);
  const bool lit = any_line_[static_cast<std::size_t>(v)] != 0;
  const std::uint8_t* wanted = near_line_.data() + static_cast<std::size_t>(v) * packets_a_row_;
  constexpr WordLanes count_up{0, 1, 2, 3, 4, 5, 6, 7};
  for (std::size_t c = 0; c < channels; ++c) {
    lens_.show(plane_of(pixels, pixels.grey, c), v, nullptr, scratch.data(), row.data());
    if (lit) lens_.show(plane_of(pixels, pixels.laser, c), v, wanted, scratch.data(), line.data());
    for (std::size_t p = 0; lit && p < packets_a_row_; ++p) {
      if (wanted[p] == 0) continue;
      const std::size_t u = p * lane_count;
      const auto number =
          static_cast<std::uint32_t>((c * static_cast<std::size_t>(pixels.height) + static_cast<std::size_t>(v)) * pixels.stride + u);
      store_lanes(row.data() + u, load_lanes(row.data() + u) + load_lanes(line.data() + u) * speckle.factor(count_up + number));
    }
    for (std::size_t u = 0; channels > 1 && u < static_cast<std::size_t>(pixels.width); ++u) interleaved[u * channels + c] = row[u];
  }
  camera_.sensor.expose(channels > 1 ? interleaved.data() : row.data(), v, exposing, out);
}

}  // namespace lf::optics
