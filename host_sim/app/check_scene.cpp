#include "host_sim/app/check_scene.hpp"

#include <filesystem>

#include "hal/config/text_file.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/outside_picture.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scene_file.hpp"

namespace lf::app {
namespace {

Json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json json_of(const scenario::SceneFile::Placed& object) {
  const scene::Shape& shape = object.body.shapes.front();
  const scenario::Extent extent = scenario::extent_of(object.body);
  Json json{{"name", object.body.name},        {"kind", object.said.kind},
            {"frame", object.said.frame},      {"position_m", list(object.body.base_from_body.translation())},
            {"least_m", list(extent.least_m)}, {"most_m", list(extent.most_m)},
            {"albedo", shape.albedo},          {"friction", shape.friction}};
  if (shape.kind == scene::ShapeKind::mesh) json["triangles"] = shape.triangles.size();
  return json;
}

void tell(const scenario::SceneFile::Placed& object) {
  const scene::Shape& shape = object.body.shapes.front();
  const scenario::Extent extent = scenario::extent_of(object.body);
  const std::string triangles = shape.kind == scene::ShapeKind::mesh ? ", " + count_of(shape.triangles.size(), "triangle") : "";
  print("  %-16s %s on the %s, x %.3f to %.3f, y %.3f to %.3f, z %.3f to %.3f m%s\n", object.body.name.c_str(), object.said.kind.c_str(),
        object.said.frame.c_str(), extent.least_m.x(), extent.most_m.x(), extent.least_m.y(), extent.most_m.y(), extent.least_m.z(),
        extent.most_m.z(), triangles.c_str());
}

// The default scenario with the scene. Throws InputError where an object stands in the robot, wherever the panel may be docked.
scenario::Scenario among(const std::string& file) {
  (void)config::read_text_file(file);  // a missing file is told by its own name, not by the scenario's key
  const scenario::Scenario scenario =
      scenario::load_scenario("default", {"scene=" + Json(std::filesystem::absolute(file).string()).dump()});
  scenario::check_runnable(scenario);
  return scenario;
}

}  // namespace

int check_scene(const std::string& file, const std::string& picture, bool json) {
  const scenario::Scenario scenario = among(file);
  const scenario::SceneFile& scene = *scenario.objects;
  if (!picture.empty()) draw_outside(scenario, scenario, picture);
  if (json) {
    Json objects = Json::array();
    for (const scenario::SceneFile::Placed& object : scene.objects) objects.push_back(json_of(object));
    Json document{{"file", file}, {"objects", objects}, {"notes", scene.notes}};
    if (!picture.empty()) document["picture"] = picture;
    print_json(document);
    return done;
  }
  print("%s: %s\n", file.c_str(), count_of(scene.objects.size(), "object").c_str());
  for (const scenario::SceneFile::Placed& object : scene.objects) tell(object);
  if (!scene.notes.empty()) print("what was assumed, changed or is of no use here:\n");
  for (const std::string& note : scene.notes) print("  %s\n", note.c_str());
  if (!picture.empty()) print("picture: %s\n", picture.c_str());
  return done;
}

}  // namespace lf::app
