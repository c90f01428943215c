// The surface that each ray of a packet met, with what one pixel covers of it.
#pragma once

#include "host_sim/optics/camera_rays.hpp"
#include "host_sim/optics/ray_scene.hpp"

namespace lf::optics {

// Base frame, metres.
struct SurfacePacket {
  Lanes3 point, normal;       // the normal is a unit vector toward the camera
  Lanes3 point_du, point_dv;  // how the point moves on its surface's tangent plane from one pixel to the next
  Lanes3 direction, direction_du, direction_dv;
  Lanes3 origin;
  Lanes facing;  // normal . direction, < 0
  Lanes range;   // along the ray
  LaneMask met;  // lanes that met a surface; elsewhere the rest is finite and without meaning
};

inline SurfacePacket make_surface(const RayPacket& rays, const HitPacket& hit) {
  SurfacePacket s;
  s.met = hit.shape >= 0;
  const Lanes t = s.met ? hit.parameter : all_lanes(1.f);
  s.normal = {s.met ? hit.normal.x : -rays.direction.x, s.met ? hit.normal.y : -rays.direction.y, s.met ? hit.normal.z : -rays.direction.z};
  s.direction = rays.direction, s.direction_du = rays.direction_du, s.direction_dv = rays.direction_dv;
  s.origin = rays.origin;
  s.point = rays.origin + rays.direction * t;
  s.range = t * CameraRays::slope(rays);
  s.facing = min(dot(s.normal, rays.direction), all_lanes(-1e-4f));
  const Lanes3 step_u = rays.origin_du + rays.direction_du * t, step_v = rays.origin_dv + rays.direction_dv * t;
  s.point_du = step_u - rays.direction * (dot(s.normal, step_u) / s.facing);
  s.point_dv = step_v - rays.direction * (dot(s.normal, step_v) / s.facing);
  return s;
}

// Where rays toward a light start: off the surface by more than the hit point's rounding (1e-7 m), by less than anything seen.
inline Lanes3 off_surface(const SurfacePacket& s) { return s.point + s.normal * all_lanes(2e-6f); }

}  // namespace lf::optics
