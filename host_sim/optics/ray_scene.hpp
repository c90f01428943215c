// The scene's geometry in Embree: one instanced scene a body, whose pose changes from frame to frame. The only file pair that knows Embree.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "host_sim/optics/lanes.hpp"
#include "shared/scene/scene.hpp"

namespace lf::optics {

// What a packet of rays met first. `shape` counts the scene's shapes over all bodies, -1 for none; the normal is a unit vector against the ray.
struct HitPacket {
  Lanes parameter{};  // of the ray: origin + parameter * direction; where nothing was met how far was looked
  Lanes3 normal;
  LaneMask shape{};
};

class RayScene {
 public:
  // Of the bodies that `has` names. Throws InputError for a shape that makes no sense.
  RayScene(const scene::Scene& scene, const std::function<bool(const scene::Body&)>& has);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  // Moves the bodies. Not while another thread traces.
  void set_poses(const scene::BodyPoses& base_from_body);

  // First surfaces along origin + t direction, near <= t < far. Safe from several threads.
  HitPacket intersect(const Lanes3& origin, const Lanes3& direction, float near, Lanes far) const;

  // Where something lies on origin + t direction for 0 <= t <= far; only lanes in `wanted` are looked at.
  LaneMask occluded(LaneMask wanted, const Lanes3& origin, const Lanes3& direction, Lanes far) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lf::optics
