// Where bodies may be seen or may throw shadows, by spheres about them: most rays need not ask for them.
#pragma once

#include <functional>
#include <vector>

#include "host_sim/optics/lanes.hpp"
#include "shared/scene/scene.hpp"

namespace lf::optics {

// All directions within an angle of `axis` (unit), seen from anywhere within `apex_radius_m` of the apex, out to `reach_m` from it. Base frame.
struct Cone {
  // About `centre`'s sphere as seen from the apex.
  static Cone about_sphere(const Vec3& apex, const Vec3& centre, double radius_m);

  Vec3 apex = Vec3::Zero(), axis = Vec3::UnitZ();
  double apex_radius_m = 0, cosine = 1, sine = 0;  // of the half angle, below 90 degrees
  double reach_m = 1e6;
  bool whole_space = false;  // the apex lies in the sphere
};

class BodyBounds {
 public:
  // About the visible shapes of the bodies that `has` names.
  BodyBounds(const scene::Scene& scene, const std::function<bool(const scene::Body&)>& has);

  void set_poses(const scene::BodyPoses& base_from_body);

  // False only where none of the bodies reaches into the cone.
  bool may_meet(const Cone& cone) const;

 private:
  struct Sphere {
    std::size_t body = 0;
    Vec3 centre_m = Vec3::Zero();  // in the body's frame
    double radius_m = 0;
  };
  struct Packet {
    Lanes3 centre;
    Lanes radius;
  };
  std::vector<Sphere> spheres_;
  std::vector<Packet> packets_;  // in the base frame
};

}  // namespace lf::optics
