#include "shared/urdf/read_link.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "shared/urdf/mesh_file.hpp"

namespace lf::urdf {
namespace {

// Nothing where it has none, or after a problem.
std::optional<Colour> read_colour(const Element& material) {
  material.check({.attributes = {"name"}, .once = {"color"}, .unused = {"texture"}});
  const auto color = material.child("color");
  if (!color) return std::nullopt;
  color->check({.attributes = {"rgba"}});
  std::array<double, 4> rgba{};
  if (!color->numbers("rgba", rgba, {0, 1, "divide by 255 what goes to 255"})) return std::nullopt;
  Colour colour{};
  std::transform(rgba.begin(), rgba.end(), colour.begin(), [](double value) { return static_cast<float>(value); });
  return colour;
}

std::optional<Colour> colour_of(const Element& visual, const Materials& materials) {
  const auto material = visual.child("material");
  if (!material) return std::nullopt;
  if (material->child("color") || material->child("texture")) return read_colour(*material);
  material->check({.attributes = {"name"}, .once = {"color"}, .unused = {"texture"}});
  const std::string name = material->needed_name();
  if (name.empty()) return std::nullopt;
  const auto found = materials.find(name);
  if (found != materials.end()) return found->second;
  material->problem("is defined nowhere: define it below <robot>, or give it a <color> here");
  return std::nullopt;
}

std::optional<Geometry> read_mesh(const Element& mesh, const ReadOptions& options, bool is_visual) {
  mesh.check({.attributes = {"filename", "scale"}});
  Mesh result;
  const std::string name(mesh.needed_text("filename", "name the file of the mesh"));
  constexpr double most_scale = 1e6;
  if (mesh.has("scale") && mesh.numbers("scale", std::span(result.scale.data(), 3), {-most_scale, most_scale, "correct it"})) {
    if (result.scale.cwiseAbs().minCoeff() < 1e-9) mesh.problem("has a scale of 0: it would be flat");
    if (result.scale.prod() < 0) mesh.note("has a negative scale: it is mirrored");
  }
  if (name.empty()) return std::nullopt;
  const std::filesystem::path folder = std::filesystem::path(mesh.report().file()).parent_path();
  const MeshFile found = find_mesh(name, folder, options.package_folders);
  if (!found.file) {
    if (found.missing && (is_visual || options.ignore_missing_meshes))
      mesh.note(found.problem + ". The " + (is_visual ? "visual" : "collision") + " is left out");
    else
      mesh.problem(found.problem + (found.missing ? ", or leave it out (--ignore-missing)" : ""));
    return std::nullopt;
  }
  if (!found.remark.empty()) mesh.note(found.remark);
  const MeshUnit unit = unit_of(*found.file);
  if (!unit.remark.empty()) mesh.note(unit.remark);
  if (!unit.problem.empty()) mesh.problem(unit.problem);
  result.file = *found.file;
  result.metres_per_unit = unit.metres_per_unit;
  return result;
}

// Nothing after a problem, and where a mesh is left out.
std::optional<Geometry> read_geometry(const Element& of, const ReadOptions& options, bool is_visual) {
  const auto geometry = of.needed_child("geometry", "give it a box, cylinder, sphere or mesh");
  if (!geometry) return std::nullopt;
  if (geometry->child("capsule")) {
    geometry->problem("holds a <capsule>, which is not URDF 1.0: write a <cylinder>, and a <sphere> at each end");
    return std::nullopt;
  }
  geometry->check({.once = {"box", "cylinder", "sphere", "mesh"}});
  std::vector<Element> shapes;
  for (const char* const kind : {"box", "cylinder", "sphere", "mesh"})
    for (const Element& shape : geometry->children(kind)) shapes.push_back(shape);
  if (shapes.size() != 1) {
    geometry->problem("has to hold one shape, and holds " + std::to_string(shapes.size()) + ": give each shape a " +
                      std::string(of.name()) + " of its own");
    return std::nullopt;
  }
  const Element& shape = shapes.front();
  if (shape.name() == "mesh") return read_mesh(shape, options, is_visual);
  if (shape.name() == "box") {
    shape.check({.attributes = {"size"}});
    Box box;
    if (!shape.numbers("size", std::span(box.size_m.data(), 3), an_extent)) return std::nullopt;
    return box;
  }
  const bool is_cylinder = shape.name() == "cylinder";
  if (is_cylinder)
    shape.check({.attributes = {"radius", "length"}});
  else
    shape.check({.attributes = {"radius"}});
  const auto radius_m = shape.needed_number("radius", an_extent);
  if (!is_cylinder) return radius_m ? std::optional<Geometry>(Sphere{*radius_m}) : std::nullopt;
  const auto length_m = shape.needed_number("length", an_extent);
  if (!radius_m || !length_m) return std::nullopt;
  return Cylinder{*radius_m, *length_m};
}

// A visual's or collision's own name: it may be absent and may be empty.
std::string own_name(const Element& element) { return element.text("name").empty() ? "" : element.needed_name(); }

void read_visual(const Element& e, const Materials& materials, const ReadOptions& options, Link& link) {
  e.check({.attributes = {"name"}, .once = {"origin", "geometry", "material"}});
  Visual visual{own_name(e), e.origin(), {}, colour_of(e, materials), e.line()};
  const auto geometry = read_geometry(e, options, true);
  if (!geometry) return;
  visual.geometry = *geometry;
  link.visuals.push_back(std::move(visual));
}

void read_collision(const Element& e, const ReadOptions& options, Link& link) {
  e.check({.attributes = {"name"},
           .once = {"origin", "geometry"},
           .unused = {"verbose", "contact_coefficients", "material"},
           .ours = {"friction"}});
  Collision collision{own_name(e), e.origin(), {}, e.extensions(), e.line()};
  const auto geometry = read_geometry(e, options, false);
  if (!geometry) return;
  collision.geometry = *geometry;
  link.collisions.push_back(std::move(collision));
}

bool is_sound(const Element& e, const Mat3& inertia) {
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvalues();  // ascending
  if (!(principal[0] > 0)) {
    e.problem("is not positive definite: give each principal moment a value above 0, for instance those of a box of this size and mass");
    return false;
  }
  // A thin plate's moments fulfil p0 + p1 = p2, and files round to six digits.
  if (principal[0] + principal[1] < principal[2] * (1 - 1e-5)) {
    e.problem(
        "is of no body: a principal moment exceeds the sum of the others. Is it in the axes of the inertial's origin, about the centre of "
        "mass?");
    return false;
  }
  return true;
}

std::optional<Inertial> read_inertial(const Element& e) {
  e.check({.once = {"origin", "mass", "inertia"}});
  Inertial inertial;
  inertial.link_from_com = e.origin();
  const auto mass = e.needed_child("mass", "give it, or remove the inertial");
  const auto inertia = e.needed_child("inertia", "give it, or remove the inertial");
  if (!mass || !inertia) return std::nullopt;
  mass->check({.attributes = {"value"}});
  inertia->check({.attributes = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}});
  const auto mass_kg = mass->needed_number("value", {0, 1e6, "URDF has kilograms"});
  std::array<double, 6> moments{};
  bool all = true;
  constexpr std::array<const char*, 6> names{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto moment = inertia->needed_number(names[i], {-1e9, 1e9, "URDF has kg m^2"});
    all = all && moment.has_value();
    moments[i] = moment.value_or(0);
  }
  if (!mass_kg || !all) return std::nullopt;
  inertial.mass_kg = *mass_kg;
  inertial.inertia_kg_m2 << moments[0], moments[1], moments[2], moments[1], moments[3], moments[4], moments[2], moments[4], moments[5];
  if (*mass_kg == 0 && inertial.inertia_kg_m2.isZero(0)) {
    e.note("has mass 0 and inertia 0: the link has no mass");
    return std::nullopt;
  }
  if (*mass_kg < 1e-9) {
    mass->problem("has to be above 0: give the link's mass, or remove the inertial");
    return std::nullopt;
  }
  if (!is_sound(*inertia, inertial.inertia_kg_m2)) return std::nullopt;
  return inertial;
}

}  // namespace

