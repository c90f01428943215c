// A laser line's light on surfaces and in the water.
//
// The stripe is analytic. The surface at a hit point is its tangent plane; the plane through the camera's centre and the line in which the sheet cuts that
// tangent plane gives the pixel's distance to the stripe in the image, exactly linear for a pinhole. Across it stands a Gaussian: the beam's cross-section,
// integrated over the pixel. Range, incidence and attenuation are those of the stripe's centre, so they do not pull the peak. What the water scatters on the laser's
// way stands beside the sheet as wider Gaussians (formation/forward_scatter.hpp), with range and incidence of the place that it falls on: it is not symmetric.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host_sim/optics/pattern.hpp"
#include "host_sim/optics/sheet_shadows.hpp"
#include "host_sim/optics/split_scene.hpp"
#include "host_sim/optics/surface.hpp"
#include "host_sim/optics/water.hpp"

namespace lf::optics {

// The stripe about a packet of surface points.
struct StripePacket {
  LaneMask reached{};     // lanes close enough to the stripe, before occlusion
  LaneMask beside{};      // lanes that its skirt falls on; not where the sheet ends before them
  Lanes offset_px{};      // the pixel's distance to the stripe's centre
  Lanes slope_v{};        // its change from one row to the next
  Lanes sigma_px{};       // the stripe's, across it: beam, lens and the pixel's narrow side
  RgbLanes irradiance{};  // W/m2 there times the way back to the camera, unoccluded
  RgbLanes skirt{};       // the same of the light that the water scattered
};

// The light that a sheet scatters in the water into a packet of rays, seen where no surface comes before it.
struct Glow {
  Lanes parameter{};  // of the rays where they cross the sheet
  RgbLanes radiance{};
};

class SheetLight {
 public:
  // `config`'s fan profile and `pattern` are not owned and outlive this. A pattern takes the line's place where it has a value.
  // `share`: of the exposure during which it is on.
  SheetLight(const LaserConfig& config, const Pose& base_from_body, const std::optional<PatternTable>& pattern, float share = 1);

  // Finds where each of the sheet's rays ends. Until then none does.
  void meet(const SplitScene& scene);

  // Whether the beam reaches to within `margin_m` of a place in the base frame.
  bool reaches(const Vec3& point, double margin_m) const;

  // A speck in the water, base frame.
  struct Speck {
    Vec3 place_m = Vec3::Zero();
    double diameter_m = 0;
  };
  // Has these cast shadows. Until then nothing in the water does. The line's direct light alone is shaded.
  void shade_by(const std::vector<Speck>& specks);

  // `footprint`: side of the sample's square, px (1, or 1/4 for sub-samples). `blur_px`: a lens's spot, where its blur is wanted here and not in the picture.
  StripePacket on_surface(const SurfacePacket& surface, const Water& water, float footprint, float blur_px) const;

  // Where the rays cross the sheet (single scattering, the sheet thin), up to where its light ends. A pattern has no glow.
  Glow glow(const RayLines& rays, const Water& water) const;

  const Lanes3& emitter() const { return emitter_; }
  const Vec3& emitter_m() const { return emitter_m_; }
  bool is_line() const { return !pattern_.has_value(); }
  // Irradiance of something small at a place that faces the emitter, W/m2, before the way to the camera: the line alone.
  RgbLanes at(const Lanes3& point, const Water& water) const;

 private:
  struct ImageDistance {
    Lanes3 normal;                   // of the sheet
    Lanes3 place;                    // in the laser's frame
    Lanes distance, range2;          // to the sheet; to the emitter, squared
    Lanes w, w_du, w_dv, gradient2;  // w / gradient: distance to the stripe, px
  };
  // Of a place in the laser's frame: its distance to the sheet, and the beam's standard deviation there.
  double off_m(const Vec3& place) const;
  double sigma_m(const Vec3& place) const;
  ImageDistance image_distance(const SurfacePacket& surface) const;
  LaneMask within_reach(const SurfacePacket& surface, const ImageDistance& distance, float blur_px) const;
  void add_skirt(const SurfacePacket& surface, const ImageDistance& distance, const Water& water, StripePacket& stripe) const;
  Lanes shadow(const SurfacePacket& surface, const ImageDistance& distance, LaneMask wanted, float footprint) const;
  StripePacket line(const SurfacePacket& surface, const Water& water, float footprint, float blur_px) const;
  StripePacket picture(const SurfacePacket& surface, const Water& water, float footprint) const;
  Lanes fan_weight(Lanes y, Lanes z) const;
  Lanes fan_power(Lanes tangent) const;  // over the mean
  Lanes sigma2_m2(Lanes range) const;    // of the beam's cross-section
  Lanes end_m(Lanes y, Lanes z) const;   // range at which the sheet's ray through a place in it ends

  Rotation base_from_laser_;  // columns: plane normal, along the fan, central ray
  Lanes3 emitter_;
  Vec3 emitter_m_;
  Pose laser_from_base_;
  float tan_half_fan_, w_per_rad_, waist_m_, divergence_rad_, waist_at_m_, lobe_share_, lobe_sigmas_, reach_sigmas_, tan_cone_, cos_cone_;
  double power_w_;
  Rgb band_;
  const std::optional<PatternTable>& pattern_;
  std::span<const float> fan_profile_;
  std::optional<SheetShadows> shadows_;
  std::vector<float> ends_m_;  // of rays that are even in the tangent of their angle; empty: none ends
};

}  // namespace lf::optics
