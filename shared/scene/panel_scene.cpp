#include "shared/scene/panel_scene.hpp"

namespace lf::scene {
namespace {

using Albedo = std::array<float, 3>;

constexpr Albedo vehicle_yellow{0.80f, 0.58f, 0.06f};
constexpr Albedo skid_grey{0.18f, 0.19f, 0.20f};
constexpr Albedo housing_black{0.06f, 0.06f, 0.07f};
constexpr Albedo panel_grey{0.62f, 0.64f, 0.64f};
constexpr Albedo frame_blue{0.10f, 0.22f, 0.38f};
constexpr Albedo plate_white{0.85f, 0.85f, 0.85f};
constexpr Albedo handle_yellow{0.85f, 0.62f, 0.08f};
constexpr Albedo pointer_white{0.85f, 0.85f, 0.85f};
constexpr Albedo pointer_black{0.05f, 0.05f, 0.05f};
constexpr Albedo stem_steel{0.45f, 0.46f, 0.48f};
constexpr Albedo bezel_grey{0.25f, 0.26f, 0.28f};
constexpr std::array<Albedo, PanelLayout::button_count> cap_colours{Albedo{0.72f, 0.09f, 0.08f}, Albedo{0.09f, 0.48f, 0.14f},
                                                                    Albedo{0.10f, 0.20f, 0.66f}};

// Friction of a pair is the product of both: the URDF's rubber pads bring 0.8, which is then 0.8 on the bar.
constexpr double bar_friction = 1.0;
constexpr double default_friction = 0.6;

Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Vec3(x, y, z);
  return pose;
}

// The shape's z turned into `z_direction`.
Pose along(const Vec3& centre, const Vec3& z_direction) {
  Pose pose = at(centre.x(), centre.y(), centre.z());
  pose.linear() = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), z_direction).toRotationMatrix();
  return pose;
}

Shape shape(ShapeKind kind, const Vec3& size_m, const Pose& body_from_shape, const Albedo& albedo) {
  Shape made;
  made.kind = kind;
  made.size_m = size_m;
  made.body_from_shape = body_from_shape;
  made.albedo = albedo;
  made.friction = default_friction;
  return made;
}

Shape decoration(Shape of) {
  of.collides = false;
  return of;
}

// Three torpedo hulls over a skid, as on the GIRONA500, behind and above the arm's workspace.
void add_vehicle(Body& vehicle) {
  const Vec3 forward = Vec3::UnitX();
  const Vec3 hull_size(0.16, 0, 0.95);
  vehicle.shapes.push_back(shape(ShapeKind::capsule, hull_size, along(Vec3(-0.55, -0.35, -0.85), forward), vehicle_yellow));
  vehicle.shapes.push_back(shape(ShapeKind::capsule, hull_size, along(Vec3(-0.55, 0.35, -0.85), forward), vehicle_yellow));
  vehicle.shapes.push_back(shape(ShapeKind::capsule, Vec3(0.15, 0, 0.85), along(Vec3(-0.60, 0, -0.30), forward), vehicle_yellow));
  vehicle.shapes.push_back(shape(ShapeKind::box, Vec3(0.70, 0.60, 0.02), at(-0.37, 0, -0.115), skid_grey));
  for (const double y : {-0.30, 0.30}) {
    vehicle.shapes.push_back(shape(ShapeKind::cylinder, Vec3(0.02, 0, 0.70), along(Vec3(-0.37, y, -0.115), forward), skid_grey));
    vehicle.shapes.push_back(shape(ShapeKind::box, Vec3(0.03, 0.03, 0.75), at(-0.30, y, -0.46), skid_grey));
  }
}

