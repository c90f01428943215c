#include "host_sim/scenario/draw.hpp"

#include <string>

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

// On the docked mission's panel there is one valve and one marker, and the buttons are of one size: their draws have the keys' names. Those of a file's features have the
// feature's name as well, so that another one beside it changes no draw.
void draw_panel(const Scenario& s, const Draws& draws, Sample& sample) {
  const Calibration& c = s.calibration;
  const bool docked = s.survey.file.empty();
  const auto of = [&](const std::string& key, const std::string& feature) { return docked ? key : key + "." + feature; };
  const std::vector<config::ValveNature> natures = valve_natures(s);
  for (std::size_t i = 0; i < s.panel.valves.size(); ++i) {
    const std::string& name = s.survey.names.valves.at(i);
    sample.valves.push_back({draws.degrees(natures.at(i).start_deg, of("valve.start_deg", name)),
                             draws.of(natures.at(i).friction_nm, of("valve.friction_nm", name)),
                             draws.each_axis(c.handle_m, of("calibration.handle_m", name))});
  }
  for (std::size_t i = 0; i < s.panel.buttons.size(); ++i) {
    const std::string& name = s.survey.names.buttons.at(i);
    sample.buttons.push_back({draws.each_axis(c.buttons_m, "calibration.buttons_m." + (docked ? std::to_string(i) : name)).head<2>(),
                              draws.each_axis(c.button_size_m, of("calibration.button_size_m", name)).head<2>()});
  }
  for (const std::string& name : s.survey.names.markers) {
    Sample::Marker marker;
    marker.shift_m = draws.each_axis(s.mounting.marker_m, of("mounting.marker_m", name));
    marker.shift_m.z() = 0;
    marker.turn_rad = draws.degrees(s.mounting.marker_deg, of("mounting.marker_deg", name));
    marker.size_m = draws.of(c.marker_size_m, of("calibration.marker_size_m", name));
    marker.flat_m = draws.each_axis(c.marker_flat_m, of("calibration.marker_flat_m", name)).head<2>();
    sample.markers.push_back(marker);
  }
}

void draw_light(const Scenario& s, const Draws& draws, Sample& sample) {
  const auto ratio = [&](const Spread& percent, const std::string& name) { return 1 + 0.01 * draws.of(percent, name); };
  sample.scattering_ratio = ratio(s.water.scattering_percent, "water.scattering_percent");
  for (std::size_t i = 0; i < sample.forward_ratio.size(); ++i)
    sample.forward_ratio[i] = ratio(s.water.phase_percent, "water.phase_percent." + std::to_string(i));
  sample.back_ratio = ratio(s.water.phase_percent, "water.phase_percent.back");
  sample.corner_blur = draws.of(s.camera.corner_blur, "camera.corner_blur");
  sample.electrons_per_grey = draws.of(s.camera.electrons_per_grey, "camera.electrons_per_grey");
  sample.exposure_jitter = draws.of(s.camera.exposure_jitter, "camera.exposure_jitter");
  sample.ghost_share = draws.of(s.camera.ghost_share, "camera.ghost_share");
  sample.ghost_px = draws.of(s.camera.ghost_px, "camera.ghost_px");
  sample.speckle = draws.of(s.laser.speckle, "laser.speckle");
  sample.waist_at_m = draws.of(s.laser.waist_at_m, "laser.waist_at_m");
  sample.lobe_share = draws.of(s.laser.lobe_share, "laser.lobe_share");
  sample.lobe_sigmas = draws.of(s.laser.lobe_sigmas, "laser.lobe_sigmas") * (draws.of(s.laser.lobe_ahead, "laser.lobe_ahead") ? 1 : -1);
  sample.fan_low_ratio = 0.01 * draws.of(s.laser.fan_low_percent, "laser.fan_low_percent");
  sample.fan_fine_ratio = 0.01 * draws.of(s.laser.fan_fine_percent, "laser.fan_fine_percent");
}

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
  draw_panel(s, draws, sample);
  sample.attenuation_per_m = draws.of(s.water.attenuation_per_m, "water.attenuation_per_m");
  sample.camera_noise_grey = draws.of(s.camera.noise_grey, "camera.noise_grey");
  sample.lamps_lit = draws.of(s.lamps.lit, "lamps.lit");
  sample.camera_shift_m = draws.each_axis(s.mounting.camera_m, "mounting.camera_m");
  sample.camera_turn_rad = draws.degrees_each_axis(s.mounting.camera_deg, "mounting.camera_deg");
  sample.laser_shift_m = draws.each_axis(s.mounting.laser_m, "mounting.laser_m");
  sample.laser_turn_rad = draws.degrees_each_axis(s.mounting.laser_deg, "mounting.laser_deg");
  for (std::size_t i = 0; i < s.joints.size(); ++i) {
    sample.joint_offset_rad[i] = draws.degrees(s.mounting.joints_deg, "mounting.joints_deg." + s.joints[i]);
    const auto friction = [&](const Spread& spread, const char* name) {
      return draws.of(spread, std::string("friction.") + name + "." + s.joints[i]);
    };
    sample.coulomb[i] = friction(s.friction.coulomb, "coulomb");
    sample.viscous[i] = friction(s.friction.viscous, "viscous");
    sample.efficiency[i] = friction(s.friction.efficiency, "efficiency");
    sample.back_efficiency[i] = friction(s.friction.back_efficiency, "back_efficiency");
    sample.breakaway[i] = friction(s.friction.breakaway, "breakaway");
    sample.one_way[i] = friction(s.friction.one_way, "one_way");
    sample.pivot_m[i] = friction(s.friction.pivot_m, "pivot_m");
  }
  const Calibration& c = s.calibration;
  sample.principal_point_px = draws.each_axis(c.principal_point_px, "calibration.principal_point_px").head<2>();
  sample.focal_ratio = 1 + 0.01 * draws.of(c.focal_percent, "calibration.focal_percent");
  sample.distortion_px = draws.each_axis(c.distortion_px, "calibration.distortion_px");
  sample.lens_ratio = 1 + 0.01 * draws.of(c.lens_percent, "calibration.lens_percent");
  sample.laser_cone_rad = 1e-3 * draws.of(c.laser_cone_mrad, "calibration.laser_cone_mrad");
  sample.beam_ratio = 1 + 0.01 * draws.of(c.beam_percent, "calibration.beam_percent");
  sample.exposure_delay_s = 1e-3 * draws.of(c.exposure_delay_ms, "calibration.exposure_delay_ms");
  sample.stamp_s = 1e-3 * draws.of(c.stamp_ms, "calibration.stamp_ms");
  draw_light(s, draws, sample);
  sample.particles_per_l = draws.of(s.water.particles_per_l, "water.particles_per_l");
  const std::uint64_t sensor_seed = s.sensors.seed > 0 ? static_cast<std::uint64_t>(s.sensors.seed) : seed;
  sample.optics_seed = bits(sensor_seed, "sensors.optics");
  sample.devices_seed = bits(sensor_seed, "sensors.devices");
  sample.fan_seed = bits(seed, "laser.fan");
  return sample;
}

}  // namespace lf::scenario
