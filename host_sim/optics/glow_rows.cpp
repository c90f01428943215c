#include "host_sim/optics/glow_rows.hpp"

namespace lf::optics {
namespace {

constexpr float most_change = 0.1f;

bool all(LaneMask mask) { return !any(~mask); }

bool is_even(const Glow& a, const Glow& b) {
  LaneMask alike = a.zone == b.zone;
  for (std::size_t band = 0; band < a.radiance.size(); ++band)
    alike &= abs(a.radiance[band] - b.radiance[band]) <= most_change * max(a.radiance[band], b.radiance[band]);
  return all(alike);
}

}  // namespace

GlowRows::GlowRows(const Camera& camera, const Shader& shader, int first, int end)
    : camera_(camera),
      shader_(shader),
      first_(first),
      end_(end),
      packets_a_row_(static_cast<std::size_t>((camera.width() + lane_count - 1) / lane_count)) {
  columns_.reserve(shader.sheets.size() * packets_a_row_);
  for (const SheetLight& sheet : shader.sheets) {
    for (int u = 0; u < camera.width(); u += lane_count) {
      Column column{sheet.glow(camera.lines(u, first), shader.water()), sheet.glow(camera.lines(u, end), shader.water())};
      column.even = is_even(column.upper, column.lower);
      columns_.push_back(column);
    }
  }
}

Glow GlowRows::at(std::size_t sheet, int u, int v) const {
  const Column& column = columns_[sheet * packets_a_row_ + static_cast<std::size_t>(u / lane_count)];
  if (!column.even) return shader_.sheets[sheet].glow(camera_.lines(u, v), shader_.water());
  const Glow &upper = column.upper, &lower = column.lower;
  const float share = static_cast<float>(v - first_) / static_cast<float>(end_ - first_);
  Glow glow;
  glow.zone = upper.zone;
  // Along a row of rays the depth's inverse goes straight, as a plane's does.
  glow.parameter = upper.parameter * lower.parameter / (lower.parameter + share * (upper.parameter - lower.parameter));
  for (std::size_t band = 0; band < glow.radiance.size(); ++band)
    glow.radiance[band] = upper.radiance[band] + share * (lower.radiance[band] - upper.radiance[band]);
  return glow;
}

}  // namespace lf::optics
