// One run out of a scenario: every random quantity drawn by a seed.
//
// Each quantity has a generator of its own, made of the seed and the quantity's name, so that a new one leaves all others as they were.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "host_sim/scenario/scenario.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::scenario {

// SI units; angles in radians. Turns are vectors whose direction is the axis and whose length is the angle.
struct Sample {
  std::uint64_t seed = 0;
  Vec3 docking_shift_m = Vec3::Zero();  // in the base frame
  Vec3 docking_turn_rad = Vec3::Zero();
  struct Valve {
    double start_rad = 0;
    double friction_nm = 0;
    Vec3 size_m = Vec3::Zero();  // on the handle's length, thickness and height
  };
  struct Button {
    Vec2 shift_m = Vec2::Zero();
    Vec2 size_m = Vec2::Zero();  // on width and height
  };
  struct Marker {
    Vec3 shift_m = Vec3::Zero();  // in the panel frame, within its plane: z is 0
    double turn_rad = 0;          // about the panel's normal
    double size_m = 0;
    Vec2 flat_m = Vec2::Zero();  // by which the plate's far edge stands off, along the panel's x and y
  };
  // As the panel's layout has them.
  std::vector<Valve> valves;
  std::vector<Button> buttons;
  std::vector<Marker> markers;
  double attenuation_per_m = 0;
  double camera_noise_grey = 0;
  bool lamps_lit = false;
  Vec3 camera_shift_m = Vec3::Zero();  // in the camera frame
  Vec3 camera_turn_rad = Vec3::Zero();
  Vec3 laser_shift_m = Vec3::Zero();  // in the laser frame
  Vec3 laser_turn_rad = Vec3::Zero();
  PerJoint<double> joint_offset_rad{};
  PerJoint<double> coulomb{}, viscous{}, efficiency{}, back_efficiency{};  // over the description's
  PerJoint<double> breakaway{}, one_way{}, pivot_m{};
  // The true machine, over its calibration.
  Vec2 principal_point_px = Vec2::Zero();
  double focal_ratio = 1, lens_ratio = 1, beam_ratio = 1;
  Vec3 distortion_px = Vec3::Zero();  // at the picture's corners: by k1, p1, p2
  double laser_cone_rad = 0;
  double exposure_delay_s = 0, stamp_s = 0;
  double particles_per_l = 0;
  // The light's way.
  double scattering_ratio = 1;                         // over that of the attenuation
  std::array<double, 5> forward_ratio{1, 1, 1, 1, 1};  // of the forward scatter's core and terms
  double back_ratio = 1;
  double corner_blur = 1, electrons_per_grey = 0, exposure_jitter = 0, ghost_share = 0, ghost_px = 0;
  double speckle = 0, waist_at_m = 0, lobe_share = 0, lobe_sigmas = 0;  // the lobe's place signed
  double fan_low_ratio = 0, fan_fine_ratio = 0;
  std::uint64_t fan_seed = 0;
  std::uint64_t optics_seed = 0;
  std::uint64_t devices_seed = 0;
};

Sample draw(const Scenario& scenario, std::uint64_t seed);

// Uniform in [0, 1), 53 bits: splitmix64 (Steele, Lea, Flood, OOPSLA 2014) over the seed and the FNV-1a hash of the name.
double uniform(std::uint64_t seed, std::string_view name);
std::uint64_t bits(std::uint64_t seed, std::string_view name);

}  // namespace lf::scenario
