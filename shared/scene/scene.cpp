#include "shared/scene/scene.hpp"

namespace lf::scene {

Scene bare_scene(const PanelLayout& layout, const PanelNames& names) {
  Scene scene{{"vehicle", {}, Role::vehicle}, {"slew", {}, Role::link},   {"upper arm", {}, Role::link},
              {"forearm", {}, Role::link},    {"wrist", {}, Role::hand},  {"finger a", {}, Role::finger},
              {"finger b", {}, Role::finger}, {"panel", {}, Role::panel}, {"obstacle", {}, Role::intruder}};
  for (std::size_t i = 0; i < layout.valves.size(); ++i) {
    const std::string& name = names.valves.at(i);
    scene.push_back({name == "valve" ? "handle" : name + "'s handle", {}, Role::handle});
  }
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) scene.push_back({names.buttons.at(i) + " button", {}, Role::button});
  return scene;
}

std::vector<std::size_t> bodies_of(const Scene& scene, Role role) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (scene[i].role == role) found.push_back(i);
  }
  return found;
}

std::size_t own_body_count(const Scene& scene) {
  std::size_t count = scene.size();
  while (count > 0 && scene[count - 1].role == Role::object) --count;
  return count;
}

}  // namespace lf::scene
