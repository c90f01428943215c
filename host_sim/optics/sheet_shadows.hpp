// What specks in a laser's sheet take from its light.
//
// Beyond a speck its shadow goes on along the rays: away from the emitter along the fan, and across the sheet as the beam widens. There it is an ellipse of the
// speck's own proportions to the beam, drawn as a rectangle as large. A speck is opaque, and what it scatters does not reach the surface.
// Left out: the shadow in the beam's lobe, and the stripe that a speck hides from the camera. Where two shadows overlap, both take their light.
#pragma once

#include <cstddef>
#include <vector>

#include "shared/lanes/lanes.hpp"

namespace lf::optics {

class SheetShadows {
 public:
  // A speck in its sheet: its place along the fan, as tan(angle), and across it in standard deviations of the beam there; its radius in the same two measures.
  struct Caster {
    float tangent = 0, across = 0;
    float radius_tangent = 0, radius_across = 0;
    float range_m = 0;  // from the emitter
  };

  // A fan of tan(half its angle).
  SheetShadows(std::vector<Caster> casters, float tan_half_fan);

  // Light that is missing on places of these coordinates and ranges, over the beam's in its middle there. Each is a pixel that is `pixel_tangent` by `pixel_across`
  // large (full sides). Of the lanes not in `wanted`: 0.
  Lanes taken(LaneMask wanted, Lanes tangent, Lanes across, Lanes range_m, Lanes pixel_tangent, Lanes pixel_across) const;

 private:
  std::size_t bin_of(float tangent) const;

  float tan_half_fan_;
  std::vector<Caster> casters_;
  std::vector<std::vector<std::size_t>> bins_;  // casters whose shadow falls there, even in the tangent
};

}  // namespace lf::optics
