// A laser line's light on surfaces and in the water.
//
// The stripe is analytic. The surface at a hit point is its tangent plane; the plane through the camera's centre and the line in which the sheet cuts that
// tangent plane gives the pixel's distance to the stripe in the image, exactly linear for a pinhole. Across it stands a Gaussian: the beam's cross-section
// and the lens's spot, integrated over the pixel. Range, incidence and attenuation are those of the stripe's centre, so they do not pull the peak.
#pragma once

#include <optional>

#include "host_sim/optics/pattern.hpp"
#include "host_sim/optics/surface.hpp"
#include "host_sim/optics/water.hpp"

namespace lf::optics {

// The stripe about a packet of surface points.
struct StripePacket {
  LaneMask reached{};     // lanes close enough to the stripe, before occlusion
  Lanes offset_px{};      // the pixel's distance to the stripe's centre
  Lanes slope_v{};        // its change from one row to the next
  RgbLanes irradiance{};  // W/m2 there times the way back to the camera, unoccluded
};

// The light that a sheet scatters in the water into a packet of rays, seen where no surface comes before it.
struct Glow {
  Lanes parameter{};  // of the rays where they cross the sheet
  RgbLanes radiance{};
};

class SheetLight {
 public:
  // `pattern` (not owned, outlives this) takes the line's place where it has a value.
  SheetLight(const LaserConfig& config, const Pose& base_from_body, const std::optional<PatternTable>& pattern);

  // `footprint`: side of the sample's square, px (1, or 1/4 for sub-samples).
  StripePacket on_surface(const SurfacePacket& surface, const Water& water, float footprint, float blur_px) const;

  // Where the rays cross the sheet (single scattering, the sheet thin). A pattern has no glow.
  Glow glow(const RayLines& rays, const Water& water) const;

  const Lanes3& emitter() const { return emitter_; }

 private:
  struct ImageDistance {
    Lanes3 normal;                   // of the sheet
    Lanes distance, range2;          // to the sheet; to the emitter, squared
    Lanes w, w_du, w_dv, gradient2;  // w / gradient: distance to the stripe, px
  };
  ImageDistance image_distance(const SurfacePacket& surface) const;
  LaneMask within_reach(const SurfacePacket& surface, const ImageDistance& distance, const Water& water, float blur_px) const;
  StripePacket line(const SurfacePacket& surface, const Water& water, float footprint, float blur_px) const;
  StripePacket picture(const SurfacePacket& surface, const Water& water, float footprint) const;
  Lanes fan_weight(Lanes y, Lanes z) const;

  Rotation base_from_laser_;  // columns: plane normal, along the fan, central ray
  Lanes3 emitter_;
  float tan_half_fan_, w_per_rad_, waist_m_, divergence_rad_, tan_cone_, cos_cone_;
  double power_w_;
  Rgb band_;
  const std::optional<PatternTable>& pattern_;
};

}  // namespace lf::optics
