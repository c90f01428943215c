#include "shared/scene/scene.hpp"

namespace lf::scene {

Scene bare_scene(const PanelLayout& layout, const PanelNames& names, const std::vector<std::string>& links) {
  if (links.empty()) return bare_scene(layout, names, {"slew", "upper arm", "forearm", "wrist"});
  Scene scene{{"vehicle", {}, Role::vehicle}};
  for (const std::string& link : links) scene.push_back({link, {}, &link == &links.back() ? Role::hand : Role::link});
  for (const char* finger : {"finger a", "finger b"}) scene.push_back({finger, {}, Role::finger});
  scene.push_back({"panel", {}, Role::panel});
  scene.push_back({"obstacle", {}, Role::intruder});
  for (std::size_t i = 0; i < layout.valves.size(); ++i) {
    const std::string& name = names.valves.at(i);
    scene.push_back({name == "valve" ? "handle" : name + "'s handle", {}, Role::handle});
  }
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) scene.push_back({names.buttons.at(i) + " button", {}, Role::button});
  return scene;
}

OwnBodies own_bodies(const Scene& scene) {
  std::size_t hand = 0;
  while (hand < scene.size() && scene[hand].role != Role::hand) ++hand;
  return OwnBodies(hand);
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
