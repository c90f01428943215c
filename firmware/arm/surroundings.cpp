#include "firmware/arm/surroundings.hpp"

namespace lf::arm {

void Surroundings::enter(const Room& room) {
  room_ = room;
  panel_ = PanelShape(layout_).grown(room.base_from_panel, room.doubt);
}

Distances Surroundings::distances(const JointVector& q_rad, double jaw_rad) const {
  const LinkCapsules capsules = arm_.link_capsules(q_rad, jaw_rad);
  return {panel_.clearance(capsules, room_.base_from_panel, 0, room_.meant_for_fingers).distance_m,
          clearance_to_vehicle(capsules, vehicle_), clearance_to_itself(capsules)};
}

}  // namespace lf::arm
