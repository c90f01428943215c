#include "host_sim/optics/split_scene.hpp"

#include <limits>

namespace lf::optics {
namespace {

// What of `scene` lies in front of `behind`.
HitPacket in_front(const RayScene& scene, const RayLines& rays, const HitPacket& behind) {
  HitPacket hit = scene.intersect(rays.origin, rays.direction, near_m, behind.parameter);
  const LaneMask met = hit.shape >= 0;
  hit.shape = met ? hit.shape : behind.shape;
  hit.normal = {met ? hit.normal.x : behind.normal.x, met ? hit.normal.y : behind.normal.y, met ? hit.normal.z : behind.normal.z};
  return hit;
}

HitPacket first_of(const RayScene& scene, const RayLines& rays) {
  return scene.intersect(rays.origin, rays.direction, near_m, all_lanes(std::numeric_limits<float>::infinity()));
}

LaneMask clear_of(const RayScene& scene, const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) {
  if (!any(wanted)) return wanted;
  const Lanes3 start = off_surface(surface);
  const Lanes3 way = light - start;
  const Lanes far = max(1.f - near_m / max(norm(way), all_lanes(1e-3f)), Lanes{});
  return wanted & ~scene.occluded(wanted, start, way, far);
}

}  // namespace

SplitScene::SplitScene(const scene::Scene& scene)
    : all_(scene, [](const scene::Body&) { return true; }), fixed_(scene, fixed), moving_(scene, moves) {
  for (const scene::Body& body : scene) {
    if (yields(body)) yielding_.emplace_back(scene, [&body](const scene::Body& other) { return &other == &body; });
  }
}

void SplitScene::set_poses(const scene::BodyPoses& base_from_body) {
  all_.set_poses(base_from_body);
  fixed_.set_poses(base_from_body);
  moving_.set_poses(base_from_body);
  for (RayScene& body : yielding_) body.set_poses(base_from_body);
}

HitPacket SplitScene::resting(const RayLines& rays) const {
  HitPacket hit = first_of(fixed_, rays);
  for (const RayScene& body : yielding_) hit = in_front(body, rays, hit);
  return hit;
}

HitPacket SplitScene::nearest(const RayLines& rays, const HitPacket& resting) const { return in_front(moving_, rays, resting); }

HitPacket SplitScene::all(const RayLines& rays) const { return first_of(all_, rays); }

LaneMask SplitScene::clear_of_resting(const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) const {
  wanted = clear_of(fixed_, light, surface, wanted);
  for (const RayScene& body : yielding_) wanted = clear_of(body, light, surface, wanted);
  return wanted;
}

LaneMask SplitScene::clear_of_moving(const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) const {
  return clear_of(moving_, light, surface, wanted);
}

LaneMask SplitScene::clear_of_all(const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) const {
  return clear_of(all_, light, surface, wanted);
}

}  // namespace lf::optics
