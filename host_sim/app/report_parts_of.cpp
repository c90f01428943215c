#include "host_sim/app/report_parts_of.hpp"

namespace lf::app {
namespace {

int index_of(scene::BodyId body) { return static_cast<int>(body); }

void turn_by(record::ReportPart& part, const ArmJoint& joint, scene::BodyId parent, int coordinate) {
  part.parent = index_of(parent);
  part.parent_from_part = joint.parent_from_joint;
  part.axis = joint.axis.normalized();
  part.coordinate = coordinate;
}

}  // namespace

std::vector<record::ReportPart> report_parts_of(const world::WorldConfig& config) {
  const scene::OwnBodies own(config.arm.arm_joints());
  std::vector<record::ReportPart> parts(config.scene.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].name = config.scene[i].name;
    parts[i].shapes = config.scene[i].shapes;
  }
  parts[scene::OwnBodies::vehicle].group = record::PartGroup::vehicle;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (config.scene[i].role != scene::Role::object && config.scene[i].role != scene::Role::intruder) continue;
    parts[i].group = record::PartGroup::panel;
    parts[i].parent_from_part = config.scene[i].base_from_body;
  }
  for (std::size_t i = 0; i < config.arm.joints.size(); ++i) turn_by(parts[i + 1], config.arm.joints[i], i, static_cast<int>(i));
  turn_by(parts[own.finger_b()], config.arm.finger_b, own.hand, static_cast<int>(config.arm.arm_joints()));

  record::ReportPart& panel = parts[own.panel()];
  panel.group = record::PartGroup::panel;
  panel.parent_from_part = config.base_from_panel;
  int coordinate = static_cast<int>(config.arm.joints.size());
  const auto place = [&](std::size_t body, const Vec2& at_m) -> record::ReportPart& {
    record::ReportPart& part = parts[body];
    part.group = record::PartGroup::controls;
    part.parent = index_of(own.panel());
    part.parent_from_part.translation() = Vec3(at_m.x(), at_m.y(), 0);
    part.coordinate = coordinate++;
    return part;
  };
  std::size_t body = own.first_feature();
  for (const PanelLayout::Valve& valve : config.layout.valves) place(body++, valve.at_m);
  for (const PanelLayout::Button& layout : config.layout.buttons) {
    record::ReportPart& button = place(body++, layout.at_m);
    button.slides = true;
    button.axis = -Vec3::UnitZ();
  }
  return parts;
}

}  // namespace lf::app
