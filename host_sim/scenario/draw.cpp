#include "host_sim/scenario/draw.hpp"

#include <string>

#include "shared/messages/joint_names.hpp"
#include "shared/random.hpp"

namespace lf::scenario {

namespace {

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return hash;
}

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(seed) {}

  double of(const Spread& spread, const std::string& name) const { return spread.min + (spread.max - spread.min) * uniform(seed_, name); }
  double degrees(const Spread& spread, const std::string& name) const { return rad_from_deg(of(spread, name)); }
  Vec3 each_axis(const Spread& spread, const std::string& name) const {
    return {of(spread, name + ".x"), of(spread, name + ".y"), of(spread, name + ".z")};
  }
  Vec3 degrees_each_axis(const Spread& spread, const std::string& name) const { return each_axis(spread, name) * rad_from_deg(1); }
  bool of(Chance chance, const std::string& name) const {
    return chance == Chance::either ? uniform(seed_, name) < 0.5 : chance == Chance::yes;
  }

 private:
  std::uint64_t seed_;
};

}  // namespace

std::uint64_t bits(std::uint64_t seed, std::string_view name) { return splitmix64(splitmix64(seed) ^ fnv1a(name)); }

double uniform(std::uint64_t seed, std::string_view name) { return static_cast<double>(bits(seed, name) >> 11) * 0x1p-53; }

Sample draw(const Scenario& s, std::uint64_t seed) {
  const Draws draws(seed);
  Sample sample;
  sample.seed = seed;
  sample.docking_shift_m = {draws.of(s.docking.x_m, "docking.x_m"), draws.of(s.docking.y_m, "docking.y_m"),
                            draws.of(s.docking.z_m, "docking.z_m")};
  sample.docking_turn_rad = {draws.degrees(s.docking.roll_deg, "docking.roll_deg"), draws.degrees(s.docking.pitch_deg, "docking.pitch_deg"),
                             draws.degrees(s.docking.yaw_deg, "docking.yaw_deg")};
  sample.valve_start_rad = draws.degrees(s.valve.start_deg, "valve.start_deg");
  sample.valve_friction_nm = draws.of(s.valve.friction_nm, "valve.friction_nm");
  sample.attenuation_per_m = draws.of(s.water.attenuation_per_m, "water.attenuation_per_m");
  sample.camera_noise_grey = draws.of(s.camera.noise_grey, "camera.noise_grey");
  sample.lamps_lit = draws.of(s.lamps.lit, "lamps.lit");
  sample.camera_shift_m = draws.each_axis(s.mounting.camera_m, "mounting.camera_m");
  sample.camera_turn_rad = draws.degrees_each_axis(s.mounting.camera_deg, "mounting.camera_deg");
  sample.laser_shift_m = draws.each_axis(s.mounting.laser_m, "mounting.laser_m");
  sample.laser_turn_rad = draws.degrees_each_axis(s.mounting.laser_deg, "mounting.laser_deg");
  for (std::size_t i = 0; i < joint_count; ++i) {
    sample.joint_offset_rad[i] = draws.degrees(s.mounting.joints_deg, std::string("mounting.joints_deg.") + joint_names[i]);
    const auto friction = [&](const Spread& spread, const char* name) {
      return draws.of(spread, std::string("friction.") + name + "." + joint_names[i]);
    };
    sample.coulomb[i] = friction(s.friction.coulomb, "coulomb");
    sample.viscous[i] = friction(s.friction.viscous, "viscous");
    sample.efficiency[i] = friction(s.friction.efficiency, "efficiency");
    sample.back_efficiency[i] = friction(s.friction.back_efficiency, "back_efficiency");
    sample.breakaway[i] = friction(s.friction.breakaway, "breakaway");
    sample.one_way[i] = friction(s.friction.one_way, "one_way");
    sample.pivot_m[i] = friction(s.friction.pivot_m, "pivot_m");
  }
  sample.marker_shift_m = draws.each_axis(s.mounting.marker_m, "mounting.marker_m");
  sample.marker_shift_m.z() = 0;
  sample.marker_turn_rad = draws.degrees(s.mounting.marker_deg, "mounting.marker_deg");
  const Calibration& c = s.calibration;
  sample.principal_point_px = draws.each_axis(c.principal_point_px, "calibration.principal_point_px").head<2>();
  sample.focal_ratio = 1 + 0.01 * draws.of(c.focal_percent, "calibration.focal_percent");
  sample.distortion_px = draws.each_axis(c.distortion_px, "calibration.distortion_px");
  sample.lens_ratio = 1 + 0.01 * draws.of(c.lens_percent, "calibration.lens_percent");
  sample.laser_cone_rad = 1e-3 * draws.of(c.laser_cone_mrad, "calibration.laser_cone_mrad");
  sample.beam_ratio = 1 + 0.01 * draws.of(c.beam_percent, "calibration.beam_percent");
  for (std::size_t i = 0; i < sample.button_shift_m.size(); ++i)
    sample.button_shift_m[i] = draws.each_axis(c.buttons_m, "calibration.buttons_m." + std::to_string(i)).head<2>();
  sample.exposure_delay_s = 1e-3 * draws.of(c.exposure_delay_ms, "calibration.exposure_delay_ms");
  sample.particles_per_l = draws.of(s.water.particles_per_l, "water.particles_per_l");
  const std::uint64_t sensor_seed = s.sensors.seed > 0 ? static_cast<std::uint64_t>(s.sensors.seed) : seed;
  sample.optics_seed = bits(sensor_seed, "sensors.optics");
  sample.devices_seed = bits(sensor_seed, "sensors.devices");
  return sample;
}

}  // namespace lf::scenario
