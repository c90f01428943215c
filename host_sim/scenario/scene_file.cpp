#include "host_sim/scenario/scene_file.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "hal/config/joined.hpp"
#include "hal/config/key_schema.hpp"
#include "hal/config/key_text.hpp"
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

// The keys that a kind has beside those that all have. All but the scale have to be given.
struct Kind {
  const char* name;
  scene::ShapeKind shape;
  std::vector<std::string> keys;
};
constexpr const char* scale_key = "scale";

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{{"box", scene::ShapeKind::box, {"size_m"}},
                                     {"sphere", scene::ShapeKind::sphere, {"radius_m"}},
                                     {"cylinder", scene::ShapeKind::cylinder, {"radius_m", "length_m"}},
                                     {"capsule", scene::ShapeKind::capsule, {"radius_m", "length_m"}},
                                     {"mesh", scene::ShapeKind::mesh, {"file", scale_key}}};
  return all;
}

const Kind& kind_of(const std::string& name) {
  return *std::find_if(kinds().begin(), kinds().end(),
                       [&](const Kind& kind) { return kind.name == name; });  // the table of keys lets no other in
}

bool has(const Kind& kind, const std::string& key) { return std::find(kind.keys.begin(), kind.keys.end(), key) != kind.keys.end(); }

// Of the keys that not all kinds have.
std::set<std::string> kinds_keys() {
  std::set<std::string> all;
  for (const Kind& kind : kinds()) all.insert(kind.keys.begin(), kind.keys.end());
  return all;
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const Kind& kind : kinds()) names.emplace_back(kind.name);
  return names;
}

constexpr std::size_t most_objects = scene::max_objects;

struct Reader {
  fs::path file;
  config::Source source;
  std::vector<std::string>& problems;
  SceneFile scene;
  std::vector<std::string> names;

  [[noreturn]] void refuse(const YAML::Node& node, const std::string& message) const { source.refuse(node.Mark(), message); }

  void check_name(const YAML::Node& node, const std::string& shown, const std::string& name) {
    if (name.empty()) refuse(node, "'" + shown + "' has no name");
    if (std::any_of(name.begin(), name.end(), [](unsigned char letter) { return letter < ' ' || letter == 0x7F; }))
      refuse(node, "'" + shown + ".name' has a letter that cannot be printed");
    if (std::find(names.begin(), names.end(), name) != names.end())
      refuse(node, "'" + shown + ".name': there is another '" + name + "', and messages tell bodies by their names");
    names.push_back(name);
  }

  void check_key(const YAML::Node& node, const std::string& shown, const std::string& kind, const std::string& name) const {
    const bool taken = has(kind_of(kind), name);
    if (node[name] && !taken) refuse(node[name], "'" + shown + "." + name + "': a " + kind + " has none");
    if (!node[name] && taken && name != scale_key) refuse(node, "'" + shown + "' is a " + kind + " and has no " + name);
  }

  scene::Shape mesh_of(const YAML::Node& node, const SceneObject& object, const fs::path& path) {
    try {
      mesh::Reading reading = mesh::read_mesh(path.string(), Vec3::Constant(object.scale));
      mesh::require_solid(reading.mesh, path.string());
      for (const mesh::Note& note : reading.notes) {
        const std::string told = reading.told(note);
        if (std::find(scene.notes.begin(), scene.notes.end(), told) == scene.notes.end()) scene.notes.push_back(told);
      }
      scene::Shape shape;
      shape.kind = scene::ShapeKind::mesh;
      shape.vertices_m = std::move(reading.mesh.vertices_m);
      shape.triangles = std::move(reading.mesh.triangles);
      return shape;
    } catch (const InputError& problem) {
      refuse(node["file"], problem.what());
    }
  }

  scene::Shape shape_of(const YAML::Node& node, const SceneObject& object, const fs::path& mesh) {
    const Kind& kind = kind_of(object.kind);
    if (kind.shape == scene::ShapeKind::mesh) return mesh_of(node, object, mesh);
    scene::Shape shape;
    shape.kind = kind.shape;
    shape.size_m = has(kind, "size_m") ? Vec3(object.size_m[0], object.size_m[1], object.size_m[2])
                                       : Vec3(object.radius_m, 0, has(kind, "length_m") ? object.length_m : 0);
    return shape;
  }

