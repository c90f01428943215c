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
  std::vector<record::ReportPart> parts(config.scene.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].name = config.scene[i].name;
    parts[i].shapes = config.scene[i].shapes;
  }
  parts[std::size_t(scene::BodyId::vehicle)].group = record::PartGroup::vehicle;
  for (std::size_t i = std::size_t(scene::BodyId::obstacle); i < parts.size(); ++i) {
    parts[i].group = record::PartGroup::panel;
    parts[i].parent_from_part = config.scene[i].base_from_body;
  }
  for (std::size_t i = 0; i < joint_count; ++i)
    turn_by(parts[i + 1], config.arm.joints[i], static_cast<scene::BodyId>(i), static_cast<int>(i));
  turn_by(parts[std::size_t(scene::BodyId::finger_b)], config.arm.finger_b, scene::BodyId::wrist, static_cast<int>(Joint::jaw));

  record::ReportPart& panel = parts[std::size_t(scene::BodyId::panel)];
  panel.group = record::PartGroup::panel;
  panel.parent_from_part = config.base_from_panel;
  record::ReportPart& handle = parts[std::size_t(scene::BodyId::handle)];
  handle.group = record::PartGroup::controls;
  handle.parent = index_of(scene::BodyId::panel);
  handle.coordinate = static_cast<int>(joint_count);
  for (std::size_t i = 0; i < PanelLayout::button_count; ++i) {
    record::ReportPart& button = parts[std::size_t(scene::BodyId::button_left) + i];
    button.group = record::PartGroup::controls;
    button.parent = index_of(scene::BodyId::panel);
    button.parent_from_part.translation() = Vec3(config.layout.buttons_m[i].x(), config.layout.buttons_m[i].y(), 0);
    button.coordinate = static_cast<int>(joint_count + 1 + i);
    button.slides = true;
    button.axis = -Vec3::UnitZ();
  }
  return parts;
}

}  // namespace lf::app
