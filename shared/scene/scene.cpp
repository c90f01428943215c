#include "shared/scene/scene.hpp"

namespace lf::scene {

Scene bare_scene() {
  return {{"vehicle", {}, Role::vehicle},      {"slew", {}, Role::link},
          {"upper arm", {}, Role::link},       {"forearm", {}, Role::link},
          {"wrist", {}, Role::hand},           {"finger a", {}, Role::finger},
          {"finger b", {}, Role::finger},      {"panel", {}, Role::panel},
          {"handle", {}, Role::handle},        {"left button", {}, Role::button},
          {"centre button", {}, Role::button}, {"right button", {}, Role::button},
          {"obstacle", {}, Role::intruder}};
}

}  // namespace lf::scene