  void add(const YAML::Node& node, const std::string& shown) {
    if (!node.IsMap()) refuse(node, "'" + shown + "' takes a group of keys: name, kind and what goes with it");
    SceneObject object;
    const std::size_t told = problems.size();
    config::read_map(node, "", shown + ".", keys(object), source);
    if (problems.size() > told) return;
    attempt([&] { check_name(node, shown, object.name); });
    if (!node["kind"]) refuse(node, "'" + shown + "' has no kind");
    for (const std::string& name : kinds_keys()) attempt([&] { check_key(node, shown, object.kind, name); });
    if (problems.size() > told) return;
    const fs::path mesh = object.file.empty() ? fs::path() : (file.parent_path() / object.file).lexically_normal();
    scene::Shape shape = shape_of(node, object, mesh);
    for (std::size_t band = 0; band < 3; ++band) shape.albedo[band] = static_cast<float>(object.albedo[band]);
    shape.friction = object.friction;
    scene::Body body;
    body.name = object.name;
    body.role = scene::Role::object;
    body.shapes.push_back(std::move(shape));
    const auto turn = [&](std::size_t i, const Vec3& axis) { return Eigen::AngleAxisd(rad_from_deg(object.turn_deg[i]), axis); };
    body.base_from_body.linear() = (turn(2, Vec3::UnitZ()) * turn(1, Vec3::UnitY()) * turn(0, Vec3::UnitX())).toRotationMatrix();
    body.base_from_body.translation() = Vec3(object.position_m[0], object.position_m[1], object.position_m[2]);
    scene.objects.push_back({object, std::move(body), mesh});
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
    if (root["tasks"] || root["description"]) refuse(root, "is a scenario: `lanternfish scenarios` checks it");
    std::int64_t given = 0;
    std::set<std::string> seen;
    for (const auto& entry : root) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (!seen.insert(name).second) {
        attempt([&] { refuse(entry.first, "'" + name + "' is given twice"); });
      } else if (name == "version") {
        attempt([&] { config::read_value(entry.second, name, key(name, "", version, version, &given, ""), source); });
      } else if (name != "objects") {
        attempt([&] { refuse(entry.first, "unknown key '" + name + "': a scene has version and objects"); });
      }
    }
    if (!root["version"]) attempt([&] { refuse(root, "has no version: this program reads 'version: 1'"); });
    const YAML::Node objects = root["objects"];
    if (!objects) return;
    if (!objects.IsSequence()) refuse(objects, "'objects' takes a list");
    if (objects.size() > most_objects)
      refuse(objects, "'objects' has " + std::to_string(objects.size()) + ", and a scene holds " + std::to_string(most_objects));
    for (const scene::Body& own : scene::bare_scene()) names.push_back(own.name);
    for (std::size_t i = 0; i < objects.size(); ++i) attempt([&] { add(objects[i], "objects[" + std::to_string(i) + "]"); });
  }
};

}  // namespace

Keys keys(SceneObject& object) {
  return {key("name", "", 0, 0, &object.name, "what messages call it"),
          key("kind", "", 0, 0, &object.kind, "its shape", kind_names()),
          key("size_m", "m", 0.001, 10, &object.size_m, "box: its extents"),
          key("radius_m", "m", 0.0005, 5, &object.radius_m, "sphere, cylinder, capsule"),
          key("length_m", "m", 0.001, 10, &object.length_m, "cylinder, and capsule without its caps: along z"),
          key("file", "", 0, 0, &object.file, "mesh: an OBJ, STL or PLY file, relative to the scene's folder"),
          key("scale", "", 1e-6, 1e6, &object.scale, "mesh: metres for one of its units, 0.001 for millimetres"),
          key("frame", "", 0, 0, &object.frame, "what it stands on: its place is in that frame", {"panel", "vehicle"}),
          key("position_m", "m", -20, 20, &object.position_m, "of its origin"),
          key("turn_deg", "deg", -360, 360, &object.turn_deg, "about the frame's x, then y, then z"),
          key("albedo", "", 0, 1, &object.albedo, "what it reflects of red, green and blue"),
          key("friction", "", 0, 2, &object.friction, "of its surface; that of a contact is the product of both")};
}

