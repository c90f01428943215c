#include "host_sim/scenario/true_vehicle.hpp"

#include <array>

#include "shared/scene/vehicle_shapes.hpp"

namespace lf::scenario {
namespace {

std::vector<Vec3> lamp_places_m(const config::Vehicle& vehicle) {
  std::vector<Vec3> places_m;
  for (const std::array<double, 3>& lamp_m : vehicle.lamps_m) places_m.emplace_back(lamp_m[0], lamp_m[1], lamp_m[2]);
  return places_m;
}

}  // namespace

std::vector<scene::Shape> vehicle_shapes(const Scenario& scenario) {
  const config::Vehicle usual;
  if (scenario.vehicle.boxes_m == usual.boxes_m && scenario.vehicle.capsules_m == usual.capsules_m) return scene::default_vehicle();
  std::vector<Vec3> eyes_m = lamp_places_m(scenario.vehicle);
  const std::array<double, 3>& camera_m = scenario.camera.position_m;
  eyes_m.emplace_back(camera_m[0], camera_m[1], camera_m[2]);
  return scene::vehicle_of(scenario.vehicle.boxes_m, scenario.vehicle.capsules_m, eyes_m);
}

std::vector<optics::LampConfig> lamps(const Scenario& scenario) {
  const Vec3 default_aim(0.44, 0.0, 0.60);  // 8 mm below the docked mission's valve
  const Vec3 aim =
      default_aim + (scenario.panel.nominal_base_from_panel().translation() - PanelLayout{}.nominal_base_from_panel().translation());
  std::vector<optics::LampConfig> all;
  for (const Vec3& place_m : lamp_places_m(scenario.vehicle)) {
    optics::LampConfig lamp;
    lamp.body_from_lamp.translation() = place_m;
    const Vec3 way_m = aim - place_m;
    const Vec3 ahead = way_m.norm() > 1e-3 ? way_m : Vec3::UnitX();  // a lamp in the panel has no way to it
    lamp.body_from_lamp.linear() = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), ahead).toRotationMatrix();
    for (float& band : lamp.intensity_w_sr) band *= static_cast<float>(scenario.lamps.power);
    all.push_back(lamp);
  }
  return all;
}

}  // namespace lf::scenario
