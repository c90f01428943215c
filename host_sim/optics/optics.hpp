// The underwater camera: ray-traced images of the scene under laser sheets, lamps and ambient light, through absorbing and scattering water.
//
// Light is carried in three bands (red, green, blue) in SI units: lasers in W, lamps in W/sr, ambient light in W/m2 of irradiance. Visibility and occlusion
// are exact (ray casting), the laser's cross-section is analytic and integrated over the pixel, edges get 4x4 samples, and so does paint under a stripe. From
// the radiance the picture is made in nature's order (formation/): forward scatter in the water, lens, particles, vignetting, speckle, the sensor's noise and fixed
// pattern, quantisation. The same seed, frame number and poses give the same bytes for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/optics/formation/forward_scatter.hpp"
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
  double blur_px = 1.0;              // standard deviation of the lens's spot in the middle of the picture
  double corner_blur = 1.4;          // of the spot at the corners, over that in the middle
  double stray_share = 0.03;         // of the light: what lens and port spread over `stray_px`
  double stray_px = 6.0;             // standard deviation
  double ghost_share = 1.6e-3;       // a second reflection in an uncoated filter
  double ghost_px = 11;              // by which it is shifted down the picture
  double corner_light = 0.7;         // vignetting: of the light at the corners, over that in the middle
  double prnu = 0.007;               // standard deviation of the pixels' sensitivities (EMVA 1288)
  double dsnu_grey = 0.2;            // of their dark levels
  double row_noise_grey = 0.3;       // of each row in each frame, at gain 1
  double hot_pixels = 1e-5;          // share of the pixels that are 20 to 200 grey levels too bright
  std::uint64_t serial = 1;          // picks the fixed pattern
  double exposure_jitter = 0.005;    // standard deviation of a frame's exposure over the ordered one: shutter, flicker of the light
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
  scene::BodyId body = 3;                   // the default arm's forearm
  Pose body_from_laser = Pose::Identity();  // the true one, mounting error included
  double fan_half_angle_rad = 0.70;
  double cone_rad = 0;             // the sheet's half-angle error: 0 a plane; otherwise the cone that a tilted port bends it to, toward +x
  double power_w = 0.45;           // even over the fan; with a pattern over all of the image
  Rgb band{0.f, 1.f, 0.f};         // how the power falls on red, green, blue: 532 nm
  double waist_sigma_m = 0.0010;   // cross-section's standard deviation at its waist
  double divergence_rad = 0.0027;  // with the waist 1.9 mm at 0.6 m
  double waist_at_m = 0;           // the range of the waist: hypot(waist_sigma_m, divergence_rad (r - waist_at_m))
  // A second, faint line as wide as the beam: its height over the beam's, and its place in standard deviations of the beam, toward +x. Both share the power.
  // Their centre of mass lies in the sheet: a calibration of the line takes a constant shift for the sheet's own place.
  double lobe_share = 0;
  double lobe_sigmas = 2.5;
  // Power over the fan's mean, even in the tangent of the angle from one end of the fan to the other; empty: even.
  std::vector<float> fan_profile;
  double speckle =
      0.18;  // standard deviation of one pixel's laser light over its mean: 0.13 to 0.19 of a diode, 0.18 to 0.25 of a DPSS laser
  std::optional<Pattern> pattern;
};

// A lamp with a soft-edged cone about its z axis.
struct LampConfig {
  scene::BodyId body = scene::OwnBodies::vehicle;
  Pose body_from_lamp = Pose::Identity();
  Rgb intensity_w_sr{4.5f, 5.f, 4.5f};
  double cone_half_angle_rad = 0.87;  // half intensity
  double edge_rad = 0.25;             // from full to none
  bool casts_shadows = true;
};

struct WaterConfig {
  double attenuation_per_m = 0.3;            // of the green band, absorption and scattering together
  Rgb attenuation_ratio{2.2f, 1.0f, 1.15f};  // of the bands to green: red is absorbed most
  double scattering_share = sea_water;       // of the attenuation of green that scatters (single-scattering albedo)
  double scattering_ratio = 1;               // what scatters over that; never more than the attenuation
  ForwardScatter forward;                    // where the light goes that scatters forward
  double back_share = 0.01;                  // of the scattered light: the lobe that reaches behind
  double asymmetry = 0.935;                  // Henyey-Greenstein g of the forward lobe, which has 99 % of the scattered light
  double particles_per_l = 0;                // specks of more than 0.5 mm in a litre; of d mm and more there are (0.5 / d)^2 as many
  Vec3 current_m_s{0.01, 0.02, 0.0005};      // that carries them; they settle, too
  Rgb ambient_w_m2{3.f, 16.f, 16.f};         // downwelling irradiance on a surface that faces up
  Rgb water_w_m2_sr{0.1f, 1.5f, 2.0f};       // radiance of the open water seen horizontally, if it scatters as sea water does
  static constexpr double sea_water = -1;    // any share below 0: the one that goes with the attenuation, formation/forward_scatter.hpp
};

struct OpticsConfig {
  std::vector<CameraConfig> cameras;
  std::vector<LaserConfig> lasers;
  std::vector<LampConfig> lamps;
  WaterConfig water;
  scene::Scene scene = scene::bare_scene();
  std::uint64_t seed = 0;
  int threads = 1;  // the caller's included
  bool edge_sampling = true;
};

struct Shot {
  std::size_t camera = 0;
  std::uint64_t frame_number = 0;    // picks the noise
  scene::BodyPoses poses;            // at mid-exposure; of all bodies of the scene
  double time_s = 0;                 // where the particles have drifted to
  float laser = 1;                   // share of the exposure during which the lasers are on
  float lamps = 0;                   // the lamps
  std::optional<Duration> exposure;  // those of the camera's configuration
  std::optional<double> gain;
  bool truth = false;
};

// A place of a laser's stripe: where the ideal sheet meets, in the middle of column u, a surface that is both visible and lit; or a part of one.
struct StripePiece {
  std::int32_t laser = 0, u = 0;
  float v = 0, grey = 0;  // its height as Frame::stripe_grey has it
  float sigma_px = 0;     // standard deviation along the column, beam, lens and pixel together; 0 for a part
  // No centre to hold a peak against. The beam's middle misses the surface, at its border, and its flank falls on it: v is where that is brightest. Or something keeps
  // the direct light off, and what the water has scattered falls there: v is where the sheet would meet the surface.
  bool part = false;
  bool near_mark = false;  // paint that is another's under the stripe or beside it: centres are harder to find there
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
  std::vector<float> stripe_grey;   // its noise-free height over the background, grey levels, without speckle
  std::vector<StripePiece> pieces;  // all of them, those that are not the brightest of their column included; a piece may be listed twice
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
