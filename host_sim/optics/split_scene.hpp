// The scene in parts: bodies that rest while the robot works at the panel, whose light can be kept from frame to frame, and the arm, which moves.
#pragma once

#include <vector>

#include "host_sim/optics/camera_rays.hpp"
#include "host_sim/optics/ray_scene.hpp"
#include "host_sim/optics/surface.hpp"

namespace lf::optics {

// Fixed: the vehicle, which carries the camera, the panel it is docked to, and what stands about. Yielding: handle and buttons, which rest unless the arm pushes
// them.
inline bool fixed(const scene::Body& body) {
  return body.role == scene::Role::vehicle || body.role == scene::Role::panel || body.role == scene::Role::object;
}
inline bool yields(const scene::Body& body) { return body.role == scene::Role::handle || body.role == scene::Role::button; }
inline bool moves(const scene::Body& body) { return !fixed(body) && !yields(body); }

inline constexpr float near_m = 0.03f;  // closer to a camera or a light is its own housing

// What rays meet of the resting bodies is put together from the fixed ones and from each yielding one by itself, so that its last bit does not depend on a
// body that the rays miss.
class SplitScene {
 public:
  // Throws InputError for a shape that makes no sense.
  explicit SplitScene(const scene::Scene& scene);

  // Moves the bodies. Not while another thread traces.
  void set_poses(const scene::BodyPoses& base_from_body);

  // First surfaces of the resting bodies; in open water the parameter is infinite.
  HitPacket resting(const RayLines& rays) const;
  // First surfaces of all bodies, `resting` being those of the resting ones.
  HitPacket nearest(const RayLines& rays, const HitPacket& resting) const;
  // The same traced at once; equal but for rounding.
  HitPacket all(const RayLines& rays) const;

  // Which of the wanted lanes see a light, none of the bodies in between.
  LaneMask clear_of_resting(const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) const;
  LaneMask clear_of_moving(const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) const;
  LaneMask clear_of_all(const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) const;

 private:
  RayScene all_, fixed_, moving_;
  std::vector<RayScene> yielding_;
};

}  // namespace lf::optics
