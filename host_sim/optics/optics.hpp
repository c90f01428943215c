// The underwater camera: ray-traced images of the scene under laser sheets, lamps and ambient light, through absorbing and scattering water.
//
// Light is carried in three bands (red, green, blue) in SI units: lasers in W, lamps in W/sr, ambient light in W/m2 of irradiance. Visibility and occlusion
// are exact (ray casting), the laser's cross-section is analytic and integrated over the pixel, edges get 4x4 samples. The same seed, frame number and
// poses give the same bytes for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "shared/calibration/calibration.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/time.hpp"
#include "shared/scene/scene.hpp"

namespace lf::optics {

using Rgb = std::array<float, 3>;

// A flat window square to the optical axis. With it the intrinsics are those of the camera in air.
struct FlatPort {
  double distance_m = 0.020;  // projection centre to the glass's dry face
  double thickness_m = 0.010;
  double glass_index = 1.49;  // acrylic
  double water_index = 1.34;
};

struct CameraConfig {
  CameraIntrinsics intrinsics;
  Pose base_from_camera = Pose::Identity();  // the true one, mounting error included
  std::optional<FlatPort> port;
  Duration exposure = Duration::from_us(2000);
  double gain = 1.0;
  double sensitivity = 1.2e4;        // grey levels at gain 1 for each J/(m2 sr) of exposed radiance
  double read_noise_grey = 1.5;      // standard deviation at gain 1
  double electrons_per_grey = 40.0;  // at gain 1; sets the shot noise. 40 is a 10,000 electron well over 255 levels. 0: no shot noise
  double blur_px = 1.0;              // standard deviation of the lens's spot; widens the stripe
  bool colour = false;               // false: one channel, the bands weighted by `response`; true: three channels R G B
  Rgb response{0.25f, 1.0f, 0.6f};   // of the mono sensor; of the three colour channels 1 each
};

// A pinhole projector's black and white image in the laser frame (x to the image's right, y down, z forward).
struct Pattern {
  std::int32_t width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;  // px, pixel centres at integers
  std::vector<std::uint8_t> lit;          // row-major, 0 dark, otherwise lit
};

// A laser line in its own frame: x the plane's normal, z the fan's central ray, origin the emitter. With `pattern` an image takes the line's place.
struct LaserConfig {
  scene::BodyId body = scene::BodyId::forearm;
  Pose body_from_laser = Pose::Identity();  // the true one, mounting error included
  double fan_half_angle_rad = 0.70;
  double cone_rad = 0;             // the sheet's half-angle error: 0 a plane; otherwise the cone that a tilted port bends it to, toward +x
  double power_w = 0.45;           // even over the fan; with a pattern over all of the image
  Rgb band{0.f, 1.f, 0.f};         // how the power falls on red, green, blue: 532 nm
  double waist_sigma_m = 0.0010;   // cross-section's standard deviation at range r: hypot(waist_sigma_m, divergence_rad r)
  double divergence_rad = 0.0027;  // with the waist 1.9 mm at 0.6 m
  std::optional<Pattern> pattern;
};

// A lamp with a soft-edged cone about its z axis.
struct LampConfig {
  scene::BodyId body = scene::BodyId::vehicle;
  Pose body_from_lamp = Pose::Identity();
  Rgb intensity_w_sr{4.5f, 5.f, 4.5f};
  double cone_half_angle_rad = 0.87;  // half intensity
  double edge_rad = 0.25;             // from full to none
  bool casts_shadows = true;
};

struct WaterConfig {
  double attenuation_per_m = 0.3;            // of the green band, absorption and scattering together
  Rgb attenuation_ratio{2.2f, 1.0f, 1.15f};  // of the bands to green: red is absorbed most
  double scattering_share = 0.5;             // of the attenuation that scatters (single-scattering albedo)
  double asymmetry = 0.85;                   // Henyey-Greenstein g: sea water scatters forward
  double halo_share = 0.4;                   // of the forward-scattered light that stays near the stripe as a broad skirt
  double halo_rad = 0.03;                    // standard deviation of the skirt seen from the emitter
  Rgb ambient_w_m2{3.f, 16.f, 16.f};         // downwelling irradiance on a surface that faces up
  Rgb water_w_m2_sr{0.1f, 1.5f, 2.0f};       // radiance of the open water seen horizontally
};

struct OpticsConfig {
  std::vector<CameraConfig> cameras;
  std::vector<LaserConfig> lasers;
  std::vector<LampConfig> lamps;
  WaterConfig water;
  scene::Scene scene;
  std::uint64_t seed = 0;
  int threads = 1;  // the caller's included
  bool edge_sampling = true;
};

struct Shot {
  std::size_t camera = 0;
  std::uint64_t frame_number = 0;  // picks the noise
  scene::BodyPoses poses;          // at mid-exposure
  bool laser = true;
  bool lamps = false;
  bool truth = false;
};

// Pixels and, on request, what is true of them (otherwise those vectors are empty). Reuse one Frame: its memory is kept.
struct Frame {
  std::int32_t width = 0, height = 0, channels = 1;
  std::vector<std::uint8_t> pixels;   // row-major, channels interleaved
  std::vector<float> depth_m;         // along the camera's z at each pixel centre; infinity in open water
  std::vector<std::uint16_t> object;  // 1 + BodyId at each pixel centre; 0 in open water
  // One a column and laser (index laser * width + u): the stripe's true centre v where it is brightest in the column, the ideal sheet meeting a surface that
  // is both visible and lit; NaN where there is none, and with patterns.
  std::vector<float> stripe_v;
  std::vector<float> stripe_grey;  // its noise-free height over the background, grey levels
};

class Optics {
 public:
  // Builds the scene. Throws InputError for a configuration that makes no sense (no pixels, a focal length <= 0, a mesh index out of range, NaN ...).
  explicit Optics(const OpticsConfig& config);
  ~Optics();
  Optics(Optics&&) noexcept;
  Optics& operator=(Optics&&) noexcept;

  // One exposure. May be called from any one thread at a time; it works on copies of the poses and on its own threads.
  // Throws std::out_of_range for a camera that is not there, InputError for a pose with a NaN.
  void render(const Shot& shot, Frame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lf::optics
