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
      line_span_(static_cast<std::size_t>(camera.height())),
      has_line_(static_cast<std::size_t>(camera.height())) {}

void Formation::find_lines(const std::vector<std::uint8_t>& line_packets) {
  const int height = camera_.height(), columns = static_cast<int>(packets_a_row_);
  std::fill(near_line_.begin(), near_line_.end(), std::uint8_t{0});
  std::fill(has_line_.begin(), has_line_.end(), std::uint8_t{0});
  std::fill(line_span_.begin(), line_span_.end(), LensSpot::Packets{columns, 0});
  std::vector<std::uint8_t> wide(packets_a_row_);
  for (int v = 0; v < height; ++v) {
    const std::uint8_t* from = line_packets.data() + static_cast<std::size_t>(v) * packets_a_row_;
    const bool lit = std::any_of(from, from + columns, [](std::uint8_t lit_packet) { return lit_packet != 0; });
    if (!lit) continue;
    // Samples at edges lay light a row beside.
    for (int row = std::max(v - 1, 0); row <= std::min(v + 1, height - 1); ++row) has_line_[static_cast<std::size_t>(row)] = 1;
    std::fill(wide.begin(), wide.end(), std::uint8_t{0});
    int first = columns, end = 0;
    for (int p = 0; p < columns; ++p) {
      if (from[p] == 0) continue;
      const int low = std::max(p - reach_packets, 0), high = std::min(p + reach_packets + 1, columns);
      std::fill(wide.begin() + low, wide.begin() + high, std::uint8_t{1});
      first = std::min(first, low), end = high;
    }
    for (int row = std::max(v - reach_rows_, 0); row <= std::min(v + reach_rows_, height - 1); ++row) {
      std::uint8_t* to = near_line_.data() + static_cast<std::size_t>(row) * packets_a_row_;
      for (int p = 0; p < columns; ++p) to[p] |= wide[static_cast<std::size_t>(p)];
      LensSpot::Packets& span = line_span_[static_cast<std::size_t>(row)];
      span.first = std::min(span.first, first), span.end = std::max(span.end, end);
    }
  }
}

void Formation::add_ghost(PixelStore& pixels) const {
  const auto share = static_cast<float>(camera_.config.ghost_share);
  const auto shift = static_cast<int>(std::lround(camera_.config.ghost_px));
  if (share == 0) return;
  for (int v = shift; v < pixels.height; ++v) {
    if (has_line_[static_cast<std::size_t>(v - shift)] == 0) continue;
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
    pyramid_.add(plane_of(pixels, pixels.scattered, c), terms, plane_of(pixels, pixels.grey, c),
                 {plane_of(pixels, pixels.laser, c), has_line_}, {stray / (1 - stray), camera_.config.stray_px}, onto, pool);
  }
  add_ghost(pixels);
}

void Formation::expose_row(const PixelStore& pixels, int v, const Speckle& speckle, const Exposing& exposing, std::uint8_t* out) const {
  // Kept from row to row.
  static thread_local std::vector<float> scratch, row, line, grains, interleaved;
  const std::size_t channels = pixels.channels;
  scratch.resize(pixels.stride + 2 * LensSpot::reach()), row.resize(pixels.stride), line.resize(pixels.stride),
      grains.resize(pixels.stride);
  interleaved.resize(channels > 1 ? pixels.stride * channels : 0);
  const LensSpot::Packets span = line_span_[static_cast<std::size_t>(v)];
  const std::uint8_t* near = near_line_.data() + static_cast<std::size_t>(v) * packets_a_row_;
  for (std::size_t c = 0; c < channels; ++c) {
    lens_.show(plane_of(pixels, pixels.grey, c), v, {0, static_cast<int>(packets_a_row_)}, scratch.data(), row.data());
    if (span.first < span.end) lens_.show(plane_of(pixels, pixels.laser, c), v, span, scratch.data(), line.data());
    const auto row_number =
        static_cast<std::uint32_t>((c * static_cast<std::size_t>(pixels.height) + static_cast<std::size_t>(v)) * pixels.stride);
    for (int p = span.first, end = p; p < span.end; p = end) {
      while (end < span.end && near[end] == near[p]) ++end;
      if (near[p] == 0) continue;
      const std::size_t u = static_cast<std::size_t>(p) * lane_count, after = static_cast<std::size_t>(end) * lane_count;
      speckle.factors(row_number + static_cast<std::uint32_t>(u), after - u, grains.data() + u);
      for (std::size_t i = u; i < after; i += lane_count)
        store_lanes(row.data() + i, load_lanes(row.data() + i) + load_lanes(line.data() + i) * load_lanes(grains.data() + i));
    }
    for (std::size_t u = 0; channels > 1 && u < static_cast<std::size_t>(pixels.width); ++u) interleaved[u * channels + c] = row[u];
  }
  camera_.sensor.expose(channels > 1 ? interleaved.data() : row.data(), v, exposing, out);
}

}  // namespace lf::optics
