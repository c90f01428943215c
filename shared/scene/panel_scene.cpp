#include "shared/scene/panel_scene.hpp"

#include <algorithm>

#include "shared/scene/shapes.hpp"

namespace lf::scene {
namespace {

constexpr Albedo housing_black{0.06f, 0.06f, 0.07f};
constexpr Albedo panel_grey{0.62f, 0.64f, 0.64f};
constexpr Albedo frame_blue{0.10f, 0.22f, 0.38f};
constexpr Albedo plate_white{0.85f, 0.85f, 0.85f};
constexpr Albedo handle_yellow{0.85f, 0.62f, 0.08f};
constexpr Albedo pointer_white{0.85f, 0.85f, 0.85f};
constexpr Albedo pointer_black{0.05f, 0.05f, 0.05f};
constexpr Albedo stem_steel{0.45f, 0.46f, 0.48f};
constexpr Albedo bezel_grey{0.25f, 0.26f, 0.28f};
constexpr std::array cap_colours{Albedo{0.72f, 0.09f, 0.08f}, Albedo{0.09f, 0.48f, 0.14f}, Albedo{0.10f, 0.20f, 0.66f}};  // in turn

// Friction of a pair is the product of both: the URDF's rubber pads bring 0.8, which is then 0.8 on the bar.
constexpr double bar_friction = 1.0;

Shape decoration(Shape of) {
  of.collides = false;
  return of;
}

void add_panel(Body& panel, const PanelLayout& layout) {
  const Vec2 size = layout.plate_max_m - layout.plate_min_m;
  const Vec2 centre = 0.5 * (layout.plate_max_m + layout.plate_min_m);
  panel.shapes.push_back(shape(ShapeKind::box, Vec3(size.x(), size.y(), layout.plate_thickness_m),
                               at(centre.x(), centre.y(), -0.5 * layout.plate_thickness_m), panel_grey));
  for (const PanelLayout::Marker& tag : layout.markers) {
    Shape marker = shape(ShapeKind::box, Vec3(tag.plate_m, tag.plate_m, tag.plate_thickness_m),
                         at(tag.centre_m.x(), tag.centre_m.y(), 0.5 * tag.plate_thickness_m), plate_white);
    marker.marker_id = tag.id;
    marker.marker_size_m = tag.size_m;
    panel.shapes.push_back(marker);
  }
  for (const PanelLayout::Button& button : layout.buttons) {  // a bezel round each button, lower than the cap pressed home
    const double radius = 0.5 * button.width_m + 0.004;
    panel.shapes.push_back(
        decoration(shape(ShapeKind::cylinder, Vec3(radius, 0, 0.006), at(button.at_m.x(), button.at_m.y(), 0.003), bezel_grey)));
  }
  for (const double x : {layout.plate_min_m.x() + 0.06, layout.plate_max_m.x() - 0.06}) {  // the observatory's frame, behind the plate
    const double behind = -layout.plate_thickness_m - 0.03;
    panel.shapes.push_back(
        decoration(shape(ShapeKind::box, Vec3(0.06, size.y() + 0.5, 0.06), at(x, centre.y() - 0.25, behind), frame_blue)));
  }
}

// The part of the bar between two places along it.
Shape bar_part(const PanelLayout::Valve& valve, double from_m, double to_m, const Albedo& albedo) {
  return shape(ShapeKind::box, Vec3(valve.handle_thickness_m, to_m - from_m, valve.depth_m()),
               at(0, 0.5 * (from_m + to_m), valve.handle_height_m), albedo);
}

// Paint changes what is seen, not what is touched: with a pointer the bar that collides is not the two parts that are visible.
void add_bar(Body& handle, const PanelLayout::Valve& valve) {
  const double end_m = 0.5 * valve.handle_length_m;
  Shape bar = bar_part(valve, -end_m, end_m, handle_yellow);
  bar.friction = bar_friction;
  bar.visible = !valve.has_pointer();
  handle.shapes.push_back(bar);
  if (bar.visible) return;
  const double edge_m = end_m - valve.pointer_length_m;
  const Albedo paint = valve.pointer == PanelLayout::Pointer::light_end ? pointer_white : pointer_black;
  handle.shapes.push_back(decoration(bar_part(valve, -end_m, edge_m, handle_yellow)));
  handle.shapes.push_back(decoration(bar_part(valve, edge_m, end_m, paint)));
}

// A D-handle's: at the bar's ends, on a hub.
void add_posts(Body& handle, const PanelLayout::Valve& valve) {
  constexpr double hub_m = 0.010;
  const double thick_m = valve.handle_thickness_m, top_m = valve.handle_height_m - 0.5 * valve.depth_m();
  handle.shapes.push_back(shape(ShapeKind::box, Vec3(thick_m, valve.handle_length_m, hub_m), at(0, 0, 0.5 * hub_m), stem_steel));
  for (const double side : {-1.0, 1.0}) {
    const double y_m = side * 0.5 * (valve.handle_length_m - thick_m);
    handle.shapes.push_back(shape(ShapeKind::box, Vec3(thick_m, thick_m, top_m - hub_m), at(0, y_m, 0.5 * (top_m + hub_m)), stem_steel));
  }
}

void add_handle(Body& handle, const PanelLayout::Valve& valve) {
  add_bar(handle, valve);
  if (valve.carried == PanelLayout::Carried::by_posts) return add_posts(handle, valve);
  const double stem_length = valve.handle_height_m - 0.5 * valve.depth_m();
  handle.shapes.push_back(shape(ShapeKind::cylinder, Vec3(valve.stem_radius_m, 0, stem_length), at(0, 0, 0.5 * stem_length), stem_steel));
}

void add_button(Body& body, const PanelLayout::Button& button, const Albedo& colour) {
  body.shapes.push_back(
      shape(ShapeKind::cylinder, Vec3(0.5 * button.width_m, 0, button.height_m), at(0, 0, 0.5 * button.height_m), colour));
}

}  // namespace

Scene make_scene(const ArmDescription& arm, const PanelLayout& layout, const PanelNames& names, std::span<const Shape> vehicle) {
  std::vector<std::string> links;
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    links.push_back(arm.links[i + 1].name);
    std::replace(links.back().begin(), links.back().end(), '_', ' ');
  }
  Scene scene = bare_scene(layout, names, links);
  const OwnBodies own(arm.arm_joints());
  for (std::size_t i = 0; i < arm.links.size(); ++i) scene[i].shapes = arm.links[i].shapes;
  std::vector<Shape>& base = scene[OwnBodies::vehicle].shapes;
  base.insert(base.end(), vehicle.begin(), vehicle.end());
  add_panel(scene[own.panel()], layout);
  std::size_t body = own.first_feature();
  for (const PanelLayout::Valve& valve : layout.valves) add_handle(scene[body++], valve);
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) add_button(scene[body++], layout.buttons[i], cap_colours[i % cap_colours.size()]);
  return scene;
}

}  // namespace lf::scene
