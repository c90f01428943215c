#include "host_sim/optics/sheet_shadows.hpp"

#include <algorithm>
#include <cmath>

namespace lf::optics {
namespace {

constexpr std::size_t bin_count = 512;
constexpr float largest_pixel_tangent = 0.06f;  // twice a pixel's at a focal length of 50 px, for slanted faces
constexpr float side_by_radius = 1.77245385f;   // of a square as large as a disc

struct Overlap {
  float low = 0, high = 0;
};

Overlap overlap(float pixel, float pixel_side, float place, float side) {
  return {std::max(pixel - 0.5f * pixel_side, place - 0.5f * side), std::min(pixel + 0.5f * pixel_side, place + 0.5f * side)};
}

// Of a bell of unit height and width.
float area(const Overlap& of) {
  constexpr float root_half = 0.70710678f, root_half_pi = 1.25331414f;
  return root_half_pi * (std::erf(of.high * root_half) - std::erf(of.low * root_half));
}

}  // namespace

SheetShadows::SheetShadows(std::vector<Caster> casters, float tan_half_fan) : tan_half_fan_(tan_half_fan), casters_(std::move(casters)) {
  if (casters_.empty()) return;
  bins_.resize(bin_count);
  for (std::size_t i = 0; i < casters_.size(); ++i) {
    const float half = 0.5f * (side_by_radius * casters_[i].radius_tangent + largest_pixel_tangent);
    for (std::size_t bin = bin_of(casters_[i].tangent - half); bin <= bin_of(casters_[i].tangent + half); ++bin) bins_[bin].push_back(i);
  }
}

std::size_t SheetShadows::bin_of(float tangent) const {
  const float share = std::clamp(0.5f + 0.5f * tangent / tan_half_fan_, 0.0f, 1.0f);
  return std::min(static_cast<std::size_t>(share * bin_count), bin_count - 1);
}

// A speck's shadow is a rectangle of its area, and what it takes from a pixel is the beam's light on their overlap.
Lanes SheetShadows::taken(LaneMask wanted, Lanes tangent, Lanes across, Lanes range_m, Lanes pixel_tangent, Lanes pixel_across) const {
  Lanes sum{};
  if (bins_.empty()) return sum;
  for (int lane = 0; lane < lane_count; ++lane) {
    if (wanted[lane] == 0) continue;
    for (const std::size_t i : bins_[bin_of(tangent[lane])]) {
      const Caster& caster = casters_[i];
      if (range_m[lane] <= caster.range_m) continue;
      const Overlap along = overlap(tangent[lane], pixel_tangent[lane], caster.tangent, side_by_radius * caster.radius_tangent);
      const Overlap beside = overlap(across[lane], pixel_across[lane], caster.across, side_by_radius * caster.radius_across);
      if (along.high > along.low && beside.high > beside.low)
        sum[lane] += (along.high - along.low) / pixel_tangent[lane] * area(beside) / pixel_across[lane];
    }
  }
  return sum;
}

}  // namespace lf::optics
