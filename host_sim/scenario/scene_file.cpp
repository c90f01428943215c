#include "host_sim/scenario/scene_file.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "hal/config/key_schema.hpp"
#include "hal/config/key_text.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/input_error.hpp"
#include "shared/mesh/judge.hpp"
#include "shared/mesh/read_mesh.hpp"

namespace lf::scenario {
namespace {

namespace fs = std::filesystem;
using config::Key, config::key, config::Keys;

constexpr std::int64_t version = 1;

// Which kinds a key is for; one that is not listed is for all.
const std::map<std::string, std::vector<std::string>>& kinds_of_keys() {
  static const std::map<std::string, std::vector<std::string>> kinds{{"size_m", {"box"}},
                                                                     {"radius_m", {"sphere", "cylinder", "capsule"}},
                                                                     {"length_m", {"cylinder", "capsule"}},
                                                                     {"file", {"mesh"}},
                                                                     {"scale", {"mesh"}}};
  return kinds;
}

struct Reader {
  fs::path file;
  config::Source source;
  std::vector<std::string>& problems;
  SceneFile scene;
  std::vector<std::string> names;

  [[noreturn]] void refuse(const YAML::Node& node, const std::string& message) const { source.refuse(node.Mark(), message); }

  void check_name(const YAML::Node& node, const std::string& shown, const std::string& name) {
    if (name.empty()) refuse(node, "'" + shown + "' has no name");
    if (std::find(names.begin(), names.end(), name) != names.end())
      refuse(node, "'" + shown + ".name': there is another '" + name + "', and messages tell bodies by their names");
    names.push_back(name);
  }

  void check_kind(const YAML::Node& node, const std::string& shown, const std::string& kind) const {
    for (const auto& [name, kinds] : kinds_of_keys()) {
      const bool taken = std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
      if (node[name] && !taken) refuse(node[name], "'" + shown + "." + name + "': a " + kind + " has none");
      if (!node[name] && taken && name != "scale") refuse(node, "'" + shown + "' is a " + kind + " and has no " + name);
    }
  }

  scene::Shape mesh_of(const YAML::Node& node, const SceneObject& object) {
    const fs::path path = file.parent_path() / object.file;
    try {
      mesh::Reading reading = mesh::read_mesh(path.string(), Vec3::Constant(object.scale));
      mesh::Mesh& mesh = reading.mesh;
      mesh::require_solid(mesh, path.string());
      if (std::find(scene.meshes.begin(), scene.meshes.end(), path) == scene.meshes.end()) {
        scene.meshes.push_back(path);
        for (const mesh::Note& note : reading.notes) scene.notes.push_back(reading.told(note));
      }
      scene::Shape shape;
      shape.kind = scene::ShapeKind::mesh;
      shape.vertices_m = std::move(mesh.vertices_m);
      shape.triangles = std::move(mesh.triangles);
      return shape;
    } catch (const InputError& problem) {
      refuse(node["file"], problem.what());
    }
  }

  scene::Shape shape_of(const YAML::Node& node, const SceneObject& object) {
    if (object.kind == "mesh") return mesh_of(node, object);
    static const std::map<std::string, scene::ShapeKind> kinds{{"box", scene::ShapeKind::box},
                                                               {"sphere", scene::ShapeKind::sphere},
                                                               {"cylinder", scene::ShapeKind::cylinder},
                                                               {"capsule", scene::ShapeKind::capsule}};
    scene::Shape shape;
    shape.kind = kinds.at(object.kind);
    shape.size_m = object.kind == "box" ? Vec3(object.size_m[0], object.size_m[1], object.size_m[2])
                                        : Vec3(object.radius_m, 0, object.kind == "sphere" ? 0 : object.length_m);
    return shape;
  }

  void add(const YAML::Node& node, const std::string& shown) {
    if (!node.IsMap()) refuse(node, "'" + shown + "' takes a group of keys: name, kind and what goes with it");
    SceneObject object;
    const std::size_t told = problems.size();
    config::read_map(node, "", shown + ".", keys(object), source);
    if (problems.size() > told) return;
    check_name(node, shown, object.name);
    if (!node["kind"]) refuse(node, "'" + shown + "' has no kind");
    check_kind(node, shown, object.kind);
    scene::Shape shape = shape_of(node, object);
    for (std::size_t band = 0; band < 3; ++band) shape.albedo[band] = static_cast<float>(object.albedo[band]);
    shape.friction = object.friction;
    scene::Body body;
    body.name = object.name;
    body.role = scene::Role::object;
    body.shapes.push_back(std::move(shape));
    const auto turn = [&](std::size_t i, const Vec3& axis) { return Eigen::AngleAxisd(rad_from_deg(object.turn_deg[i]), axis); };
    body.base_from_body.linear() = (turn(2, Vec3::UnitZ()) * turn(1, Vec3::UnitY()) * turn(0, Vec3::UnitX())).toRotationMatrix();
    body.base_from_body.translation() = Vec3(object.position_m[0], object.position_m[1], object.position_m[2]);
    scene.objects.push_back({std::move(body), object.on == "vehicle"});
  }

  // Goes on after a problem, so that all are told.
  template <typename Step>
  void attempt(Step step) {
    try {
      step();
    } catch (const InputError& problem) {
      problems.emplace_back(problem.what());
    }
  }