void add_panel(Body& panel, const PanelLayout& layout) {
  const Vec2 size = layout.plate_max_m - layout.plate_min_m;
  const Vec2 centre = 0.5 * (layout.plate_max_m + layout.plate_min_m);
  panel.shapes.push_back(shape(ShapeKind::box, Vec3(size.x(), size.y(), layout.plate_thickness_m),
                               at(centre.x(), centre.y(), -0.5 * layout.plate_thickness_m), panel_grey));
  Shape marker = shape(ShapeKind::box, Vec3(layout.marker_plate_m, layout.marker_plate_m, layout.marker_plate_thickness_m),
                       at(layout.marker_centre_m.x(), layout.marker_centre_m.y(), 0.5 * layout.marker_plate_thickness_m), plate_white);
  marker.marker_id = layout.marker_id;
  marker.marker_size_m = layout.marker_size_m;
  panel.shapes.push_back(marker);
  for (const Vec2& button : layout.buttons_m) {  // a bezel round each button, lower than the cap pressed home
    const double radius = 0.5 * layout.button_width_m + 0.004;
    panel.shapes.push_back(decoration(shape(ShapeKind::cylinder, Vec3(radius, 0, 0.006), at(button.x(), button.y(), 0.003), bezel_grey)));
  }
  for (const double x : {layout.plate_min_m.x() + 0.06, layout.plate_max_m.x() - 0.06}) {  // the observatory's frame, behind the plate
    const double behind = -layout.plate_thickness_m - 0.03;
    panel.shapes.push_back(
        decoration(shape(ShapeKind::box, Vec3(0.06, size.y() + 0.5, 0.06), at(x, centre.y() - 0.25, behind), frame_blue)));
  }
}

// The part of the bar between two places along it.
Shape bar_part(const PanelLayout& layout, double from_m, double to_m, const Albedo& albedo) {
  return shape(ShapeKind::box, Vec3(layout.handle_thickness_m, to_m - from_m, layout.handle_thickness_m),
               at(0, 0.5 * (from_m + to_m), layout.handle_height_m), albedo);
}

// Paint changes what is seen, not what is touched: with a pointer the bar that collides is not the two parts that are visible.
void add_bar(Body& handle, const PanelLayout& layout) {
  const double end_m = 0.5 * layout.handle_length_m;
  Shape bar = bar_part(layout, -end_m, end_m, handle_yellow);
  bar.friction = bar_friction;
  bar.visible = layout.pointer == PanelLayout::Pointer::none;
  handle.shapes.push_back(bar);
  if (bar.visible) return;
  const double edge_m = end_m - layout.pointer_length_m;
  const Albedo paint = layout.pointer == PanelLayout::Pointer::light_end ? pointer_white : pointer_black;
  handle.shapes.push_back(decoration(bar_part(layout, -end_m, edge_m, handle_yellow)));
  handle.shapes.push_back(decoration(bar_part(layout, edge_m, end_m, paint)));
}

void add_handle(Body& handle, const PanelLayout& layout) {
  const double stem_length = layout.handle_height_m - 0.5 * layout.handle_thickness_m;
  add_bar(handle, layout);
  handle.shapes.push_back(shape(ShapeKind::cylinder, Vec3(layout.stem_radius_m, 0, stem_length), at(0, 0, 0.5 * stem_length), stem_steel));
}

void add_button(Body& button, const PanelLayout& layout, const Albedo& colour) {
  button.shapes.push_back(shape(ShapeKind::cylinder, Vec3(0.5 * layout.button_width_m, 0, layout.button_height_m),
                                at(0, 0, 0.5 * layout.button_height_m), colour));
}

}  // namespace

Scene make_scene(const ArmDescription& arm, const PanelLayout& layout) {
  Scene scene = bare_scene();
  for (std::size_t i = 0; i < ArmDescription::link_count; ++i) scene[i].shapes = arm.links[i].shapes;
  add_vehicle(scene[std::size_t(BodyId::vehicle)]);
  add_panel(scene[std::size_t(BodyId::panel)], layout);
  add_handle(scene[std::size_t(BodyId::handle)], layout);
  for (std::size_t i = 0; i < PanelLayout::button_count; ++i) {
    add_button(scene[std::size_t(BodyId::button_left) + i], layout, cap_colours[i]);
  }
  return scene;
}

}  // namespace lf::scene
