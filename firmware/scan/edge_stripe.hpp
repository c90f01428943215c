// The centre of a laser stripe that lies across edges: a marker's cells, the panel's arris, a silhouette. A symmetric filter is pulled to the bright side.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace lf::scan {

// Rows about the filter's, in grey levels of 0 to 255.
struct StripeProfile {
  static constexpr std::int32_t half = 6;
  static constexpr std::int32_t rows = 2 * half + 1;  // row `half` is the middle
  template <class T>
  using Rows = std::array<T, rows>;

  Rows<float> stripe{};      // laser on less laser off
  Rows<float> background{};  // laser off
  Rows<bool> clipped{};      // at full scale with the laser on
};

// Whether the background has a step across the middle, or marks: the filter alone is pulled there.
bool has_edges(const StripeProfile& profile);

// The centre, in rows from the middle, of a Gaussian that is weighted by the background, less the water's veil, as its albedo: what is lit less by day is lit
// less by the laser. Least squares over centre, height and veil. Nothing where the stripe is no such product: a silhouette, a face that is turned away, shade.
std::optional<float> centre_on_marks(const StripeProfile& profile);

// The centre, in rows from the middle, by the stripe's flanks on both sides of the background's largest step. Each side by itself is a piece of a Gaussian of
// known width: ln d + v^2 / (2 sigma^2) is a straight line in v with the slope centre / sigma^2. The slopes of both sides are pooled, and the filter's
// `centre` is one more observation. Nothing where they contradict it; `centre` where there is no such step, or a texture that the stripe need not share.
std::optional<float> centre_by_flanks(const StripeProfile& profile, float centre);

}  // namespace lf::scan
