// A scene's file: what else stands about, beside the robot and the panel. Physics collides it, the camera sees it, the cloud's score counts it as surface;
// the core does not know of it.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "hal/config/key.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/scene/scene.hpp"

namespace lf::scenario {

// One thing that does not move, as the file says it.
struct SceneObject {
  std::string name;
  std::string kind = "box";
  std::array<double, 3> size_m{0.1, 0.1, 0.1};  // box
  double radius_m = 0.05;                       // sphere, cylinder, capsule
  double length_m = 0.1;                        // cylinder, and capsule without its caps; along z
  std::string file;                             // mesh
  double scale = 1;                             // mesh: metres for one of the file's units
  std::string frame = "panel";                  // what it stands on, in whose frame its place is
  std::array<double, 3> position_m{};
  std::array<double, 3> turn_deg{};  // about the frame's x, then y, then z, as a URDF's rpy
  std::array<double, 3> albedo{0.5, 0.5, 0.5};
  double friction = 0.6;
};

struct SceneFile {
  struct Placed {
    SceneObject said;
    scene::Body body;            // in the frame of what it stands on
    std::filesystem::path mesh;  // the file that was read; empty where it is none
  };
  std::vector<Placed> objects;
  std::vector<std::string> notes;  // what was assumed of the meshes, changed or not used: "file:line: text"
};

// Of a body, in the frame that it is placed in.
struct Extent {
  Vec3 least_m = Vec3::Zero(), most_m = Vec3::Zero();
};
Extent extent_of(const scene::Body& body);

// Its keys, "objects[]." left out; the pointers are into the argument.
config::Keys keys(SceneObject& object);
// JSON Schema of the file, and the table of its keys for the users' page.
std::string scene_schema();
std::string scene_keys_markdown();

// Throws InputError with all of its problems, a line each: what yaml_reader.hpp refuses, another version, a name that is missing, given twice or one of the
// scene's own bodies, a key that is another kind's, a mesh that cannot be read or encloses no volume, more than scene::max_bodies bodies.
SceneFile read_scene_file(const std::filesystem::path& file);

// Those objects, where the panel stands at `base_from_panel`.
std::vector<scene::Body> placed_objects(const SceneFile& scene, const Pose& base_from_panel);

// The scene as a file of its own, with each mesh under the name that `mesh_name` gives to its place in the list.
std::string scene_yaml(const SceneFile& scene, const std::vector<std::string>& mesh_names);

}  // namespace lf::scenario