  void read(const YAML::Node& root) {
    if (!root.IsMap()) refuse(root, "a scene is a group of keys: version and objects");
    std::int64_t given = 0;
    for (const auto& entry : root) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (name == "version") {
        attempt([&] { config::read_value(entry.second, name, key(name, "", version, version, &given, ""), source); });
      } else if (name != "objects") {
        attempt([&] { refuse(entry.first, "unknown key '" + name + "': a scene has version and objects"); });
      }
    }
    if (!root["version"]) attempt([&] { refuse(root, "has no version: this program reads 'version: 1'"); });
    const YAML::Node objects = root["objects"];
    if (!objects) return;
    if (!objects.IsSequence()) refuse(objects, "'objects' takes a list");
    const std::size_t most = scene::max_bodies - scene::own_body_count;
    if (objects.size() > most)
      refuse(objects, "'objects' has " + std::to_string(objects.size()) + ", and a scene holds " + std::to_string(most));
    for (const scene::Body& own : scene::bare_scene()) names.push_back(own.name);
    for (std::size_t i = 0; i < objects.size(); ++i) attempt([&] { add(objects[i], "objects[" + std::to_string(i) + "]"); });
  }
};

}  // namespace

Keys keys(SceneObject& object) {
  return {key("name", "", 0, 0, &object.name, "what messages call it"),
          key("kind", "", 0, 0, &object.kind, "its shape", {"box", "sphere", "cylinder", "capsule", "mesh"}),
          key("size_m", "m", 0.001, 10, &object.size_m, "box: its extents"),
          key("radius_m", "m", 0.0005, 5, &object.radius_m, "sphere, cylinder, capsule"),
          key("length_m", "m", 0.001, 10, &object.length_m, "cylinder, and capsule without its caps: along z"),
          key("file", "", 0, 0, &object.file, "mesh: an OBJ, STL or PLY file, relative to the scene's folder"),
          key("scale", "", 1e-6, 1e6, &object.scale, "mesh: metres for one of its units, 0.001 for millimetres"),
          key("on", "", 0, 0, &object.on, "what it stands on: its place is in that frame", {"panel", "vehicle"}),
          key("position_m", "m", -20, 20, &object.position_m, "of its origin"),
          key("turn_deg", "deg", -360, 360, &object.turn_deg, "about the frame's x, then y, then z"),
          key("albedo", "", 0, 1, &object.albedo, "what it reflects of red, green and blue"),
          key("friction", "", 0, 2, &object.friction, "of its surface; that of a contact is the product of both")};
}

std::string scene_schema() {
  SceneObject object;
  return config::list_file_schema("objects", keys(object), {"name", "kind"}, version, "Lanternfish scene");
}

std::string scene_keys_markdown() {
  SceneObject object;
  std::string out = config::markdown_head;
  for (const Key& key : keys(object)) out += config::markdown_row(key, "objects[].");
  return out;
}

Extent extent_of(const scene::Body& body) {
  Extent extent{Vec3::Constant(std::numeric_limits<double>::infinity()), Vec3::Constant(-std::numeric_limits<double>::infinity())};
  const auto take = [&](const Vec3& point) {
    extent.least_m = extent.least_m.cwiseMin(point);
    extent.most_m = extent.most_m.cwiseMax(point);
  };
  for (const scene::Shape& shape : body.shapes) {
    const Pose pose = body.base_from_body * shape.body_from_shape;
    for (const Vec3& vertex : shape.vertices_m) take(pose * vertex);
    if (shape.kind == scene::ShapeKind::mesh) continue;
    const double radius_m = shape.size_m.x(), caps_m = shape.kind == scene::ShapeKind::cylinder ? 0 : radius_m;
    const Vec3 half =
        shape.kind == scene::ShapeKind::box ? Vec3(0.5 * shape.size_m) : Vec3(radius_m, radius_m, 0.5 * shape.size_m.z() + caps_m);
    for (unsigned corner = 0; corner < 8; ++corner)
      take(pose * half.cwiseProduct(Vec3((corner & 1U) != 0 ? 1 : -1, (corner & 2U) != 0 ? 1 : -1, (corner & 4U) != 0 ? 1 : -1)));
  }
  return extent;
}

SceneFile read_scene_file(const fs::path& file) {
  std::vector<std::string> problems;
  Reader reader{file, config::Source::of_file(file, problems), problems, {}, {}};
  const YAML::Node root = config::parse_yaml(config::read_text_file(file), reader.source);
  reader.attempt([&] { reader.read(root); });
  if (!problems.empty()) throw InputError(joined(problems));
  return std::move(reader.scene);
}

SceneFile scene_of(const Scenario& scenario) {
  if (scenario.scene.empty()) return {};
  return read_scene_file(config::named_file(scenario.file, "scene", scenario.scene));
}

std::vector<scene::Body> placed_objects(const SceneFile& scene, const Pose& base_from_panel) {
  std::vector<scene::Body> bodies;
  for (const SceneFile::Placed& placed : scene.objects) {
    bodies.push_back(placed.body);
    if (!placed.on_vehicle) bodies.back().base_from_body = base_from_panel * placed.body.base_from_body;
  }
  return bodies;
}

}  // namespace lf::scenario