// That of the table, and what the table cannot say: what each kind has to have, and has not.
std::string scene_schema() {
  SceneObject object;
  using Json = nlohmann::ordered_json;
  Json schema = Json::parse(config::list_file_schema("objects", keys(object), {"name", "kind"}, version, "Lanternfish scene"));
  Json& objects = schema["properties"]["objects"];
  objects["maxItems"] = most_objects;
  for (const Kind& kind : kinds()) {
    Json required = Json::array(), others = Json::object();
    for (const std::string& name : kinds_keys()) {
      if (!has(kind, name)) others[name] = false;
      if (has(kind, name) && name != scale_key) required.push_back(name);
    }
    objects["items"]["allOf"].push_back(
        {{"if", {{"properties", {{"kind", {{"const", kind.name}}}}}}}, {"then", {{"required", required}, {"properties", others}}}});
  }
  return schema.dump(2) + "\n";
}

std::string scene_keys_markdown() {
  SceneObject object;
  std::string out = config::markdown_head;
  for (const Key& key : keys(object)) out += config::markdown_row(key, "objects[].");
  return out;
}

Extent extent_of(const scene::Body& body) {
  Extent extent{Vec3::Constant(std::numeric_limits<double>::infinity()), Vec3::Constant(-std::numeric_limits<double>::infinity())};
  const auto take = [&](const Vec3& point, const Vec3& half) {
    extent.least_m = extent.least_m.cwiseMin(point - half);
    extent.most_m = extent.most_m.cwiseMax(point + half);
  };
  for (const scene::Shape& shape : body.shapes) {
    const Pose pose = body.base_from_body * shape.body_from_shape;
    const Vec3 middle = pose.translation(), axis = pose.linear().col(2).cwiseAbs();
    const double radius_m = shape.size_m.x();
    switch (shape.kind) {
      case scene::ShapeKind::box: take(middle, 0.5 * (pose.linear().cwiseAbs() * shape.size_m)); break;
      case scene::ShapeKind::sphere: take(middle, Vec3::Constant(radius_m)); break;
      case scene::ShapeKind::capsule: take(middle, 0.5 * shape.size_m.z() * axis + Vec3::Constant(radius_m)); break;
      case scene::ShapeKind::cylinder:
        take(middle, 0.5 * shape.size_m.z() * axis + radius_m * (Vec3::Ones() - axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt());
        break;
      case scene::ShapeKind::mesh:
        for (const Vec3& vertex : shape.vertices_m) take(pose * vertex, Vec3::Zero());
        break;
    }
  }
  return extent;
}

std::string scene_yaml(const SceneFile& scene, const std::vector<std::string>& mesh_names) {
  std::string text = "version: " + std::to_string(version) + "\nobjects:" + (scene.objects.empty() ? " []\n" : "\n");
  const std::set<std::string> of_some = kinds_keys();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    SceneObject object = scene.objects[i].said;
    if (!object.file.empty()) object.file = mesh_names[i];
    std::string line;
    for (const Key& key : keys(object)) {
      if (of_some.contains(key.path) && !has(kind_of(object.kind), key.path)) continue;
      line += (line.empty() ? "" : ", ") + key.path + ": " + config::value_text(key);
    }
    text += "  - {" + line + "}\n";
  }
  return text;
}

SceneFile read_scene_file(const fs::path& file) {
  std::vector<std::string> problems;
  Reader reader{file, config::Source::of_file(file, problems), problems, {}, {}};
  const YAML::Node root = config::parse_yaml(config::read_text_file(file), reader.source);
  reader.attempt([&] { reader.read(root); });
  if (!problems.empty()) throw InputError(config::joined(problems));
  return std::move(reader.scene);
}

std::vector<scene::Body> placed_objects(const SceneFile& scene, const Pose& base_from_panel) {
  std::vector<scene::Body> bodies;
  for (const SceneFile::Placed& placed : scene.objects) {
    bodies.push_back(placed.body);
    if (placed.said.frame == "panel") bodies.back().base_from_body = base_from_panel * placed.body.base_from_body;
  }
  return bodies;
}

}  // namespace lf::scenario