Materials read_materials(const Element& robot) {
  Materials materials;
  for (const Element& e : robot.children("material")) {
    const std::string name = e.needed_name();
    const std::optional<Colour> colour = read_colour(e);
    if (!e.child("color") && !e.child("texture")) e.problem("has neither color nor texture: give it a <color>");
    if (name.empty()) continue;
    const auto [earlier, is_new] = materials.emplace(name, colour);
    if (!is_new && earlier->second != colour) e.problem("is defined twice, with two colours: remove one");
  }
  // A visual's material serves later visuals that name it, as urdfdom has it. It is checked where the visual is read.
  Report unused(robot.report().file());
  for (const Element& link : robot.children("link"))
    for (const Element& visual : link.children("visual"))
      for (const Element& material : visual.children("material")) {
        if (!material.has("name") || !(material.child("color") || material.child("texture"))) continue;
        const std::optional<Colour> colour = read_colour(Element(material.xml(), unused));
        const auto [earlier, is_new] = materials.emplace(material.text("name"), colour);
        if (!is_new && earlier->second != colour) material.note("has another colour than the first of its name. It has its own here");
      }
  return materials;
}

Link read_link(const Element& element, const Materials& materials, const ReadOptions& options) {
  element.check({.attributes = {"name"},
                 .once = {"inertial"},
                 .many = {"visual", "collision"},
                 .unused = {"origin", "self_collision_checking"},
                 .ours = {"wet_weight"},
                 .unused_attributes = {"type"}});
  Link link;
  link.name = element.needed_name();
  link.line = element.line();
  if (const auto inertial = element.child("inertial"))
    link.inertial = read_inertial(*inertial);
  else
    element.note("has no inertial: it has no mass");
  for (const Element& e : element.children("visual")) read_visual(e, materials, options, link);
  for (const Element& e : element.children("collision")) read_collision(e, options, link);
  link.extensions = element.extensions();
  return link;
}

}  // namespace lf::urdf
